"""Where the receiver roughly was, from a cold start.

Elevations, and so ionosphere and troposphere, depend on the position, and the position on them: each epoch is
solved from the Earth's centre without corrections, corrected, and solved again. The position only serves the
corrections, which forgive a kilometre; still, weights of Huber's kind keep gross faults from dragging it off.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.geodesy.ellipsoid import geodetic_of
from estimators.gnss.corrections.atmosphere import fill_corrections
from estimators.gnss.snapshot.linearise import iterate
from estimators.kernels import device, kernel, ro

_HUBER_M = 100.0
_REWEIGHTED = 12
_SETTLED_M = 100.0
_DEEPEST_M, _HIGHEST_M = -20e3, 2000e3
"""Heights of receivers: from the deepest trench to low orbits."""
_CORRECTED = 2
"""Rounds of correcting and solving: the first is right to metres, the second to millimetres."""


@device
def _solve_robustly(
    satellites: FloatArray,
    ranges: FloatArray,
    clock: IntArray,
    clocks: int,
    rotated: bool,
    used: BoolArray,
    state: FloatArray,
) -> bool:
    n, p = ranges.size, 3 + clocks
    A, z = np.empty((n, p)), np.empty(n)
    factor, step, sigma = np.empty((p, p)), np.empty(p), np.ones(n)
    last = np.empty(3)
    for turn in range(_REWEIGHTED):
        if not iterate(satellites, ranges, sigma, clock, rotated, used, state, A, z, factor, step):
            return False
        moved = 0.0
        largest = 0.0
        for k in range(3):
            if turn > 0:
                moved = max(moved, abs(state[k] - last[k]))
            last[k] = state[k]
        for i in range(n):
            if used[i]:
                size = abs(z[i]) * sigma[i]
                largest = max(largest, size)
                sigma[i] = math.sqrt(max(1.0, size / _HUBER_M))
        if largest < _HUBER_M or (turn > 0 and moved < _SETTLED_M):
            break
    _, _, height = geodetic_of(state[0], state[1], state[2])
    return _DEEPEST_M < height < _HIGHEST_M


@device
def _locate_roughly(
    satellites: FloatArray,
    ranges: FloatArray,
    clock: IntArray,
    clocks: int,
    rotated: bool,
    used: BoolArray,
    place: FloatArray,
) -> bool:
    """Write a position; where satellites are too few for a clock each, with one clock for all systems."""
    count = 0
    for i in range(ranges.size):
        if used[i]:
            count += 1
    present = np.zeros(clocks, np.bool_)
    for i in range(ranges.size):
        if used[i]:
            present[clock[i]] = True
    all_present = True
    for j in range(clocks):
        all_present = all_present and present[j]
    if count > 3 + clocks and all_present:
        state = np.zeros(3 + clocks)
        if _solve_robustly(satellites, ranges, clock, clocks, rotated, used, state):
            for k in range(3):
                place[k] = state[k]
            return True
    if count < 4:
        return False
    # Clocks of systems differ by well under a microsecond: 300 m, which the corrections forgive.
    state = np.zeros(4)
    if _solve_robustly(satellites, ranges, np.zeros(ranges.size, np.int64), 1, rotated, used, state):
        for k in range(3):
            place[k] = state[k]
        return True
    return False


@kernel(
    types.void(
        ro(types.float64, 2),
        ro(types.float64),
        ro(types.int64),
        ro(types.int64),
        ro(types.int64),
        types.boolean,
        ro(types.float64),
        ro(types.float64),
        ro(types.float64),
        types.boolean,
        types.float64,
        types.float64[:, ::1],
        types.boolean[::1],
    )
)
def fill_places(
    satellites: FloatArray,
    ranges: FloatArray,
    clock: IntArray,
    offsets: IntArray,
    clocks: IntArray,
    rotated: bool,
    seconds: FloatArray,
    coefficients: FloatArray,
    ionosphere_gain: FloatArray,
    troposphere: bool,
    mask: float,
    places: FloatArray,
    solved: BoolArray,
) -> None:
    """Locate epochs, each on its own; see :func:`estimators.gnss.corrections.atmosphere.fill_atmosphere`.

    Parameters
    ----------
    satellites, ranges, clock : ndarray, one row per satellite and epoch
        Ranges corrected for the satellite clocks.
    offsets, clocks, seconds : ndarray
        Rows of the epochs, their number of receiver clocks, and the second of GPS time.
    rotated, coefficients, ionosphere_gain, troposphere
        As there.
    mask : float
        Radians; satellites below take no part once the first position is known.
    places, solved : ndarray, shape (epochs, 3) and (epochs,)
        Out: position, and whether there is one.
    """
    for e in range(offsets.size - 1):
        a, b = offsets[e], offsets[e + 1]
        n = b - a
        used = np.ones(n, np.bool_)
        azimuth, elevation, ionosphere, wet_and_dry = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
        corrected = ranges[a:b].copy()
        solved[e] = _locate_roughly(
            satellites[a:b], corrected, clock[a:b], clocks[e], rotated, used, places[e]
        )
        if not solved[e]:
            continue
        for _ in range(_CORRECTED):
            fill_corrections(
                satellites[a:b],
                rotated,
                places[e],
                seconds[e],
                coefficients,
                ionosphere_gain[a:b],
                troposphere,
                azimuth,
                elevation,
                ionosphere,
                wet_and_dry,
            )
            for i in range(n):
                corrected[i] = ranges[a + i] - ionosphere[i] - wet_and_dry[i]
                used[i] = elevation[i] >= mask
            if not _locate_roughly(
                satellites[a:b], corrected, clock[a:b], clocks[e], rotated, used, places[e]
            ):
                break
