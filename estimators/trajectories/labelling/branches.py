"""What may follow at a fix: the branches of one hypothesis, their scores, and what taking one does to it."""

from __future__ import annotations

import math

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import device
from estimators.trajectories.labelling.modes import (
    BURST,
    BURSTING,
    ENTRY,
    EXIT,
    JUMP_SPREAD_MPS,
    LEVEL_FACTOR,
    LEVEL_STRIDE,
    LEVELS,
    NOMINAL,
    REDRAW,
    SPIKE,
    TELEPORT,
    WIDE,
    WIDE_FACTOR,
    exit_rate,
    log_anywhere,
    log_normal,
)
from estimators.trajectories.labelling.state import forget_bias, start_at, take_for_bias, update

BRANCHES = LEVELS + 4
"""The most of one hypothesis."""

GOOD = (NOMINAL, WIDE, EXIT, TELEPORT)
"""Kinds of fixes that tell where the track is."""

(
    _GOOD, _SPIKE, _WIDE, _TELEPORT, _STAYS, _ENTER, _SAME_LEVEL, _OTHER_LEVEL, _SAME_OFFSET, _NEW_OFFSET,
) = range(10)  # fmt: skip
"""Places in the array of priors; see :func:`fill_prior`."""

R_SPIKE, R_WIDE, R_ENTRY, R_REDRAW, R_TELEPORT, R_LEVEL, R_WALK, R_GROWTH = range(8)
"""Places in the array of rates; see :class:`estimators.trajectories.parameters.Rates`."""


@device
def branch_nominal(
    level: int, weight: float, base: float, variance: float, squared: float, squared_place: float,
    core: float, reach: float, prior: FloatArray, scores: FloatArray, kinds: IntArray, count: int,
) -> int:  # fmt: skip
    """Append what may follow outside of a burst; returns how many branches there are."""
    stays = weight + prior[_STAYS]
    noise = variance
    for other in range(LEVELS):
        change = prior[_SAME_LEVEL] if other == level else prior[_OTHER_LEVEL]
        scores[count] = stays + change + prior[_GOOD] + log_normal(squared, base + noise)
        kinds[count] = NOMINAL + LEVEL_STRIDE * other
        count += 1
        noise *= LEVEL_FACTOR
    noise = variance * LEVEL_FACTOR**level
    lasts = stays + prior[_SAME_LEVEL]
    scores[count] = lasts + prior[_WIDE] + log_normal(squared, base + WIDE_FACTOR * noise)
    kinds[count] = WIDE + LEVEL_STRIDE * level
    scores[count + 1] = stays + prior[_SPIKE] + log_anywhere(squared, core, reach)
    kinds[count + 1] = SPIKE + LEVEL_STRIDE * level
    elsewhere = log_anywhere(squared_place, core, reach)
    scores[count + 2] = weight + prior[_ENTER] + prior[_GOOD] + elsewhere
    kinds[count + 2] = ENTRY
    scores[count + 3] = stays + prior[_TELEPORT] + elsewhere
    kinds[count + 3] = TELEPORT
    return count + 4


@device
def branch_burst(
    age: float, dt: float, weight: float, base: float, place: float, variance: float, squared: float,
    squared_place: float, core: float, reach: float, prior: FloatArray, scores: FloatArray,
    kinds: IntArray, count: int,
) -> int:  # fmt: skip
    """Append what may follow within a burst; returns how many branches there are."""
    lasts = -exit_rate(age) * dt
    ends = math.log(-math.expm1(lasts))
    stays = weight + lasts + prior[_SAME_OFFSET]
    scores[count] = stays + prior[_GOOD] + log_normal(squared, base + variance)
    kinds[count] = BURST
    scores[count + 1] = stays + prior[_SPIKE] + log_anywhere(squared, core, reach)
    kinds[count + 1] = SPIKE
    elsewhere = log_anywhere(squared_place, core, reach)
    scores[count + 2] = weight + lasts + prior[_NEW_OFFSET] + prior[_GOOD] + elsewhere
    kinds[count + 2] = REDRAW
    scores[count + 3] = weight + ends + prior[_GOOD] + log_normal(squared_place, place + variance)
    kinds[count + 3] = EXIT
    return count + 4


@device
def fill_prior(dt: float, rates: FloatArray, prior: FloatArray) -> None:
    """Logarithms of what each kind of fix is worth before it is seen."""
    enter = -math.expm1(-rates[R_ENTRY] * dt)
    redraw = -math.expm1(-rates[R_REDRAW] * dt)
    shift = -math.expm1(-rates[R_LEVEL] * dt)
    prior[_GOOD] = math.log1p(-rates[R_SPIKE] - rates[R_WIDE] - rates[R_TELEPORT])
    prior[_SPIKE] = math.log(rates[R_SPIKE])
    prior[_WIDE] = math.log(rates[R_WIDE])
    prior[_TELEPORT] = math.log(rates[R_TELEPORT])
    prior[_STAYS] = math.log1p(-enter)
    prior[_ENTER] = math.log(enter)
    prior[_SAME_LEVEL] = math.log1p(-shift)
    prior[_OTHER_LEVEL] = math.log(shift / (LEVELS - 1))
    prior[_SAME_OFFSET] = math.log1p(-redraw)
    prior[_NEW_OFFSET] = math.log(redraw)


@device
def take(
    kind: int, level: int, mode: int, east: float, north: float, variance: float, colour: float,
    x: FloatArray, P: FloatArray,
) -> int:  # fmt: skip
    """Apply a branch to a predicted state; returns the mode after it."""
    if kind == NOMINAL:
        update(x, P, east, north, variance * LEVEL_FACTOR**level)
        return level
    if kind == WIDE:
        update(x, P, east, north, WIDE_FACTOR * variance * LEVEL_FACTOR**level)
        return level
    if kind == BURST:
        update(x, P, east, north, variance)
        return BURSTING
    if kind == EXIT:
        forget_bias(x, P, colour * colour)
        update(x, P, east, north, variance)
        return 0
    if kind in (ENTRY, REDRAW):
        take_for_bias(x, P, east, north, variance)
        return BURSTING
    if kind == TELEPORT:
        start_at(x, P, east, north, variance, colour, P[1, 1] + JUMP_SPREAD_MPS**2)
        return 0
    return mode
