"""The laws that inliers may follow, near normal or heavy-tailed, and whether they are all there is.

Laws compete by the likelihood of the counted residuals, each with a background of its own
(:mod:`estimators.consensus.labelling.background`) and without one: the far readings of a heavy tail are no
errors only because a background could take them in. A background has to pay for being there. How often
errors come is not known; were all shares as likely beforehand, then of n readings without one the
likelihood, averaged over the shares, is 1 / (n + 1) of what it is at none.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, stdtr

from estimators.arrays import FloatArray
from estimators.consensus.labelling.background import STEPS, far_likelihood, fit_background, step_of
from estimators.consensus.labelling.cells import CELLS, EDGES, REACH, SLOTS
from estimators.kernels import device

FINE = 8  # entries of the table of posteriors per scale
TABLE = REACH * FINE
NEAR = 6  # cell from which a residual is far: 3 scales

_STUDENT = ((2.0, 0.7), (2.0, 1.0), (2.0, 1.4), (4.0, 1.0))
"""Degrees of freedom and scale, in noise scales, of the laws that compete with the normal law."""
_STUDENT_PRIOR = 0.5
_LAWS = 1 + len(_STUDENT)

_DEGREES = (math.inf, 2.0, 4.0)
_SCALES = 2.0 ** (np.arange(-6, 4) / 6.0)
"""Laws without a background are cheap to weigh, so that their scale is looked for, from a half to 1.4."""
_HOPELESS = 30.0
"""Log odds beyond which an explanation is not looked into."""


def _tail(u: FloatArray, dof: float) -> FloatArray:
    """Probability of a standard residual above u."""
    return np.asarray(ndtr(-u) if math.isinf(dof) else stdtr(dof, -u))


def _density(u: FloatArray, dof: float) -> FloatArray:
    if math.isinf(dof):
        return np.asarray(np.exp(-0.5 * u * u) / math.sqrt(2.0 * math.pi))
    log_height = math.lgamma(0.5 * (dof + 1.0)) - math.lgamma(0.5 * dof) - 0.5 * math.log(dof * math.pi)
    return np.asarray(math.exp(log_height) * (1.0 + u * u / dof) ** (-0.5 * (dof + 1.0)))


_GRID = np.arange(TABLE + 1) / FINE
_PURE = tuple((dof, float(scale)) for dof in _DEGREES for scale in _SCALES)
_ALL = ((math.inf, 1.0), *_STUDENT, *_PURE)
_MASS = np.array([-np.diff(_tail(EDGES / scale, dof)) for dof, scale in _ALL])
"""Probability of each cell on one side, shape (laws, SLOTS): those with a background, those without."""
_DENSITY = np.array([_density(_GRID / scale, dof) / scale for dof, scale in _ALL])
"""Density on the grid of the table, shape (laws, TABLE + 1)."""
_LOG_PRIOR = np.log([1.0 - _STUDENT_PRIOR] + [_STUDENT_PRIOR / len(_STUDENT)] * len(_STUDENT))
_HEAVY = len(_DEGREES) - 1
_PURE_LOG_PRIOR = np.log(
    np.repeat([1.0 - _STUDENT_PRIOR] + [_STUDENT_PRIOR / _HEAVY] * _HEAVY, _SCALES.size) / _SCALES.size
)
_PURE_LOG_MASS = np.ascontiguousarray(np.log(np.maximum(_MASS[_LAWS:], 1e-300)).T)
"""Shape (SLOTS, laws): all laws take up the count of one cell at once."""
_PURE_LOG_INSIDE = np.log(2.0 * _MASS[_LAWS:, :CELLS].sum(axis=1))


class Weighed(NamedTuple):
    """How the counts are explained.

    Attributes
    ----------
    mixed : float
        Log evidence for a law and a background, averaged over the laws.
    pure : float
        Log evidence for a law alone.
    followers : float
        Number of inliers under the likeliest law with a background.
    """

    mixed: float
    pure: float
    followers: float


@device
def tabulate(counts: FloatArray, total: float, reach: float, farthest: float, table: FloatArray) -> Weighed:
    """Average the posteriors under each law with a background, weighted by prior and likelihood.

    Parameters
    ----------
    counts : ndarray of float64, shape (2, SLOTS)
        Residuals per side and cell.
    total, reach, farthest : float
        Number, range and largest distance of the residuals, in scales.
    table : ndarray of float64, shape (2, TABLE + 1)
        Receives the posterior per side and distance, if there is a background.

    Returns
    -------
    Weighed
    """
    near = 0.0
    beyond = total
    for k in range(CELLS):
        both = counts[0, k] + counts[1, k]
        beyond -= both
        if k < NEAR:
            near += both
    # Where no residual is in the tails, the laws differ on nothing that is asked.
    laws = _LAWS if near < total else 1
    steps = np.empty((2, STEPS))
    table[:] = 0.0
    mixed = -np.inf
    best = -np.inf
    weight_sum = 0.0
    followers = 1.0
    for law in range(laws):
        inliers, tail, likelihood = fit_background(counts, total, beyond, reach, _MASS[law], steps)
        if laws > 1:
            likelihood += _LOG_PRIOR[law]
        # A background is taken as level beyond REACH, which few errors are: how the residuals lie out there
        # counts for or against there being a background, not for one law against another.
        outside = far_likelihood(counts, beyond, reach, farthest, _MASS[law], inliers, tail)
        mixed = _log_sum(mixed, likelihood + outside)
        if likelihood > best:
            # What was gathered so far was measured against the last best law.
            shrink = math.exp(best - likelihood) if weight_sum > 0.0 else 0.0
            weight_sum *= shrink
            table *= shrink
            best = likelihood
            followers = inliers
        if likelihood > best - _HOPELESS:
            weight = math.exp(likelihood - best)
            weight_sum += weight
            _add_posterior(_DENSITY[law], inliers, steps, weight, table)
    _finish(weight_sum, table)
    pure, alone, nearest = _weigh_pure(counts, farthest)
    price = math.log(total + 1.0)
    if pure + price > mixed - _HOPELESS:
        # The laws of finer scales may fit the bulk better than those above do, whatever lies beyond it.
        for turn in range(1 if nearest[0] == nearest[1] else 2):
            mass = _MASS[_LAWS + nearest[turn]]
            inliers, tail, likelihood = fit_background(counts, total, beyond, reach, mass, steps)
            likelihood += far_likelihood(counts, beyond, reach, farthest, mass, inliers, tail)
            mixed = max(mixed, pure + likelihood - alone)
    return Weighed(mixed - price, pure, followers)


@device
def _log_sum(one: float, other: float) -> float:
    """Logarithm of the sum of two numbers given by theirs; the second is finite."""
    larger = max(one, other)
    return larger + math.log(math.exp(one - larger) + math.exp(other - larger))


@device
def _add_posterior(
    density: FloatArray, inliers: float, steps: FloatArray, weight: float, table: FloatArray
) -> None:
    """Add the posterior under one law to the table."""
    for side in range(2):
        for k in range(TABLE + 1):
            step = step_of(min(2 * k // FINE, CELLS - 1))
            inside = inliers * density[k]
            table[side, k] += weight * inside / (inside + 2.0 * steps[side, step])


@device
def _finish(weight_sum: float, table: FloatArray) -> None:
    """Turn sums into averages that fall away from the model."""
    table /= weight_sum
    table[0, 0] = table[1, 0] = min(table[0, 0], table[1, 0])
    for side in range(2):
        # Averages of falling functions fall; rounding must not say otherwise, nor that one is certain.
        table[side, 0] = min(table[side, 0], 1.0 - 1e-12)
        for k in range(TABLE):
            table[side, k + 1] = min(table[side, k + 1], table[side, k])


@device
def _weigh_pure(counts: FloatArray, farthest: float) -> tuple[float, float, tuple[int, int]]:
    """Log evidence for the counts being of one law alone, and the log-likelihood of the likeliest.

    Then which law that is, and which is the likeliest for the residuals within REACH by themselves.
    """
    evidence = _PURE_LOG_PRIOR.copy()
    _add_cells(counts, 0, CELLS, farthest, evidence)
    core = 0.0
    for k in range(CELLS):
        core += counts[0, k] + counts[1, k]
    inner = int(np.argmax(evidence - core * _PURE_LOG_INSIDE))
    _add_cells(counts, CELLS, SLOTS, farthest, evidence)
    nearest = int(np.argmax(evidence))
    best = evidence[nearest]
    weight_sum = 0.0
    for law in range(evidence.size):
        weight_sum += math.exp(evidence[law] - best)
    return best + math.log(weight_sum), best - _PURE_LOG_PRIOR[nearest], (nearest, inner)


@device
def _add_cells(counts: FloatArray, first: int, end: int, farthest: float, evidence: FloatArray) -> None:
    """Add the log-likelihood of some cells under every law alone."""
    for k in range(first, end):
        if EDGES[k] > farthest:
            break
        both = counts[0, k] + counts[1, k]
        if both > 0.0:
            for law in range(evidence.size):
                evidence[law] += both * _PURE_LOG_MASS[k, law]
