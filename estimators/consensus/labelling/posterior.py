"""Posterior probability that a point follows the model, calibrated on the residuals of the series itself.

A mixture as in MLESAC (Torr & Zisserman 2000; METHODS.md 3.2), z = g f_in / (g f_in + b), in which neither
density is taken for granted. The background b need not be uniform: errors that stand apart from the model
leave it empty near by. The law of the inliers need not be normal: Student's t with 2 and 4 degrees of freedom
compete with it (:mod:`estimators.consensus.labelling.laws`), and so do all of these without any background,
under which every point follows the model. Nor need its scale be the one that was found: a model of few
followers may be a fine line that chance drew through the noise of a broader one.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.labelling.cells import CELLS, SLOTS, count_residuals, octave_width
from estimators.consensus.labelling.chance import gain_of_search
from estimators.consensus.labelling.laws import FINE, NEAR, TABLE, tabulate
from estimators.kernels import device

_LEAST_RANGE = 20.0  # scales: a clean series does not say how near an error would have been
_CERTAIN = 700.0  # log odds that the exponential function bears

_FEW = 20.0
"""Followers below which broader scales are heard: of 50 normal readings the best 8 or so lie on some line."""
_COEFFICIENTS = 2
"""Of the line that few followers may have been drawn from; more of them could only add to the doubt."""
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
    counts = np.zeros((2, SLOTS))
    table = np.empty((2, TABLE + 1))
    total, reach, farthest = count_residuals(residual, root_weight, sigma, counts)
    near = 0.0
    for k in range(NEAR):
        near += counts[0, k] + counts[1, k]
    if near * residual.size < _FEW * total:
        _average_scales(residual, root_weight, sigma, reach, counts, table, posterior)
    else:
        weighed = tabulate(counts, total, max(reach, _LEAST_RANGE), max(farthest, 0.5 * _LEAST_RANGE), table)
        _look_up(residual, root_weight, sigma, table, posterior)
        pure = 1.0 / (1.0 + math.exp(min(weighed.mixed - weighed.pure, _CERTAIN)))
        for i in range(residual.size):
            posterior[i] = pure + (1.0 - pure) * posterior[i]


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
        total, span, farthest = count_residuals(residual, root_weight, sigma * factor, counts)
        farthest = max(farthest, 0.5 * _LEAST_RANGE)
        weighed = tabulate(counts, total, max(span, _LEAST_RANGE), farthest, table)
        volume = 2.0 * math.log(factor) - _log_widths(counts, factor, farthest)
        followers = max(weighed.followers, 1.0)
        mixed = weighed.mixed + volume - math.log(followers) - gain_of_search(_COEFFICIENTS, followers, total)
        pure = weighed.pure + volume - math.log(total) - gain_of_search(_COEFFICIENTS, total, total)
        _look_up(residual, root_weight, sigma * factor, table, one)
        likelier = max(mixed, pure)
        if likelier > best:
            shrink = math.exp(best - likelier) if weight_sum > 0.0 else 0.0
            weight_sum *= shrink
            posterior *= shrink
            best = likelier
        weight = math.exp(mixed - best)
        weight_pure = math.exp(pure - best)
        weight_sum += weight + weight_pure
        for i in range(residual.size):
            posterior[i] += weight * one[i] + weight_pure
    posterior /= weight_sum


@device
def _log_widths(counts: FloatArray, factor: float, farthest: float) -> float:
    """Log of the product of the widths of all residuals' cells: probabilities over widths are densities.

    Densities compare across scales; they are per scale found, which is ``factor`` times finer.
    """
    total = 0.0
    for k in range(SLOTS):
        both = counts[0, k] + counts[1, k]
        if both > 0.0:
            width = 0.5 if k < CELLS else octave_width(k, farthest)
            total += both * math.log(factor * width)
    return total


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
