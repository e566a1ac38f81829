"""Which hypotheses are so alike that one of them will do, and which crowd one place.

Two hypotheses of the same mode whose states agree have the same future.
"""

from __future__ import annotations

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import arithmetic
from estimators.trajectories.labelling.modes import ASTRAY
from estimators.trajectories.labelling.state import (
    BB,
    EAST,
    EAST_BIAS,
    EAST_MPS,
    NORTH,
    PATH_EAST,
    PATH_EAST_MPS,
    PATH_PP,
    PATH_VV,
    PP,
    VV,
)

_TWIN = 0.2
"""States closer than this, in variances, have the same future."""
_TWIN_SPREAD = 0.5
_NEAR = 2.0
"""In variances of their difference, states closer than this are of the same place."""
_LEAST_VARIANCE = 1e-6


@arithmetic
def find_twin(s: FloatArray, mode: IntArray, h: int, own_mode: int) -> int:
    """Find a state before this one of which this one is a copy; -1 if there is none."""
    for other in range(h):
        if (
            mode[other] == own_mode
            and _are_alike(s, h, other, EAST, PP)
            and _are_alike(s, h, other, EAST_MPS, VV)
            and _are_alike(s, h, other, EAST_BIAS, BB)
            and (own_mode != ASTRAY or _are_alike(s, h, other, PATH_EAST, PATH_PP))
            and (own_mode != ASTRAY or _are_alike(s, h, other, PATH_EAST_MPS, PATH_VV))
        ):
            return int(other)
    return -1


@arithmetic
def _are_alike(s: FloatArray, h: int, other: int, at: int, spread: int) -> bool:
    """Whether two states agree in the column ``at`` and the next, whose variance is in another."""
    own, its = s[h, spread], s[other, spread]
    east, north = s[h, at] - s[other, at], s[h, at + 1] - s[other, at + 1]
    near = east * east + north * north < _TWIN * min(own, its) + _LEAST_VARIANCE
    return bool(near and abs(own - its) < _TWIN_SPREAD * its)


@arithmetic
def count_near(s: FloatArray, h: int) -> int:
    """How many of the states before this one are of the same place, as far as they know."""
    east, north, spread = s[h, EAST], s[h, NORTH], s[h, PP]
    near = 0
    for other in range(h):
        off_east, off_north = east - s[other, EAST], north - s[other, NORTH]
        near += off_east * off_east + off_north * off_north < _NEAR * (spread + s[other, PP])
    return near
