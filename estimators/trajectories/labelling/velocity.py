"""A reported velocity, taken by a hypothesis that it agrees with.

Receivers measure speed and course by Doppler shifts, so that they mostly stay true where positions jump. A
velocity moves the state and has no say in how likely a hypothesis is: a receiver whose speed has frozen would
talk for minutes, and outweigh the fixes.
"""

from __future__ import annotations

from estimators.arrays import FloatArray
from estimators.kernels import arithmetic
from estimators.trajectories.labelling.state import (
    BB,
    EAST,
    EAST_BIAS,
    EAST_MPS,
    NORTH_MPS,
    PB,
    PP,
    PV,
    VB,
    VV,
)

_GATE = 9.21
"""99 % of chi-square with two degrees of freedom."""


@arithmetic
def take_velocity(s: FloatArray, h: int, east: float, north: float, variance: float) -> None:
    """Take in a velocity, unless it is too far from that of the state."""
    total = s[h, VV] + variance
    off_east, off_north = east - s[h, EAST_MPS], north - s[h, NORTH_MPS]
    if off_east * off_east + off_north * off_north > _GATE * total:
        return
    g0, g1, g2 = s[h, PV], s[h, VV], s[h, VB]
    for axis in range(2):
        off = (off_east if axis == 0 else off_north) / total
        s[h, EAST + axis] += g0 * off
        s[h, EAST_MPS + axis] += g1 * off
        s[h, EAST_BIAS + axis] += g2 * off
    s[h, PP] = max(s[h, PP] - g0 * g0 / total, 0.0)
    s[h, PV] -= g0 * g1 / total
    s[h, PB] -= g0 * g2 / total
    s[h, VV] = max(s[h, VV] - g1 * g1 / total, 0.0)
    s[h, VB] -= g1 * g2 / total
    s[h, BB] = max(s[h, BB] - g2 * g2 / total, 0.0)
