"""Candidates for a model of any number of columns, weighed by what they leave unexplained.

EM for the mixture of :mod:`.filter`: its step for the model is weighted least squares on all columns. A
candidate's evidence is the likelihood times the posterior volume of its coefficients (Laplace), with the
prices that the line pays for one-sided errors, excursions and correlated neighbours
(:mod:`estimators.consensus.structure.criterion`).
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.bases.filter import filter_step, start_mixture
from estimators.consensus.structure.acquittal import ALONE_STEPS, acquit, forbid_contamination, start_alone
from estimators.consensus.structure.criterion import CORRELATION_PRICE, IMPOSSIBLE
from estimators.consensus.structure.mixture import (
    ABOVE,
    BELOW,
    CORRELATION,
    HELD_COUNT,
    INLIERS,
    LIKELIHOOD,
    SIGMA,
    SIZE,
    TIME_SPREAD,
    UNIFORM,
)
from estimators.kernels import device

LEAST_SPARE = 4.0
"""Inliers that a structure needs beyond its coefficients (METHODS.md 2.1: t - s about 5)."""

FINALISTS = 5
"""Different candidates that are weighed in earnest."""

_FIRST_STEPS = 3
_MIDDLE_STEPS = 4
_LAST_STEPS = 8
_SHARE = 0.5
_HELD = 5.0
_ONE_SIDE = 0.1
_BOTH_SIDES = 3.0
"""Prices as for the line (:mod:`estimators.consensus.structure.criterion`)."""


@device
def normal_step(
    columns: FloatArray, residual: FloatArray, weight: FloatArray, gram: FloatArray, step: FloatArray
) -> float:
    """Write the weighted least-squares ``step``; return log det of the normal matrix, NaN if singular."""
    p, n = columns.shape
    for j in range(p):
        right = 0.0
        for i in range(n):
            right += weight[i] * columns[j, i] * residual[i]
        step[j] = right
        for k in range(j + 1):
            product = 0.0
            for i in range(n):
                product += weight[i] * columns[j, i] * columns[k, i]
            gram[j, k] = product
    log_det = 0.0
    for j in range(p):
        diagonal = gram[j, j]
        pivot = diagonal
        for k in range(j):
            pivot -= gram[j, k] * gram[j, k]
        if not pivot > 1e-12 * diagonal:
            return math.nan
        root = math.sqrt(pivot)
        gram[j, j] = root
        log_det += 2.0 * math.log(root)
        for i in range(j + 1, p):
            value = gram[i, j]
            for k in range(j):
                value -= gram[i, k] * gram[j, k]
            gram[i, j] = value / root
    for j in range(p):
        for k in range(j):
            step[j] -= gram[j, k] * step[k]
        step[j] /= gram[j, j]
    for back in range(p):
        j = p - 1 - back
        for i in range(j + 1, p):
            step[j] -= gram[i, j] * step[i]
        step[j] /= gram[j, j]
    return log_det


@device
def fill_residual(columns: FloatArray, y: FloatArray, theta: FloatArray, residual: FloatArray) -> None:
    """Write y - theta @ columns, column by column."""
    residual[:] = y
    for j in range(theta.size):
        for i in range(y.size):
            residual[i] -= theta[j] * columns[j, i]


@device
def em_steps(
    columns: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    sides: int,
    sigma_floor: float,
    fixed: float,
    frozen: bool,
    steps: int,
    theta: FloatArray,
    params: FloatArray,
) -> float:
    """Take steps of EM on model and mixture, in place; returns the evidence before the last update."""
    p, n = columns.shape
    residual = np.empty(n)
    weight = np.empty(n)
    gram = np.empty((p, p))
    step = np.empty(p)
    fill_residual(columns, y, theta, residual)
    evidence = IMPOSSIBLE
    for _ in range(steps):
        if not filter_step(residual, root_weight, sides, sigma_floor, True, frozen, params, weight):
            return IMPOSSIBLE
        params[TIME_SPREAD] = normal_step(columns, residual, weight, gram, step)
        if math.isnan(params[TIME_SPREAD]):
            return IMPOSSIBLE
        evidence = _evidence(params, n, p, sides)
        for j in range(p):
            theta[j] += step[j]
        fill_residual(columns, y, theta, residual)
        square = 0.0
        for i in range(n):
            square += weight[i] * residual[i] * residual[i]
        params[SIGMA] = fixed if fixed > 0.0 else max(sigma_floor, math.sqrt(square / params[INLIERS]))
    return evidence


@device
def _evidence(params: FloatArray, n: int, p: int, sides: int) -> float:
    """Log evidence of a candidate; TIME_SPREAD holds the log determinant of its normal matrix."""
    support = params[INLIERS]
    if support < min(p + LEAST_SPARE, 0.5 * (n + p)):
        return IMPOSSIBLE
    value = params[LIKELIHOOD] + p * math.log(params[SIGMA]) - 0.5 * params[TIME_SPREAD]
    value += _SHARE * math.log(support / n) + _HELD * math.log(support / (support + params[HELD_COUNT]))
    if params[CORRELATION] > 0.0:
        value -= CORRELATION_PRICE
    if sides == 2:
        value -= _BOTH_SIDES * math.log(n)
    elif sides != 0:
        value -= _ONE_SIDE * math.log(n)
    return float(value)


@device
def weigh_candidates(
    columns: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    starts: FloatArray,
    scales: FloatArray,
    sigma_floor: float,
    fixed: float,
    thetas: FloatArray,
    bank: FloatArray,
    scores: FloatArray,
) -> int:
    """Fill the FINALISTS rows of ``thetas``, ``bank`` and ``scores``; return how many there are."""
    p = columns.shape[0]
    made = starts.shape[0]
    trial = starts.copy()
    params = np.empty((made, SIZE))
    first = np.empty(made)
    for c in range(made):
        start_mixture(fixed if fixed > 0.0 else max(scales[c], sigma_floor), 0.2, 0.5, params[c])
        first[c] = em_steps(
            columns, y, root_weight, 2, sigma_floor, fixed, False, _FIRST_STEPS, trial[c], params[c]
        )
    order = np.argsort(-first)
    heard = 0
    variant = np.empty(SIZE)
    theta = np.empty(p)
    for rank in range(made):
        c = order[rank]
        if heard == FINALISTS or first[c] <= IMPOSSIBLE:
            break
        if _is_known(columns, thetas, bank, heard, trial[c], params[c, SIGMA]):
            continue
        scores[heard] = IMPOSSIBLE
        strong = 1 if params[c, ABOVE] > params[c, BELOW] else -1
        for sides in (0, strong, 2):
            if sides == 2 and heard > 0:
                break
            variant[:] = params[c]
            theta[:] = trial[c]
            if sides in (0, -1):
                variant[ABOVE] = 0.0
            if sides in (0, 1):
                variant[BELOW] = 0.0
            variant[UNIFORM] = max(0.05, 1.0 - variant[ABOVE] - variant[BELOW])
            score = em_steps(
                columns, y, root_weight, sides, sigma_floor, fixed, False,
                _MIDDLE_STEPS + _LAST_STEPS, theta, variant,
            )  # fmt: skip
            if score > scores[heard]:
                scores[heard] = score
                thetas[heard] = theta
                bank[heard] = variant
        if scores[heard] > IMPOSSIBLE:
            heard += 1
    return heard


@device
def _is_known(
    columns: FloatArray, thetas: FloatArray, bank: FloatArray, heard: int, theta: FloatArray, sigma: float
) -> bool:
    """Whether a candidate has run into one that was heard: the same curve to half a scale, on average."""
    p, n = columns.shape
    for k in range(heard):
        square = 0.0
        for i in range(n):
            d = 0.0
            for j in range(p):
                d += (theta[j] - thetas[k, j]) * columns[j, i]
            square += d * d
        reach = 0.5 * (sigma + bank[k, SIGMA])
        ratio = sigma / bank[k, SIGMA]
        if square < n * reach * reach and 0.5 < ratio < 2.0:
            return True
    return False


@device
def acquit_model(
    columns: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    sigma_floor: float,
    fixed: float,
    theta: FloatArray,
    params: FloatArray,
) -> None:
    """Take least squares instead where contamination explains the series hardly better (Schwarz 1978).

    As for the line: a mixture always finds a little contamination in the tails of clean noise, and gains
    the more from having been searched for, the more coefficients it has and the fewer readings it holds.
    """
    p, n = columns.shape
    alone = params.copy()
    plain = np.zeros(p)
    residual = np.empty(n)
    gram = np.empty((p, p))
    step = np.empty(p)
    fill_residual(columns, y, plain, residual)
    if math.isnan(normal_step(columns, residual, root_weight * root_weight, gram, step)):
        return
    plain += step
    fill_residual(columns, y, plain, residual)
    square = 0.0
    for i in range(n):
        square += (residual[i] * root_weight[i]) ** 2
    start_alone(alone, fixed if fixed > 0.0 else max(sigma_floor, math.sqrt(square / n)))
    forbid_contamination(alone)
    em_steps(columns, y, root_weight, 0, sigma_floor, fixed, True, ALONE_STEPS, plain, alone)
    if acquit(params, alone, p, n):
        theta[:] = plain
