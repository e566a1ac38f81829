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


@kernel(
    types.void(
        ro(types.float64),
        ro(types.float64, 2),
        ro(types.float64),
        ro(types.float64, 2),
        ro(types.float64),
        types.float64,
        types.float64,
        ro(types.float64),
        ro(types.uint8),
        types.float64[:, :, ::1],
        types.float64[:, :, ::1],
    )
)
def smooth_track(
    t: FloatArray,
    fixes: FloatArray,
    variance: FloatArray,
    velocity: FloatArray,
    velocity_variance: FloatArray,
    colour: float,
    manoeuvre: float,
    rates: FloatArray,
    labels: CodeArray,
    states: FloatArray,
    covariances: FloatArray,
) -> None:
    """Smooth a track under its labels.

    Parameters
    ----------
    t, fixes, variance, velocity, velocity_variance, colour, manoeuvre, rates
        As for :func:`estimators.trajectories.labelling.beam.label_track`.
    labels : ndarray of uint8, shape (n,)
        ``MISSING`` where nothing was measured.
    states : ndarray, shape (n, 2, 3)
        Out: position, velocity and bias, east and north.
    covariances : ndarray, shape (n, 3, 3)
        Out; of each axis.
    """
    n = t.size
    first = 0
    while first < n - 1 and labels[first] % LEVEL_STRIDE in (SPIKE, MISSING, ADRIFT):
        first += 1
    x, P = np.zeros((2, 3)), np.zeros((3, 3))
    start_at(x, P, fixes[first, 0], fixes[first, 1], _FRESH, colour, STILL_SPREAD_MPS**2)
    filtered, filtered_P = np.zeros((n, 2, 3)), np.zeros((n, 3, 3))
    ahead, ahead_P = np.zeros((n, 2, 3)), np.zeros((n, 3, 3))
    keep = np.zeros(n)
    squared = colour * colour
    bursting = False
    hurried = False
    for k in range(n):
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
        if kind not in (MISSING,):
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
        _copy(x, P, filtered[k], filtered_P[k])
    _copy(filtered[n - 1], filtered_P[n - 1], states[n - 1], covariances[n - 1])
    inverse, factor, gain, held = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for k in range(n - 2, -1, -1):
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
