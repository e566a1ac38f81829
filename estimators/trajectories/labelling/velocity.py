"""A reported velocity, taken by a hypothesis that it agrees with.

Receivers measure speed and course by Doppler shifts, so that they mostly stay true where positions jump. A
velocity moves the state and has no say in how likely a hypothesis is: a receiver whose speed has frozen would
talk for minutes, and outweigh the fixes.
"""

from __future__ import annotations

from estimators.arrays import FloatArray
from estimators.kernels import device

_GATE = 9.21
"""99 % of chi-square with two degrees of freedom."""


@device
def take_velocity(x: FloatArray, P: FloatArray, east: float, north: float, variance: float) -> None:
    """Take in a velocity, unless it is too far from that of the state.

    Only the upper triangle of P is read and written.
    """
    total = P[1, 1] + variance
    off_east, off_north = east - x[0, 1], north - x[1, 1]
    if off_east * off_east + off_north * off_north > _GATE * total:
        return
    g0, g1, g2 = P[0, 1], P[1, 1], P[1, 2]
    for axis in range(2):
        off = (off_east if axis == 0 else off_north) / total
        x[axis, 0] += g0 * off
        x[axis, 1] += g1 * off
        x[axis, 2] += g2 * off
    P[0, 0] = max(P[0, 0] - g0 * g0 / total, 0.0)
    P[0, 1] -= g0 * g1 / total
    P[0, 2] -= g0 * g2 / total
    P[1, 1] = max(P[1, 1] - g1 * g1 / total, 0.0)
    P[1, 2] -= g1 * g2 / total
    P[2, 2] = max(P[2, 2] - g2 * g2 / total, 0.0)
