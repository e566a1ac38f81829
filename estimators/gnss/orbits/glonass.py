"""Satellites of GLONASS: a broadcast state, carried on by Runge-Kutta (GLONASS ICD, edition 5.1, A.3.1.2)."""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.kernels import device

X, Y, Z, VX, VY, VZ, AX, AY, AZ, BIAS, GAMMA = range(11)
"""Columns of a broadcast state, SI units: position, velocity, acceleration by Sun and Moon, clock."""
_GM = 398600.44e9
_RADIUS_M = 6378136.0
_J2 = 1082625.7e-9
_TURN = 7.292115e-5
"""PZ-90 (GLONASS ICD, table 3.2 and A.3.1.2)."""
_STEP_S = 60.0


@device
def _slope(state: FloatArray, elements: FloatArray, out: FloatArray) -> None:
    """Equations of motion in the turning frame."""
    x, y, z, vx, vy, vz = state[0], state[1], state[2], state[3], state[4], state[5]
    r2 = x * x + y * y + z * z
    r3 = r2 * math.sqrt(r2)
    flat = 1.5 * _J2 * _GM * _RADIUS_M**2 / (r2 * r3)
    tilt = 5.0 * z * z / r2
    out[0] = vx
    out[1] = vy
    out[2] = vz
    out[3] = (-_GM / r3 - flat * (1.0 - tilt) + _TURN**2) * x + 2.0 * _TURN * vy + elements[AX]
    out[4] = (-_GM / r3 - flat * (1.0 - tilt) + _TURN**2) * y - 2.0 * _TURN * vx + elements[AY]
    out[5] = (-_GM / r3 - flat * (3.0 - tilt)) * z + elements[AZ]


@device
def glonass_state(elements: FloatArray, tk: float, out: FloatArray, velocity: FloatArray) -> None:
    """Write position and velocity in the Earth-fixed frame of that instant, ``tk`` seconds after toe."""
    state, middle, sum_ = np.empty(6), np.empty(6), np.empty(6)
    slope = np.empty(6)
    for k in range(6):
        state[k] = elements[k]
    left = tk
    while abs(left) > 1e-9:
        h = max(-_STEP_S, min(_STEP_S, left))
        _slope(state, elements, slope)
        for k in range(6):
            sum_[k] = slope[k]
            middle[k] = state[k] + 0.5 * h * slope[k]
        _slope(middle, elements, slope)
        for k in range(6):
            sum_[k] += 2.0 * slope[k]
            middle[k] = state[k] + 0.5 * h * slope[k]
        _slope(middle, elements, slope)
        for k in range(6):
            sum_[k] += 2.0 * slope[k]
            middle[k] = state[k] + h * slope[k]
        _slope(middle, elements, slope)
        for k in range(6):
            state[k] += h / 6.0 * (sum_[k] + slope[k])
        left -= h
    for k in range(3):
        out[k] = state[k]
        velocity[k] = state[3 + k]
