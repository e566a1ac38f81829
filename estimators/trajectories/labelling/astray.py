"""The path of fixes that say nothing of the track, neither where it is nor how it moves.

A receiver that is drawn away from its place, or thrown off and creeping back, has fixes that lie on a smooth
path of their own: constant velocity driven by white acceleration, as dense as that of a track in a hurry.
Which velocity the path has is unknown. Its covariance is the same for both axes: pp, pv, vv.
"""

from __future__ import annotations

from estimators.arrays import FloatArray
from estimators.kernels import device
from estimators.trajectories.labelling.modes import JUMP_SPREAD_MPS
from estimators.trajectories.labelling.state import LEAST_VARIANCE, TWIN, TWIN_SPREAD

UNLIKE = JUMP_SPREAD_MPS * JUMP_SPREAD_MPS
"""Variance per axis of the velocity of a path against that of the track where it begins."""


@device
def move_path(
    path: FloatArray,
    spread: FloatArray,
    dt: float,
    density: float,
    ahead: FloatArray,
    ahead_spread: FloatArray,
) -> None:
    """Move a path on by ``dt`` seconds; ``path`` has place and velocity per axis."""
    for axis in range(2):
        ahead[axis, 0] = path[axis, 0] + dt * path[axis, 1]
        ahead[axis, 1] = path[axis, 1]
    ahead_spread[0] = spread[0] + dt * (2.0 * spread[1] + dt * spread[2]) + density * dt * dt * dt / 3.0
    ahead_spread[1] = spread[1] + dt * spread[2] + density * dt * dt / 2.0
    ahead_spread[2] = spread[2] + density * dt


@device
def take_for_path(path: FloatArray, spread: FloatArray, east: float, north: float, variance: float) -> None:
    """Take in a fix of a path."""
    total = spread[0] + variance
    g0, g1 = spread[0] / total, spread[1] / total
    for axis in range(2):
        off = (east if axis == 0 else north) - path[axis, 0]
        path[axis, 0] += g0 * off
        path[axis, 1] += g1 * off
    spread[2] -= g1 * spread[1]
    spread[1] -= g0 * spread[1]
    spread[0] -= g0 * spread[0]


@device
def leave_track(x: FloatArray, P: FloatArray, dt: float, path: FloatArray, spread: FloatArray) -> None:
    """Begin a path where the track was a step ago, given the state now; another velocity since then."""
    for axis in range(2):
        path[axis, 0] = x[axis, 0] + x[axis, 2]
        path[axis, 1] = x[axis, 1]
    spread[0] = max(P[0, 0] + 2.0 * P[0, 2] + P[2, 2], 0.0) + UNLIKE * dt * dt
    spread[1] = UNLIKE * dt
    spread[2] = P[1, 1] + UNLIKE


@device
def start_path(
    x: FloatArray, P: FloatArray, east: float, north: float, variance: float, path: FloatArray,
    spread: FloatArray,
) -> None:  # fmt: skip
    """Begin a path at a fix."""
    path[0, 0], path[1, 0] = east, north
    for axis in range(2):
        path[axis, 1] = x[axis, 1]
    spread[0] = variance
    spread[1] = 0.0
    spread[2] = P[1, 1] + UNLIKE


@device
def are_twin_paths(path: FloatArray, spread: FloatArray, other: FloatArray, other_spread: FloatArray) -> bool:
    """Whether two paths are so alike that only the likelier of them need be followed."""
    for k in range(2):
        own, its = spread[2 * k], other_spread[2 * k]
        apart = (path[0, k] - other[0, k]) ** 2 + (path[1, k] - other[1, k]) ** 2
        if apart >= TWIN * min(own, its) + LEAST_VARIANCE or abs(own - its) >= TWIN_SPREAD * its:
            return False
    return True
