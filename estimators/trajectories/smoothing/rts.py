"""The smoother of Rauch, Tung and Striebel along a labelled track.

Fixes of a burst are kept as measurements of position plus a bias that walks: they say little about the place
and much about the velocity, so that the track through a burst is better than one that leaves it out.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import CodeArray, FloatArray
from estimators.kernels import arithmetic, kernel, ro
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
from estimators.trajectories.labelling.signature import TRACK
from estimators.trajectories.labelling.state import (
    BB,
    COLUMNS,
    EAST,
    EAST_BIAS,
    EAST_MPS,
    NORTH_BIAS,
    PB,
    PP,
    PV,
    VB,
    VV,
    WITHOUT_PATH,
    copy_state,
    predict,
    start_at,
    swerve,
    update,
)
from estimators.trajectories.labelling.velocity import take_velocity

_FRESH = 1e10
"""Variance of what is not known at all, m^2."""
IN_BURST, IN_HURRY = 1, 2
"""What lasts from row to row; a course of the filter is none, either or both."""


@kernel(
    types.int64(
        *TRACK,
        ro(types.uint8),
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
    state: FloatArray,
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
    state : ndarray, shape (1, 19)
        As the columns of :mod:`estimators.trajectories.labelling.state` name it, before the first row that is
        not yet taken in. Out: after the last row.
    lasting : int
        What lasts at the row before: ``IN_BURST``, ``IN_HURRY``, their sum or 0.
    is_first, is_last : bool
        Whether the track begins, and ends, with this piece.
    states : ndarray, shape (n, 2, 3), or none
        Out: smoothed; position, velocity and bias, east and north. In the last row, unless the piece is the
        last, in: the smoothed state there. Without rows the piece is filtered only.
    covariances : ndarray, shape (n, 3, 3), or none
        Likewise, of each axis.

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
    keep, moved = np.zeros(n), np.zeros(state.shape)
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
            bias = state[0, EAST_BIAS] ** 2 + state[0, NORTH_BIAS] ** 2
            fade, walk = 1.0, dt * bias_walk(bias, colour, rates[R_WALK], rates[R_GROWTH])
        else:
            fade = math.exp(-dt / COLOUR_TIME_S)
            walk = squared * (1.0 - fade * fade)
        keep[k] = fade
        q = hurry(manoeuvre) if hurried else manoeuvre
        if kind != MISSING:
            hurried = level == HURRIED or (kind == TELEPORT and level == SWERVED)
        predict(state, 0, dt, q, fade, walk, moved)
        if kind == TELEPORT and level == SWERVED:
            swerve(moved, 0, dt, UNLIKE)
        elif kind == TELEPORT:
            moved[0, PP] += _FRESH
            moved[0, VV] += JUMP_SPREAD_MPS**2
        if smooths:
            _write(moved, ahead[k], ahead_P[k])
        if velocity_variance[k] < math.inf:
            take_velocity(moved, 0, velocity[k, 0], velocity[k, 1], velocity_variance[k])
        if kind not in (SPIKE, MISSING, ADRIFT):
            noise = (
                variance[k]
                * (1.0 if kind == TELEPORT or level == HURRIED else LEVEL_FACTOR**level)
                * (WIDE_FACTOR if kind == WIDE else 1.0)
            )
            update(moved, 0, fixes[k, 0], fixes[k, 1], noise)
        if smooths:
            _write(moved, filtered[k], filtered_P[k])
        copy_state(moved, 0, state, 0, WITHOUT_PATH)
    lasting = (IN_BURST if bursting else 0) + (IN_HURRY if hurried else 0)
    if not smooths:
        return lasting
    if is_last:
        states[n - 1], covariances[n - 1] = filtered[n - 1], filtered_P[n - 1]
    inverse, factor, gain, held = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for k in range(n - 2, own - 1, -1):
        states[k], covariances[k] = filtered[k], filtered_P[k]
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


def begin(east: float, north: float, colour: float) -> FloatArray:
    """State before a track that is first seen at a place, as :func:`smooth_piece` takes it."""
    state: FloatArray = np.zeros((1, COLUMNS))
    start_at(state, 0, east, north, _FRESH, colour, STILL_SPREAD_MPS**2)
    return state


@arithmetic
def _write(state: FloatArray, x: FloatArray, P: FloatArray) -> None:
    """Write a state as vectors and a matrix."""
    for axis in range(2):
        x[axis, 0] = state[0, EAST + axis]
        x[axis, 1] = state[0, EAST_MPS + axis]
        x[axis, 2] = state[0, EAST_BIAS + axis]
    P[0, 0], P[1, 1], P[2, 2] = state[0, PP], state[0, VV], state[0, BB]
    P[0, 1] = P[1, 0] = state[0, PV]
    P[0, 2] = P[2, 0] = state[0, PB]
    P[1, 2] = P[2, 1] = state[0, VB]
