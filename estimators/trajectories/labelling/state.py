"""The state of a hypothesis, a row of an array: position, velocity and bias in two axes, and one covariance.

Both axes share the covariance of position (P), velocity (V) and bias (B). A hypothesis that is astray has the
path of its fixes in the same row (:mod:`estimators.trajectories.labelling.astray`). The functions take the
array and the number of the row: views of rows would cost more than what is done to them.
"""

from __future__ import annotations

import math

from estimators.arrays import FloatArray
from estimators.kernels import arithmetic

(
    EAST, NORTH, EAST_MPS, NORTH_MPS, EAST_BIAS, NORTH_BIAS, PP, PV, PB, VV, VB, BB,
    PATH_EAST, PATH_NORTH, PATH_EAST_MPS, PATH_NORTH_MPS, PATH_PP, PATH_PV, PATH_VV,
) = range(19)  # fmt: skip
"""Columns of a state."""
COLUMNS = 19
WITHOUT_PATH = PATH_EAST
"""Columns of a state that has no path of its own."""


@arithmetic
def predict(
    s: FloatArray, h: int, dt: float, manoeuvre: float, keep: float, walk: float, ahead: FloatArray
) -> None:
    """Move a state on by ``dt`` seconds: white acceleration, the bias times ``keep`` plus a variance."""
    ahead[h, EAST] = s[h, EAST] + dt * s[h, EAST_MPS]
    ahead[h, NORTH] = s[h, NORTH] + dt * s[h, NORTH_MPS]
    ahead[h, EAST_MPS] = s[h, EAST_MPS]
    ahead[h, NORTH_MPS] = s[h, NORTH_MPS]
    ahead[h, EAST_BIAS] = keep * s[h, EAST_BIAS]
    ahead[h, NORTH_BIAS] = keep * s[h, NORTH_BIAS]
    ahead[h, PP] = s[h, PP] + 2.0 * dt * s[h, PV] + dt * dt * s[h, VV] + manoeuvre * dt * dt * dt / 3.0
    ahead[h, PV] = s[h, PV] + dt * s[h, VV] + manoeuvre * dt * dt / 2.0
    ahead[h, VV] = s[h, VV] + manoeuvre * dt
    ahead[h, PB] = keep * (s[h, PB] + dt * s[h, VB])
    ahead[h, VB] = keep * s[h, VB]
    ahead[h, BB] = keep * keep * s[h, BB] + walk


@arithmetic
def update(s: FloatArray, h: int, east: float, north: float, variance: float) -> None:
    """Take in a fix of position plus bias."""
    g0 = s[h, PP] + s[h, PB]
    g1 = s[h, PV] + s[h, VB]
    g2 = s[h, PB] + s[h, BB]
    off_east, off_north = east - s[h, EAST] - s[h, EAST_BIAS], north - s[h, NORTH] - s[h, NORTH_BIAS]
    correct(s, h, g0, g1, g2, max(g0 + g2, 0.0) + variance, off_east, off_north)


@arithmetic
def correct(
    s: FloatArray, h: int, g0: float, g1: float, g2: float, total: float, off_east: float, off_north: float
) -> None:
    """Take in a measurement that is off so far; ``g`` is its covariance with position, velocity and bias."""
    for axis in range(2):
        off = (off_east if axis == 0 else off_north) / total
        s[h, EAST + axis] += g0 * off
        s[h, EAST_MPS + axis] += g1 * off
        s[h, EAST_BIAS + axis] += g2 * off
    # Rounding after a long step must not leave a variance below zero.
    s[h, PP] = max(s[h, PP] - g0 * g0 / total, 0.0)
    s[h, PV] -= g0 * g1 / total
    s[h, PB] -= g0 * g2 / total
    s[h, VV] = max(s[h, VV] - g1 * g1 / total, 0.0)
    s[h, VB] -= g1 * g2 / total
    s[h, BB] = max(s[h, BB] - g2 * g2 / total, 0.0)


@arithmetic
def swerve(s: FloatArray, h: int, dt: float, variance: float) -> None:
    """Let the velocity have jumped a step ago, by a variance."""
    s[h, PP] += dt * dt * variance
    s[h, PV] += dt * variance
    s[h, VV] += variance


@arithmetic
def forget_bias(s: FloatArray, h: int, variance: float) -> None:
    """Give the state a fresh bias of mean 0."""
    s[h, EAST_BIAS] = 0.0
    s[h, NORTH_BIAS] = 0.0
    s[h, PB] = 0.0
    s[h, VB] = 0.0
    s[h, BB] = variance


@arithmetic
def take_for_bias(s: FloatArray, h: int, east: float, north: float, variance: float) -> None:
    """Let the bias be all that a fix is off, whatever it was before."""
    s[h, EAST_BIAS] = east - s[h, EAST]
    s[h, NORTH_BIAS] = north - s[h, NORTH]
    s[h, PB] = -s[h, PP]
    s[h, VB] = -s[h, PV]
    s[h, BB] = s[h, PP] + variance


@arithmetic
def start_at(
    s: FloatArray, h: int, east: float, north: float, variance: float, colour: float, velocity: float
) -> None:
    """Begin at a fix, with nothing known but it and the variance of velocities."""
    squared = colour * colour
    s[h, EAST] = east
    s[h, NORTH] = north
    for column in range(EAST_MPS, PP):
        s[h, column] = 0.0
    s[h, PP] = variance + squared
    s[h, PV] = 0.0
    s[h, VV] = velocity
    s[h, PB] = -squared
    s[h, VB] = 0.0
    s[h, BB] = squared


@arithmetic
def copy_state(s: FloatArray, h: int, out: FloatArray, to: int, columns: int) -> None:
    """Copy the first so many columns of a state."""
    for column in range(columns):
        out[to, column] = s[h, column]


@arithmetic
def is_too_fast(s: FloatArray, h: int, top_speed: float) -> bool:
    """Whether a state moves faster than the track can, by more than three standard deviations."""
    return math.hypot(s[h, EAST_MPS], s[h, NORTH_MPS]) > top_speed + 3.0 * math.sqrt(s[h, VV])
