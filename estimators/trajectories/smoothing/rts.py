"""The smoother of Rauch, Tung and Striebel along a labelled track.

Fixes of a burst are kept as measurements of position plus a bias that walks: they say little about the place
and much about the velocity, so that the track through a burst is better than one that leaves it out.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import CodeArray, FloatArray
from estimators.kernels import device, kernel, ro
from estimators.statespace.chain import invert
from estimators.trajectories.labelling.astray import UNLIKE
from estimators.trajectories.labelling.modes import (
    ADRIFT,
    COLOUR_TIME_S,
    ENTRY,
    EXIT,
    HURRIED,
    JUMP_SPREAD_MPS,
    LEVEL_FACTOR,
    LEVEL_STRIDE,
    LONGEST_S,
    MISSING,
    REDRAW,
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
from estimators.trajectories.labelling.state import start_at, swerve, update
from estimators.trajectories.labelling.velocity import take_velocity

_FRESH = 1e10
"""Variance of what is not known at all, m^2."""
IN_BURST, IN_HURRY = 1, 2
"""What lasts from row to row; a course of the filter is none, either or both."""


@kernel(
    types.int64(
        ro(types.float64),
        ro(types.float64, 2),
        ro(types.float64),
        ro(types.float64, 2),
        ro(types.float64),
        types.float64,
        types.float64,
        ro(types.float64),
        ro(types.uint8),
        types.float64[:, ::1],
        types.float64[:, ::1],
        types.int64,
        types.boolean,
        types.boolean,
        types.float64[:, :, ::1],
        types.float64[:, :, ::1],
    )
)
def smooth_piece(
    t: FloatArray,
    fixes: FloatArray,
    variance: FloatArray,
    velocity: FloatArray,
    velocity_variance: FloatArray,
    colour: float,
    manoeuvre: float,
    rates: FloatArray,
    labels: CodeArray,
    x: FloatArray,
    P: FloatArray,
    lasting: int,
    is_first: bool,
    is_last: bool,
    states: FloatArray,
    covariances: FloatArray,
) -> int:
    """Filter a piece of a track under its labels and, on request, smooth it.

    The filter goes on from what the piece before left, the smoother from what the piece behind begins with:
    the pieces are those of the track smoothed as a whole, to the bit.

    Parameters
    ----------
    t, fixes, variance, velocity, velocity_variance, colour, manoeuvre, rates
        As for :func:`estimators.trajectories.labelling.beam.label_piece`. Unless the piece is the first, its
        first row is the last of the piece before; unless it is the last, its last is the first of the next.
    labels : ndarray of uint8, shape (n,)
        ``MISSING`` where nothing was measured.
    x : ndarray, shape (2, 3)
        Position, velocity and bias, east and north, before the first row that is not yet taken in. Out: after
        the last row.
    P : ndarray, shape (3, 3)
        Its covariance, of each axis; likewise.
    lasting : int
        What lasts at the row before: ``IN_BURST``, ``IN_HURRY``, their sum or 0.
    is_first, is_last : bool
        Whether the track begins, and ends, with this piece.
    states : ndarray, shape (n, 2, 3), or none
        Out: smoothed. In the last row, unless the piece is the last, in: the smoothed state there. Without
        rows the piece is filtered only.
    covariances : ndarray, shape (n, 3, 3), or none
        Likewise.

    Returns
    -------
    int
        What lasts at the last row.
    """
    n = t.size
    smooths = states.shape[0] > 0
    rows = n if smooths else 1
    filtered, filtered_P = np.zeros((rows, 2, 3)), np.zeros((rows, 3, 3))
    ahead, ahead_P = np.zeros((rows, 2, 3)), np.zeros((rows, 3, 3))
    keep = np.zeros(n)
    squared = colour * colour
    own = 0 if is_first else 1
    bursting, hurried = lasting & IN_BURST != 0, lasting & IN_HURRY != 0
    for k in range(own, n):
        kind, level = labels[k] % LEVEL_STRIDE, labels[k] // LEVEL_STRIDE
        dt = min(t[k] - t[k - 1], LONGEST_S) if k > 0 else 0.0
        if kind in (ENTRY, REDRAW):
            fade, walk, bursting = 0.0, _FRESH, True
        elif kind == EXIT or (kind == TELEPORT and level != SWERVED):
            fade, walk, bursting = 0.0, squared, False
        elif bursting:
            bias = x[0, 2] * x[0, 2] + x[1, 2] * x[1, 2]
            fade, walk = 1.0, dt * bias_walk(bias, colour, rates[R_WALK], rates[R_GROWTH])
        else:
            fade = math.exp(-dt / COLOUR_TIME_S)
            walk = squared * (1.0 - fade * fade)
        keep[k] = fade
        q = hurry(manoeuvre) if hurried else manoeuvre
        if kind != MISSING:
            hurried = level == HURRIED or (kind == TELEPORT and level == SWERVED)
        for axis in range(2):
            x[axis, 0] += dt * x[axis, 1]
            x[axis, 2] *= fade
        P[0, 0] += 2.0 * dt * P[0, 1] + dt * dt * P[1, 1] + q * dt * dt * dt / 3.0
        P[0, 1] += dt * P[1, 1] + q * dt * dt / 2.0
        P[0, 2] = fade * (P[0, 2] + dt * P[1, 2])
        P[1, 1] += q * dt
        P[1, 2] *= fade
        P[2, 2] = fade * fade * P[2, 2] + walk
        if kind == TELEPORT and level == SWERVED:
            swerve(P, dt, UNLIKE)
        elif kind == TELEPORT:
            P[0, 0] += _FRESH
            P[1, 1] += JUMP_SPREAD_MPS**2
        if smooths:
            _copy(x, P, ahead[k], ahead_P[k])
        if velocity_variance[k] < math.inf:
            take_velocity(x, P, velocity[k, 0], velocity[k, 1], velocity_variance[k])
        if kind not in (SPIKE, MISSING, ADRIFT):
            noise = (
                variance[k]
                * (1.0 if kind == TELEPORT or level == HURRIED else LEVEL_FACTOR**level)
                * (WIDE_FACTOR if kind == WIDE else 1.0)
            )
            update(x, P, fixes[k, 0], fixes[k, 1], noise)
        if smooths:
            _copy(x, P, filtered[k], filtered_P[k])
    lasting = (IN_BURST if bursting else 0) + (IN_HURRY if hurried else 0)
    if not smooths:
        return lasting
    if is_last:
        _copy(filtered[n - 1], filtered_P[n - 1], states[n - 1], covariances[n - 1])
    inverse, factor, gain, held = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for k in range(n - 2, own - 1, -1):
        _copy(filtered[k], filtered_P[k], states[k], covariances[k])
        if not invert(ahead_P[k + 1], inverse, factor):
            continue
        dt, fade = min(t[k + 1] - t[k], LONGEST_S), keep[k + 1]
        # gain = P F' (F P F' + Q)^-1, and P F' is P with its columns combined as F combines states.
        for i in range(3):
            held[i, 0] = filtered_P[k, i, 0] + dt * filtered_P[k, i, 1]
            held[i, 1] = filtered_P[k, i, 1]
            held[i, 2] = fade * filtered_P[k, i, 2]
        for i in range(3):
            for j in range(3):
                total = 0.0
                for m in range(3):
                    total += held[i, m] * inverse[m, j]
                gain[i, j] = total
        for axis in range(2):
            for i in range(3):
                for j in range(3):
                    states[k, axis, i] += gain[i, j] * (states[k + 1, axis, j] - ahead[k + 1, axis, j])
        for i in range(3):
            for j in range(3):
                total = 0.0
                for m in range(3):
                    total += gain[i, m] * (covariances[k + 1, m, j] - ahead_P[k + 1, m, j])
                held[i, j] = total
        for i in range(3):
            for j in range(3):
                for m in range(3):
                    covariances[k, i, j] += held[i, m] * gain[j, m]
    return lasting


def begin(east: float, north: float, colour: float) -> tuple[FloatArray, FloatArray]:
    """State and covariance before a track that is first seen at a place."""
    x, P = np.zeros((2, 3)), np.zeros((3, 3))
    start_at(x, P, east, north, _FRESH, colour, STILL_SPREAD_MPS**2)
    return x, P


@device
def _copy(x: FloatArray, P: FloatArray, out: FloatArray, out_P: FloatArray) -> None:
    """Copy a state; of the covariance the upper triangle is read and both are written."""
    for axis in range(2):
        for i in range(3):
            out[axis, i] = x[axis, i]
    for i in range(3):
        for j in range(i, 3):
            out_P[i, j] = P[i, j]
            out_P[j, i] = P[i, j]
