"""How a moving receiver and its clock go on from epoch to epoch, and what a range tells of their state.

White acceleration in the local frame, a clock whose drift wanders, and offsets between systems that hardly
do: the customary model of kinematic positioning (METHODS_GNSS, "Cities").
"""

from __future__ import annotations

import math

from estimators.arrays import FloatArray
from estimators.gnss.snapshot.linearise import EARTH_RATE, SPEED_OF_LIGHT
from estimators.kernels import device

FIXED_STATES = 8
"""East, north, up, their velocities, clock in metres and its drift; then an offset per further system."""
_VELOCITY_MPS = 300.0
_DRIFT_MPS = 1e4
_OFFSET_M = 1e5
"""Standard deviations of what the first epoch knows beforehand: next to nothing."""
_OFFSET_WALK = 1e-4
"""Square metres per second that an offset between systems may wander."""
_LEAST_STEP_S = 1e-3
_POSITION_WALK, _VELOCITY_WALK = 1e-6, 1e-8
"""Keep the inverse noise finite for a receiver of which no acceleration is expected."""


@device
def fill_transitions(times: FloatArray, noise: FloatArray, F: FloatArray, W: FloatArray) -> None:
    """Write transitions and inverse noise of a chain.

    Parameters
    ----------
    times : ndarray, shape (T,)
        Seconds, in order; epochs of equal times count as a millisecond apart.
    noise : ndarray, shape (4,)
        Densities of the horizontal and the vertical acceleration (m2/s3), of the clock (m2/s) and of its
        drift (m2/s3).
    F, W : ndarray, shape (T - 1, d, d)
        Out.
    """
    d = F.shape[1]
    for k in range(times.size - 1):
        dt = max(times[k + 1] - times[k], _LEAST_STEP_S)
        for i in range(d):
            F[k, i, i] = 1.0
        for i in range(3):
            F[k, i, 3 + i] = dt
            density = noise[1] if i == 2 else noise[0]
            _fill_pair(
                density * dt**3 / 3.0 + _POSITION_WALK * dt,
                density * dt * dt / 2.0,
                density * dt + _VELOCITY_WALK * dt,
                i,
                3 + i,
                W[k],
            )
        F[k, 6, 7] = dt
        _fill_pair(
            noise[3] * dt**3 / 3.0 + noise[2] * dt, noise[3] * dt * dt / 2.0, noise[3] * dt, 6, 7, W[k]
        )
        for i in range(FIXED_STATES, d):
            W[k, i, i] = 1.0 / (_OFFSET_WALK * dt)


@device
def _fill_pair(a: float, b: float, c: float, first: int, second: int, W: FloatArray) -> None:
    """Inverse of [[a, b], [b, c]]."""
    det = a * c - b * b
    W[first, first] = c / det
    W[first, second] = -b / det
    W[second, first] = -b / det
    W[second, second] = a / det


@device
def fill_prior(H: FloatArray) -> None:
    """Add what is known of velocity, drift and offsets before anything is measured."""
    for i in range(3):
        H[3 + i, 3 + i] += 1.0 / _VELOCITY_MPS**2
    H[7, 7] += 1.0 / _DRIFT_MPS**2
    for i in range(FIXED_STATES, H.shape[0]):
        H[i, i] += 1.0 / _OFFSET_M**2


@device
def transition_cost(F: FloatArray, W: FloatArray, x: FloatArray) -> float:
    """Half the sum of squares by which states depart from where their predecessors lead."""
    T, d = x.shape
    total = 0.0
    for k in range(T - 1):
        for i in range(d):
            off = x[k + 1, i]
            for j in range(d):
                off -= F[k, i, j] * x[k, j]
            for m in range(d):
                other = x[k + 1, m]
                for j in range(d):
                    other -= F[k, m, j] * x[k, j]
                total += 0.5 * off * W[k, i, m] * other
    return total


@device
def fill_range_row(
    satellite: FloatArray,
    velocity: FloatArray,
    rotated: bool,
    place: FloatArray,
    axes: FloatArray,
    system: int,
    row: FloatArray,
) -> tuple[float, float]:
    """Write the derivative of a range by the state.

    Returns
    -------
    tuple of float
        The geometric range, and how fast it grows by the satellite's motion alone (the change of the Sagnac
        effect, below 2 cm/s, is left out).
    """
    sx, sy, sz = satellite[0], satellite[1], satellite[2]
    vx, vy, vz = velocity[0], velocity[1], velocity[2]
    if not rotated:
        travelled = math.sqrt((sx - place[0]) ** 2 + (sy - place[1]) ** 2 + (sz - place[2]) ** 2)
        angle = EARTH_RATE * travelled / SPEED_OF_LIGHT
        sine, cosine = math.sin(angle), math.cos(angle)
        sx, sy = cosine * sx + sine * sy, cosine * sy - sine * sx
        vx, vy = cosine * vx + sine * vy, cosine * vy - sine * vx
    dx, dy, dz = sx - place[0], sy - place[1], sz - place[2]
    rho = math.sqrt(dx * dx + dy * dy + dz * dz)
    for i in range(row.size):
        row[i] = 0.0
    for i in range(3):
        row[i] = -(axes[i, 0] * dx + axes[i, 1] * dy + axes[i, 2] * dz) / rho
    row[6] = 1.0
    if system > 0:
        row[FIXED_STATES + system - 1] = 1.0
    return rho, (dx * vx + dy * vy + dz * vz) / rho
