"""The frame in which structures are weighed: few points, about their median line, in units of their range."""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.structure.hypotheses import PAIRS, propose_lines
from estimators.consensus.structure.ranking import sort_values
from estimators.kernels import device

_GOLDEN = 0.6180339887498949
_TIED_SHARE = 0.1
REACH = 50.0
"""Values further from the median line than this many central ranges are drawn in, for the structure only."""


@device
def thin(n: int, most: int, index: IntArray) -> int:
    """Fill ``index`` with at most ``most`` rows spread evenly over n; returns how many."""
    if n <= most:
        for k in range(n):
            index[k] = k
        return n
    for k in range(most):
        index[k] = int((k + 0.5) * n / most)
    return most


@device
def fit_frame(t: FloatArray, y: FloatArray, floor: float, frame: FloatArray) -> None:
    """Fill ``frame`` with level, slope, unit and reach: the median line, and the spread of values about it.

    The slope is the median over the pairs that lines are proposed from, which depend on the times alone; so
    adding a line to the values, or changing their unit, changes the frame and nothing else. The unit is the
    range about the median line, but no more than REACH times what lies between its 5 % and 95 % quantiles:
    one fill value of 1e36 would otherwise leave no digits for the rest.
    """
    n = t.size
    level = np.empty(PAIRS)
    slope = np.empty(PAIRS)
    count = propose_lines(t, y, PAIRS, level, slope)
    middle_slope = np.median(slope[:count]) if count > 0 else 0.0
    about = np.empty(n)
    for k in range(n):
        about[k] = y[k] - middle_slope * t[k]
    sort_values(about)
    middle = 0.5 * (about[(n - 1) // 2] + about[n // 2])
    central = about[n - 1 - n // 20] - about[n // 20]
    reach = max(about[n - 1] - middle, middle - about[0])
    if central > 0.0:
        reach = min(reach, REACH * central)
    frame[0] = middle
    frame[1] = middle_slope
    frame[2] = max(2.0 * reach, 4.0 * floor)
    frame[3] = reach


@device
def to_frame(t: FloatArray, y: FloatArray, frame: FloatArray, out_t: FloatArray, out_y: FloatArray) -> None:
    """Values about the median line in units of their range, drawn in to the reach of the frame.

    In single precision on purpose: the structure must not hinge on the last digits of the data, which a
    change of units alters. Rounded values are spread evenly over their quantum (METHODS_TRENDS: "Frame"),
    or ties would look like a line without noise.
    """
    n = t.size
    tied, quantum = _quantum(y)
    spreading = tied > _TIED_SHARE and quantum < 0.5 * frame[2]
    u = 0.5
    for k in range(n):
        off = y[k] - frame[0] - frame[1] * t[k]
        if spreading:
            u += _GOLDEN
            u -= math.floor(u)
            off += quantum * (u - 0.5)
        off = min(max(off, -frame[3]), frame[3])
        out_t[k] = np.float32(t[k])
        out_y[k] = np.float32(off / frame[2])


@device
def _quantum(values: FloatArray) -> tuple[float, float]:
    """Share of tied neighbours among the sorted values, and the smallest gap between different ones."""
    ordered = values.copy()
    sort_values(ordered)
    n = ordered.size
    ties = 0
    gap = np.inf
    run = 0
    longest = 0
    for i in range(1, n):
        d = ordered[i] - ordered[i - 1]
        if d == 0.0:
            ties += 1
            run += 1
            longest = max(longest, run)
        else:
            run = 0
            gap = min(gap, d)
    # Where one value is the majority it is no rounding: the series rests there.
    if 2 * longest > n:
        return 0.0, gap
    return ties / max(1, n - 1), gap
