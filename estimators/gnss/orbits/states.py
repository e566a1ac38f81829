"""Satellite positions, velocities and clocks at the times at which received signals left.

A receiver that reads t when a signal with pseudorange P arrives measures t - P / c on the satellite's clock,
whatever its own clock errs (IS-GPS-200, 20.3.3.3.3.1); the satellite's clock error takes that to system time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.gnss.orbits.ephemerides import Ephemerides
from estimators.gnss.orbits.glonass import BIAS, GAMMA, glonass_state
from estimators.gnss.orbits.kepler import AF0, AF1, AF2, kepler_state
from estimators.gnss.snapshot.linearise import SPEED_OF_LIGHT
from estimators.kernels import kernel, ro

_HALF_S = 0.5
"""Half the span of the central difference for velocities: its error, jerk h^2 / 6, is micrometres/s."""
_ROUNDS = 3


@dataclass(frozen=True, slots=True)
class SatelliteStates:
    """One row per observation.

    Attributes
    ----------
    position_m, velocity_mps : ndarray of float64, shape (rows, 3)
        In the Earth-fixed frame at transmission; NaN without an ephemeris.
    clock_s, drift : ndarray of float64, shape (rows,)
        Satellite clock ahead of system time, relativity included, without group delay; seconds per second.
    """

    position_m: FloatArray
    velocity_mps: FloatArray
    clock_s: FloatArray
    drift: FloatArray


@kernel(
    types.void(
        ro(types.int64),
        ro(types.int64),
        ro(types.float64),
        ro(types.int64),
        ro(types.int64),
        ro(types.float64, 2),
        ro(types.boolean),
        types.float64[:, ::1],
        types.float64[:, ::1],
        types.float64[::1],
        types.float64[::1],
    )
)
def _fill_states(
    which: IntArray,
    time_ns: IntArray,
    ranges: FloatArray,
    toe_ns: IntArray,
    toc_ns: IntArray,
    elements: FloatArray,
    glonass: BoolArray,
    position: FloatArray,
    velocity: FloatArray,
    clock: FloatArray,
    drift: FloatArray,
) -> None:
    early, late = np.empty(3), np.empty(3)
    for row in range(which.size):
        e = which[row]
        if e < 0:
            continue
        travelled = ranges[row] / SPEED_OF_LIGHT
        # Differences of integers first: a nanosecond of 40 years is beyond the digits of a float.
        since_toe = (time_ns[row] - toe_ns[e]) * 1e-9 - travelled
        since_toc = (time_ns[row] - toc_ns[e]) * 1e-9 - travelled
        bias = 0.0
        if glonass[e]:
            for _ in range(_ROUNDS):
                bias = elements[e, BIAS] + elements[e, GAMMA] * (since_toe - bias)
            glonass_state(elements[e], since_toe - bias, position[row], velocity[row])
            clock[row] = bias
            drift[row] = elements[e, GAMMA]
            continue
        x = since_toc
        for _ in range(_ROUNDS):
            x = since_toc - bias
            bias = elements[e, AF0] + elements[e, AF1] * x + elements[e, AF2] * x * x
        tk = since_toe - bias
        before = kepler_state(elements[e], tk - _HALF_S, early)
        after = kepler_state(elements[e], tk + _HALF_S, late)
        clock[row] = bias + kepler_state(elements[e], tk, position[row])
        drift[row] = elements[e, AF1] + 2.0 * elements[e, AF2] * x + (after - before) / (2.0 * _HALF_S)
        for k in range(3):
            velocity[row, k] = (late[k] - early[k]) / (2.0 * _HALF_S)


def satellite_states(
    ephemerides: Ephemerides, which: IntArray, time_ns: IntArray, pseudoranges_m: FloatArray
) -> SatelliteStates:
    """Evaluate ephemerides at the times of transmission.

    Parameters
    ----------
    ephemerides : Ephemerides
    which : ndarray of int64, shape (rows,)
        Of :meth:`Ephemerides.choose`; negative rows stay NaN.
    time_ns : ndarray of int64, shape (rows,)
        Reception by the receiver's clock: nanoseconds of GPS time.
    pseudoranges_m : ndarray of float64, shape (rows,)
        As measured.
    """
    rows = which.size
    states = SatelliteStates(
        np.full((rows, 3), np.nan), np.full((rows, 3), np.nan), np.full(rows, np.nan), np.full(rows, np.nan)
    )
    _fill_states(
        which,
        time_ns,
        pseudoranges_m,
        ephemerides.toe_ns,
        ephemerides.toc_ns,
        ephemerides.elements,
        ephemerides.glonass,
        states.position_m,
        states.velocity_mps,
        states.clock_s,
        states.drift,
    )
    return states
