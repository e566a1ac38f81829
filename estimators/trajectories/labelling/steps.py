"""One step of one hypothesis: foretell it, say what may follow, and follow one of that.

A hypothesis is a row of states (:mod:`estimators.trajectories.labelling.state`), and a mode.
"""

from __future__ import annotations

import math

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import arithmetic
from estimators.trajectories.labelling.astray import UNLIKE, leave_track, move_path, start_path, take_for_path
from estimators.trajectories.labelling.branches import branch_astray, branch_burst, branch_nominal
from estimators.trajectories.labelling.modes import (
    ADRIFT,
    ASTRAY,
    BURST,
    BURSTING,
    COLOUR_TIME_S,
    DRAWN_AWAY,
    ENTRY,
    EXIT,
    GOES_ON,
    HURRIED,
    LEVEL_FACTOR,
    NOMINAL,
    REACH_M,
    REDRAW,
    RESTLESS,
    SPIKE,
    STILL_SPREAD_MPS,
    SWERVED,
    TELEPORT,
    WIDE,
    WIDE_FACTOR,
    bias_walk,
    hurry,
)
from estimators.trajectories.labelling.priors import R_GROWTH, R_WALK
from estimators.trajectories.labelling.state import (
    BB,
    EAST,
    EAST_BIAS,
    NORTH,
    NORTH_BIAS,
    PATH_EAST,
    PATH_NORTH,
    PATH_PP,
    PB,
    PP,
    VV,
    forget_bias,
    predict,
    start_at,
    swerve,
    take_for_bias,
    update,
)

_UNKNOWN_M = 1e3
"""Standard deviation of the position where the first fix is no good."""


@arithmetic
def begin(kind: int, east: float, north: float, variance: float, colour: float, s: FloatArray, h: int) -> int:
    """Begin at a first fix that is nominal, a spike or adrift; returns the mode."""
    start_at(s, h, east, north, variance, colour, STILL_SPREAD_MPS**2)
    if kind == NOMINAL:
        return 0
    s[h, PP] += _UNKNOWN_M**2
    if kind == SPIKE:
        return 0
    forget_bias(s, h, 0.0)
    start_path(s, h, east, north, variance)
    return ASTRAY


@arithmetic
def look_ahead(
    mode: int, dt: float, manoeuvre: float, colour: float, rates: FloatArray, s: FloatArray, h: int,
    ahead: FloatArray,
) -> None:  # fmt: skip
    """Foretell a hypothesis ``dt`` seconds ahead, in the same row of another array."""
    if mode == BURSTING:
        bias = s[h, EAST_BIAS] ** 2 + s[h, NORTH_BIAS] ** 2
        walk = dt * bias_walk(bias, colour, rates[R_WALK], rates[R_GROWTH])
        predict(s, h, dt, manoeuvre, 1.0, walk, ahead)
    elif mode == ASTRAY:
        predict(s, h, dt, manoeuvre, 1.0, 0.0, ahead)
        move_path(s, h, dt, hurry(manoeuvre), ahead)
    else:
        fade = math.exp(-dt / COLOUR_TIME_S)
        density = hurry(manoeuvre) if mode == RESTLESS else manoeuvre
        predict(s, h, dt, density, fade, colour * colour * (1.0 - fade * fade), ahead)


@arithmetic
def branch(
    mode: int, age: float, weight: float, dt: float, east: float, north: float, variance: float,
    colour: float, prior: FloatArray, s: FloatArray, h: int, scores: FloatArray, kinds: IntArray, count: int,
) -> int:  # fmt: skip
    """Append what a hypothesis, foretold, may become at a fix; returns how many branches there are."""
    place = max(s[h, PP], 0.0)
    base = max(place + 2.0 * s[h, PB] + s[h, BB], 0.0)
    off_place = (east - s[h, EAST]) ** 2 + (north - s[h, NORTH]) ** 2
    squared_colour = colour * colour
    core = 9.0 * (variance + squared_colour) + place
    reach = math.log(math.pi * math.log1p(REACH_M * REACH_M / core))
    if mode == ASTRAY:
        off_path = (east - s[h, PATH_EAST]) ** 2 + (north - s[h, PATH_NORTH]) ** 2
        return branch_astray(
            age, dt, weight, s[h, PATH_PP], place + squared_colour, variance, off_path, off_place, core,
            reach, prior, scores, kinds, count,
        )  # fmt: skip
    off = (east - s[h, EAST] - s[h, EAST_BIAS]) ** 2 + (north - s[h, NORTH] - s[h, NORTH_BIAS]) ** 2
    if mode == BURSTING:
        return branch_burst(
            age, dt, weight, base, place + squared_colour, variance, off, off_place, core, reach, prior,
            scores, kinds, count,
        )  # fmt: skip
    return branch_nominal(
        mode, weight, base, variance, UNLIKE * dt * dt, off, off_place, core, reach, prior, scores, kinds,
        count,
    )  # fmt: skip


@arithmetic
def follow(
    kind: int, level: int, mode: int, dt: float, east: float, north: float, variance: float, colour: float,
    s: FloatArray, h: int,
) -> int:  # fmt: skip
    """Follow a branch from a foretold hypothesis, in place; returns the mode after it."""
    if kind == NOMINAL:
        update(s, h, east, north, variance if level == HURRIED else variance * LEVEL_FACTOR**level)
        return level
    if kind == WIDE:
        update(s, h, east, north, WIDE_FACTOR * variance * LEVEL_FACTOR**level)
        return level
    if kind == BURST:
        update(s, h, east, north, variance)
        return BURSTING
    if kind == ADRIFT:
        if level == DRAWN_AWAY:
            leave_track(s, h, dt)
        elif level != GOES_ON:
            start_path(s, h, east, north, variance)
        if level != GOES_ON:
            forget_bias(s, h, 0.0)
        if level in (GOES_ON, DRAWN_AWAY):
            take_for_path(s, h, east, north, variance)
        return ASTRAY
    if kind == EXIT:
        forget_bias(s, h, colour * colour)
        update(s, h, east, north, variance)
        return 0
    if kind == ENTRY and mode == ASTRAY:
        take_for_path(s, h, east, north, variance)
        take_for_bias(s, h, s[h, PATH_EAST], s[h, PATH_NORTH], s[h, PATH_PP])
        return BURSTING
    if kind in (ENTRY, REDRAW):
        take_for_bias(s, h, east, north, variance)
        return BURSTING
    if kind == TELEPORT and level == SWERVED:
        swerve(s, h, dt, UNLIKE)
        update(s, h, east, north, variance)
        return RESTLESS
    if kind == TELEPORT:
        start_at(s, h, east, north, variance, colour, s[h, VV] + UNLIKE)
        return 0
    return mode
