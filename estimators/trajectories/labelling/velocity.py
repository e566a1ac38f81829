"""A reported velocity, taken by a hypothesis that it agrees with.

Receivers measure speed and course by Doppler shifts, so that they mostly stay true where positions jump. A
velocity moves the state and has no say in how likely a hypothesis is: a receiver whose speed has frozen would
talk for minutes, and outweigh the fixes.
"""

from __future__ import annotations

from estimators.arrays import FloatArray
from estimators.kernels import arithmetic
from estimators.trajectories.labelling.state import EAST_MPS, NORTH_MPS, PV, VB, VV, correct

_GATE = 9.21
"""99 % of chi-square with two degrees of freedom."""


@arithmetic
def take_velocity(s: FloatArray, h: int, east: float, north: float, variance: float) -> None:
    """Take in a velocity, unless it is too far from that of the state."""
    total = s[h, VV] + variance
    off_east, off_north = east - s[h, EAST_MPS], north - s[h, NORTH_MPS]
    if off_east * off_east + off_north * off_north > _GATE * total:
        return
    correct(s, h, s[h, PV], s[h, VV], s[h, VB], total, off_east, off_north)
