"""Posterior probability that a point follows the model, calibrated on the residuals of the series itself.

A mixture as in MLESAC (Torr & Zisserman 2000; METHODS.md 3.2), z = g f_in / (g f_in + b), in which neither
density is taken for granted. The background b need not be uniform: errors that stand apart from the model
leave it empty near by. The law of the inliers need not be normal: Student's t with 2 and 4 degrees of freedom
compete with it (:mod:`estimators.consensus.labelling.laws`). Nor need its scale be the one that was found: a
model of few followers may be a fine line that chance drew through the noise of a broader one.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.labelling.laws import CELLS, FINE, NEAR, TABLE, tabulate
from estimators.kernels import device

_LEAST_RANGE = 20.0  # scales: a clean series does not say how near an error would have been
_LONG = 65536  # points beyond which a part of them is counted

_FEW = 20.0
"""Followers below which broader scales are heard: of 50 normal readings the best 8 or so lie on some line."""
_MOST_OCTAVES = 9
_BROADEST = 5.0
"""Octaves end where so many scales reach across the values."""


@device
def posterior_of(residual: FloatArray, root_weight: FloatArray, sigma: float, posterior: FloatArray) -> None:
    """Fill ``posterior`` with the probability that each point follows the model.

    Parameters
    ----------
    residual : ndarray of float64, shape (n,)
    root_weight : ndarray of float64, shape (n,) or (0,)
        Square roots of the precisions; none where empty.
    sigma : float
        Noise scale of an inlier of mean weight, positive.
    posterior : ndarray of float64, shape (n,)
        Receives probabilities that fall with |residual| on either side.
    """
    counts = np.zeros((2, CELLS + 1))
    table = np.empty((2, TABLE + 1))
    total, reach = _count(residual, root_weight, sigma, counts)
    near = 0.0
    for k in range(NEAR):
        near += counts[0, k] + counts[1, k]
    if near * residual.size < _FEW * total:
        _average_scales(residual, root_weight, sigma, reach, counts, table, posterior)
    else:
        tabulate(counts, total, max(reach, _LEAST_RANGE), table)
        _look_up(residual, root_weight, sigma, table, posterior)


@device
def _average_scales(
    residual: FloatArray,
    root_weight: FloatArray,
    sigma: float,
    reach: float,
    counts: FloatArray,
    table: FloatArray,
    posterior: FloatArray,
) -> None:
    """Average the posteriors at the scale found and at its octaves, by the evidence for each.

    The evidence is the likelihood times the posterior volume of level and slope (Laplace's approximation with
    flat priors, as for structures): s^2 over the number of followers. All octaves are as likely beforehand.
    """
    octaves = 1
    while octaves < _MOST_OCTAVES and _BROADEST * 2.0**octaves < reach:
        octaves += 1
    one = np.empty(residual.size)
    posterior[:] = 0.0
    best = -np.inf
    weight_sum = 0.0
    for octave in range(octaves):
        factor = 2.0**octave
        counts[:] = 0.0
        total, span = _count(residual, root_weight, sigma * factor, counts)
        span = max(span, _LEAST_RANGE)
        evidence, followers = tabulate(counts, total, span, table)
        # From probabilities of cells to densities, which compare across octaves.
        beyond = counts[0, CELLS] + counts[1, CELLS]
        evidence -= (total - beyond) * math.log(0.5 * factor)
        evidence -= beyond * math.log(factor * max(span - CELLS, 1.0))
        evidence += 2.0 * math.log(factor) - math.log(max(followers, 1.0))
        _look_up(residual, root_weight, sigma * factor, table, one)
        if evidence > best:
            shrink = math.exp(best - evidence) if weight_sum > 0.0 else 0.0
            weight_sum *= shrink
            posterior *= shrink
            best = evidence
        weight = math.exp(evidence - best)
        weight_sum += weight
        posterior += weight * one
    posterior /= weight_sum


@device
def _look_up(
    residual: FloatArray, root_weight: FloatArray, sigma: float, table: FloatArray, posterior: FloatArray
) -> None:
    """Read the probability of every point off the table."""
    weighted = root_weight.size > 0
    inverse = 1.0 / sigma
    root = 1.0
    for i in range(residual.size):
        if weighted:
            root = root_weight[i]
        u = residual[i] * root * inverse
        side = 1 if u > 0.0 else 0
        x = abs(u) * FINE
        if x < TABLE:
            k = int(x)
            posterior[i] = table[side, k] + (x - k) * (table[side, k + 1] - table[side, k])
        else:
            # Beyond the table odds fall at least as fast as the density of the heaviest law.
            ratio = TABLE / x
            odds = table[side, TABLE] / (1.0 - table[side, TABLE]) * ratio * ratio * ratio
            posterior[i] = odds / (1.0 + odds)


@device
def _count(
    residual: FloatArray, root_weight: FloatArray, sigma: float, counts: FloatArray
) -> tuple[float, float]:
    """Count residuals per side and cell, the last cell for all beyond; return their number and range."""
    n = residual.size
    weighted = root_weight.size > 0
    stride = 1 + n // _LONG
    low = np.inf
    high = -np.inf
    total = 0.0
    inverse = 1.0 / sigma
    root = 1.0
    for i in range(0, n, stride):
        if weighted:
            root = root_weight[i]
        u = residual[i] * root * inverse
        low = min(low, u)
        high = max(high, u)
        counts[1 if u > 0.0 else 0, int(min(2.0 * abs(u), CELLS))] += 1.0
        total += 1.0
    return total, high - low
