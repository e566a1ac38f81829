"""The path of fixes that say nothing of the track, neither where it is nor how it moves.

A receiver that is drawn away from its place, or thrown off and creeping back, has fixes that lie on a smooth
path of their own: constant velocity driven by white acceleration, as dense as that of a track in a hurry.
Which velocity the path has is unknown. Its covariance is the same for both axes.
"""

from __future__ import annotations

from estimators.arrays import FloatArray
from estimators.kernels import arithmetic
from estimators.trajectories.labelling.modes import JUMP_SPREAD_MPS
from estimators.trajectories.labelling.state import (
    BB,
    EAST,
    EAST_BIAS,
    EAST_MPS,
    PATH_EAST,
    PATH_EAST_MPS,
    PATH_NORTH,
    PATH_PP,
    PATH_PV,
    PATH_VV,
    PB,
    PP,
    VV,
)

UNLIKE = JUMP_SPREAD_MPS * JUMP_SPREAD_MPS
"""Variance per axis of the velocity of a path against that of the track where it begins."""


@arithmetic
def move_path(s: FloatArray, h: int, dt: float, density: float, ahead: FloatArray) -> None:
    """Move a path on by ``dt`` seconds."""
    for axis in range(2):
        ahead[h, PATH_EAST + axis] = s[h, PATH_EAST + axis] + dt * s[h, PATH_EAST_MPS + axis]
        ahead[h, PATH_EAST_MPS + axis] = s[h, PATH_EAST_MPS + axis]
    pp, pv, vv = s[h, PATH_PP], s[h, PATH_PV], s[h, PATH_VV]
    ahead[h, PATH_PP] = pp + dt * (2.0 * pv + dt * vv) + density * dt * dt * dt / 3.0
    ahead[h, PATH_PV] = pv + dt * vv + density * dt * dt / 2.0
    ahead[h, PATH_VV] = vv + density * dt


@arithmetic
def take_for_path(s: FloatArray, h: int, east: float, north: float, variance: float) -> None:
    """Take in a fix of a path."""
    total = s[h, PATH_PP] + variance
    g0, g1 = s[h, PATH_PP] / total, s[h, PATH_PV] / total
    for axis in range(2):
        off = (east if axis == 0 else north) - s[h, PATH_EAST + axis]
        s[h, PATH_EAST + axis] += g0 * off
        s[h, PATH_EAST_MPS + axis] += g1 * off
    s[h, PATH_VV] -= g1 * s[h, PATH_PV]
    s[h, PATH_PV] -= g0 * s[h, PATH_PV]
    s[h, PATH_PP] -= g0 * s[h, PATH_PP]


@arithmetic
def leave_track(s: FloatArray, h: int, dt: float) -> None:
    """Begin a path where the track was a step ago, given the state now; another velocity since then."""
    for axis in range(2):
        s[h, PATH_EAST + axis] = s[h, EAST + axis] + s[h, EAST_BIAS + axis]
        s[h, PATH_EAST_MPS + axis] = s[h, EAST_MPS + axis]
    s[h, PATH_PP] = max(s[h, PP] + 2.0 * s[h, PB] + s[h, BB], 0.0) + UNLIKE * dt * dt
    s[h, PATH_PV] = UNLIKE * dt
    s[h, PATH_VV] = s[h, VV] + UNLIKE


@arithmetic
def start_path(s: FloatArray, h: int, east: float, north: float, variance: float) -> None:
    """Begin a path at a fix."""
    s[h, PATH_EAST], s[h, PATH_NORTH] = east, north
    for axis in range(2):
        s[h, PATH_EAST_MPS + axis] = s[h, EAST_MPS + axis]
    s[h, PATH_PP] = variance
    s[h, PATH_PV] = 0.0
    s[h, PATH_VV] = s[h, VV] + UNLIKE
