"""How structures are compared, and when two candidates are the same one."""

from __future__ import annotations

import math

from estimators.arrays import FloatArray
from estimators.consensus.structure.mixture import (
    CORRELATION,
    HELD_COUNT,
    INLIERS,
    LEVEL,
    LIKELIHOOD,
    SIGMA,
    SLOPE,
    TIME_SPREAD,
)
from estimators.kernels import device

IMPOSSIBLE = -1e300
"""Score of a candidate that is none."""

# The exact volume of a posterior would weigh ln s by 2 and ln(S Sxx) by 1/2 (Laplace's approximation with
# flat priors on level and slope). Smaller weights favour fine structures over broad ones a little; they were
# chosen on one-sided contamination of 80 %, where the broad line through the cloud competes with its edge.
_SCALE = 0.5
_INFORMATION = 0.4
_SHARE = 0.5
_HELD = 5.0
"""Price of contamination that stands on levels of its own: settles ties between branches by majority."""
_ONE_SIDE = 0.1
_BOTH_SIDES = 3.0
"""Prices of one-sided and two-sided errors, in ln n."""
CORRELATION_PRICE = 6.0
"""Price of correlated neighbours: a wandering excursion must not pass for correlated noise too easily."""

_LEAST_SUPPORT = 6.0
"""Inliers that a structure needs (METHODS.md 2.1: t - s about 5); half the points of a short series."""


@device
def criterion(params: FloatArray, n: int, sides: int) -> float:
    """Log evidence of a fitted candidate; larger is better.

    The likelihood, the posterior volume of level and slope, log priors on the share of inliers and on its
    ratio to held excursions, and prices on what the mixture was allowed to use.
    """
    support = params[INLIERS]
    enough = min(_LEAST_SUPPORT, 0.5 * n + 0.5)
    if params[LIKELIHOOD] <= IMPOSSIBLE or support < enough or params[TIME_SPREAD] <= 0.0:
        return IMPOSSIBLE
    value = params[LIKELIHOOD] + _SCALE * math.log(params[SIGMA])
    value -= _INFORMATION * math.log(support * params[TIME_SPREAD])
    value += _SHARE * math.log(support / n) + _HELD * math.log(support / (support + params[HELD_COUNT]))
    if params[CORRELATION] > 0.0:
        value -= CORRELATION_PRICE
    if sides == 2:
        value -= _BOTH_SIDES * math.log(n)
    elif sides != 0:
        value -= _ONE_SIDE * math.log(n)
    return float(value)


@device
def distance(one: FloatArray, other: FloatArray) -> float:
    """Largest distance between two candidates' lines on [-1, 1]."""
    level = one[LEVEL] - other[LEVEL]
    slope = one[SLOPE] - other[SLOPE]
    return float(max(abs(level - slope), abs(level + slope)))


@device
def same_structure(one: FloatArray, other: FloatArray) -> bool:
    """Whether two candidates have run into the same line and scale."""
    ratio = one[SIGMA] / other[SIGMA]
    return bool(distance(one, other) < 0.5 * (one[SIGMA] + other[SIGMA]) and 0.5 < ratio < 2.0)
