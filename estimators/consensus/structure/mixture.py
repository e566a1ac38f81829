"""What a line leaves unexplained: a mixture with sticky labels along the time axis, fitted by EM.

A reading follows the line (a normal law of scale s) or is contaminated. Contaminated readings come as
uniform ones over the range of the values; as errors to one side or both, whose density is 0 at the line and
falls off exponentially (the sum of two exponential laws); or as an excursion that keeps a level of its own
while it lasts. Readings that follow the line may be correlated with their neighbours. Labels are sticky:
a two-state chain whose forward filter (Hamilton 1989) gives each reading's probability and the
likelihood of the series. A fresh excursion pays for its unknown level once, ln(range); a structure is
therefore judged by how often in time the readings leave it, and not only by how many do
(METHODS_TRENDS: "What *the trend* means").
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.kernels import device

# Slots of a candidate's parameter vector.
LEVEL = 0
SLOPE = 1
SIGMA = 2
UNIFORM = 3  # share of uniform readings among the contaminated
ABOVE = 4  # share and mean of one-sided errors above and below
ABOVE_MEAN = 5
BELOW = 6
BELOW_MEAN = 7
HELD = 8  # share of contaminated readings that keep the level of their excursion
HELD_SCALE = 9
ENTER = 10  # P(contaminated | the last followed the line)
STAY = 11  # P(contaminated | the last was contaminated)
LIKELIHOOD = 12  # log-likelihood at the parameters before the last step
INLIERS = 13  # effective number of readings that follow the line
TIME_SPREAD = 14  # their sum of squared time deviations
HELD_COUNT = 15  # effective number of readings that keep the level of an excursion
CORRELATION = 16  # of successive residuals of readings that follow the line
SIZE = 17

ROOT_2PI = 2.5066282746310002
_ROOT_2PI_E = 4.132731354122493  # root of 2 pi e: a normal law's entropy is its logarithm
_HELD_WIDTH = 4.0  # width of an excursion's level in the hard labels' likelihood, in their scale
STUDENT5 = 0.3796066898224944  # density of Student's t with 5 degrees of freedom at 0

LEVEL_GAIN = 0.03
"""Least gain with which the level of an excursion is followed: slow, so that it means something."""
TAU_FLOOR = 0.5
"""Least scale of readings about an excursion's level, in noise scales; it may be finer than the line's."""
SIDE_FLOOR = 5.0
"""Least scale of one-sided errors, in noise scales: a broad line may not call its own tail errors."""
SEPARATION = 11.0
"""Scale on which the density of one-sided errors rises from 0 at the line, in noise scales.

Errors stand apart from the noise; this is the dial that tells the edge of a one-sided cloud from its middle.
"""
CORRELATION_FLOOR = 2.0
"""Correlations below this many standard errors, 1 / sqrt(n), count as none."""


@device
def _chain(moved: float, all_of_them: float) -> float:
    """Log-likelihood of a two-state chain's moves from one state, at their own frequency."""
    stayed = all_of_them - moved
    value = 0.0
    if moved > 0.0:
        value += moved * math.log(moved / all_of_them)
    if stayed > 0.0:
        value += stayed * math.log(stayed / all_of_them)
    return value


@device
def start(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    level: float,
    slope: float,
    scale: float,
    sigma_floor: float,
    fixed: float,
    params: FloatArray,
) -> None:
    """Set the parameters of a candidate from labels cut at ``scale``, without transcendentals.

    The likelihood is that of the hard labels, good enough to tell which candidates deserve a better one.
    """
    n = t.size
    residual = np.empty(n)
    # Flags are numbers here: branches that follow random outliers cost more than the arithmetic.
    out = np.empty(n, np.int64)
    for i in range(n):
        r = (y[i] - level - slope * t[i]) * root_weight[i]
        residual[i] = r
        out[i] = 1 if abs(r) > scale else 0
    outside = 0
    for i in range(n):
        outside += out[i]
    twice = 0
    kept = 0
    for i in range(1, n):
        both = out[i] & out[i - 1]
        twice += both
        kept += both if abs(residual[i] - residual[i - 1]) <= 2.0 * scale else 0
    square = 0.0
    for i in range(n):
        square += (1.0 - out[i]) * residual[i] * residual[i]
    inside = float(n - outside)
    outside_twice = float(twice)
    held = float(kept)
    # Of n - 1 pairs of neighbours: how often an outlier was entered and how often it went on.
    from_out = float(outside - out[n - 1])
    entered = float(outside - out[0]) - outside_twice
    sigma = fixed if fixed > 0.0 else max(sigma_floor, math.sqrt(square / max(1.0, inside - 2.0)))
    params[LEVEL] = level
    params[SLOPE] = slope
    params[SIGMA] = sigma
    params[UNIFORM] = 0.6
    params[ABOVE] = 0.2
    params[BELOW] = 0.2
    params[ABOVE_MEAN] = 10.0 * sigma
    params[BELOW_MEAN] = 10.0 * sigma
    params[HELD] = (1.0 + held) / (2.0 + outside_twice)
    params[HELD_SCALE] = 1.5 * sigma
    params[ENTER] = (1.0 + entered) / (2.0 + n - 1.0 - from_out)
    params[STAY] = (1.0 + outside_twice) / (2.0 + from_out)
    params[INLIERS] = inside
    params[HELD_COUNT] = held
    params[TIME_SPREAD] = inside / 3.0  # as if spread evenly over [-1, 1]
    params[LIKELIHOOD] = (
        -inside * math.log(sigma * _ROOT_2PI_E)
        - held * math.log(_HELD_WIDTH * scale)
        + _chain(entered, n - 1.0 - from_out)
        + _chain(outside_twice, from_out)
    )


@device
def side_scale(mean: float, s: float) -> float:
    """Scale of one-sided errors with a given mean: the root of mean = theta + c theta / (c + theta)."""
    c = SEPARATION * s
    half = 0.5 * (mean - 2.0 * c)
    return max(SIDE_FLOOR * s, half + math.sqrt(half * half + mean * c))


@device
def start_sides(params: FloatArray, sides: int) -> None:
    """Turn off the sides that a finalist is tried without: 0 leaves none, 1 above, -1 below, 2 both."""
    if sides in (0, -1):
        params[ABOVE] = 0.0
    if sides in (0, 1):
        params[BELOW] = 0.0
    params[UNIFORM] = max(0.05, 1.0 - params[ABOVE] - params[BELOW])


@device
def settle_labels(
    n: int,
    held: float,
    fresh: float,
    in_to_out: float,
    from_out: float,
    out_to_out: float,
    params: FloatArray,
) -> None:
    """Set HELD, ENTER and STAY to what a filter over n readings summed up."""
    params[HELD] = min(0.99, max(0.01, (held + 0.5) / (held + fresh + 1.0)))
    params[ENTER] = min(0.98, max(0.002, (in_to_out + 0.5) / (n - from_out + 1.0)))
    params[STAY] = min(0.995, max(0.02, (out_to_out + 0.5) / (from_out + 1.0)))


@device
def settle_correlation(lagged: float, lag_square: float, inliers: float, params: FloatArray) -> None:
    """Set CORRELATION to that of neighbours that both follow the line; none where it is not told from 0."""
    if lag_square > 0.0:
        rho = lagged / lag_square
        params[CORRELATION] = min(rho, 0.97) if rho > CORRELATION_FLOOR / math.sqrt(inliers) else 0.0
