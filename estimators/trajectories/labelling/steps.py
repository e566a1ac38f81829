"""One step of one hypothesis: foretell it, say what may follow, and follow one of that.

A hypothesis is a state (position, velocity, bias) with its covariance, and while it is astray the path that
the fixes follow, with its covariance.
"""

from __future__ import annotations

import math

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import device
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
    forget_bias,
    predict,
    start_at,
    swerve,
    take_for_bias,
    update,
)

_UNKNOWN_M = 1e3
"""Standard deviation of the position where the first fix is no good."""


@device
def begin(
    kind: int, east: float, north: float, variance: float, colour: float, x: FloatArray, P: FloatArray,
    path: FloatArray, spread: FloatArray,
) -> int:  # fmt: skip
    """Begin at a first fix that is nominal, a spike or adrift; returns the mode."""
    start_at(x, P, east, north, variance, colour, STILL_SPREAD_MPS**2)
    if kind == NOMINAL:
        return 0
    P[0, 0] += _UNKNOWN_M**2
    if kind == SPIKE:
        return 0
    forget_bias(x, P, 0.0)
    start_path(x, P, east, north, variance, path, spread)
    return ASTRAY


@device
def look_ahead(
    mode: int, dt: float, manoeuvre: float, colour: float, rates: FloatArray, x: FloatArray, P: FloatArray,
    path: FloatArray, spread: FloatArray, x_ahead: FloatArray, P_ahead: FloatArray, path_ahead: FloatArray,
    spread_ahead: FloatArray,
) -> None:  # fmt: skip
    """Foretell a hypothesis ``dt`` seconds ahead."""
    if mode == BURSTING:
        bias = x[0, 2] ** 2 + x[1, 2] ** 2
        walk = dt * bias_walk(bias, colour, rates[R_WALK], rates[R_GROWTH])
        predict(x, P, dt, manoeuvre, 1.0, walk, x_ahead, P_ahead)
    elif mode == ASTRAY:
        predict(x, P, dt, manoeuvre, 1.0, 0.0, x_ahead, P_ahead)
        move_path(path, spread, dt, hurry(manoeuvre), path_ahead, spread_ahead)
    else:
        fade = math.exp(-dt / COLOUR_TIME_S)
        density = hurry(manoeuvre) if mode == RESTLESS else manoeuvre
        predict(x, P, dt, density, fade, colour * colour * (1.0 - fade * fade), x_ahead, P_ahead)


@device
def branch(
    mode: int, age: float, weight: float, dt: float, east: float, north: float, variance: float,
    colour: float, prior: FloatArray, x: FloatArray, P: FloatArray, path: FloatArray, spread: FloatArray,
    scores: FloatArray, kinds: IntArray, count: int,
) -> int:  # fmt: skip
    """Append what a hypothesis, foretold, may become at a fix; returns how many branches there are."""
    place = max(P[0, 0], 0.0)
    base = max(place + 2.0 * P[0, 2] + P[2, 2], 0.0)
    off_place = (east - x[0, 0]) ** 2 + (north - x[1, 0]) ** 2
    squared_colour = colour * colour
    core = 9.0 * (variance + squared_colour) + place
    reach = math.log(math.pi * math.log1p(REACH_M * REACH_M / core))
    if mode == ASTRAY:
        off_path = (east - path[0, 0]) ** 2 + (north - path[1, 0]) ** 2
        return branch_astray(
            age, dt, weight, spread[0], place + squared_colour, variance, off_path, off_place, core, reach,
            prior, scores, kinds, count,
        )  # fmt: skip
    off = (east - x[0, 0] - x[0, 2]) ** 2 + (north - x[1, 0] - x[1, 2]) ** 2
    if mode == BURSTING:
        return branch_burst(
            age, dt, weight, base, place + squared_colour, variance, off, off_place, core, reach, prior,
            scores, kinds, count,
        )  # fmt: skip
    return branch_nominal(
        mode, weight, base, variance, UNLIKE * dt * dt, off, off_place, core, reach, prior, scores, kinds,
        count,
    )  # fmt: skip


@device
def follow(
    kind: int, level: int, mode: int, dt: float, east: float, north: float, variance: float, colour: float,
    x: FloatArray, P: FloatArray, path: FloatArray, spread: FloatArray,
) -> int:  # fmt: skip
    """Follow a branch from a foretold hypothesis, in place; returns the mode after it."""
    if kind == NOMINAL:
        update(x, P, east, north, variance if level == HURRIED else variance * LEVEL_FACTOR**level)
        return level
    if kind == WIDE:
        update(x, P, east, north, WIDE_FACTOR * variance * LEVEL_FACTOR**level)
        return level
    if kind == BURST:
        update(x, P, east, north, variance)
        return BURSTING
    if kind == ADRIFT:
        if level == DRAWN_AWAY:
            leave_track(x, P, dt, path, spread)
        elif level != GOES_ON:
            start_path(x, P, east, north, variance, path, spread)
        if level != GOES_ON:
            forget_bias(x, P, 0.0)
        if level in (GOES_ON, DRAWN_AWAY):
            take_for_path(path, spread, east, north, variance)
        return ASTRAY
    if kind == EXIT:
        forget_bias(x, P, colour * colour)
        update(x, P, east, north, variance)
        return 0
    if kind == ENTRY and mode == ASTRAY:
        take_for_path(path, spread, east, north, variance)
        take_for_bias(x, P, path[0, 0], path[1, 0], spread[0])
        return BURSTING
    if kind in (ENTRY, REDRAW):
        take_for_bias(x, P, east, north, variance)
        return BURSTING
    if kind == TELEPORT and level == SWERVED:
        swerve(P, dt, UNLIKE)
        update(x, P, east, north, variance)
        return RESTLESS
    if kind == TELEPORT:
        start_at(x, P, east, north, variance, colour, P[1, 1] + UNLIKE)
        return 0
    return mode
