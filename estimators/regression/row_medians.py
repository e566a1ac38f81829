"""Per point, the slopes to all other points: their median, and how many lie below a value.

The compiled parts of the repeated median. Counting per point is the merge sort of
:mod:`estimators.regression.slope_order` that credits each inversion to both of its points.
"""

from __future__ import annotations

import numba
import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import device, kernel, ro
from estimators.noise.selection import median_of
from estimators.regression.slope_order import intercepts

_F8 = numba.float64
_I8 = numba.int64


@kernel(numba.void(ro(_F8), ro(_F8), ro(_I8), _F8[::1]))
def median_slopes(t: FloatArray, y: FloatArray, rows: IntArray, out: FloatArray) -> None:
    """Write, for each of ``rows``, the median slope to the points at other times (there is at least one)."""
    n = t.size
    slopes = np.empty(n)
    for k in range(rows.size):
        i = rows[k]
        count = 0
        for j in range(n):
            if t[j] != t[i]:
                slopes[count] = (y[j] - y[i]) / (t[j] - t[i])
                count += 1
        out[k] = median_of(slopes, count)


@device
def _merge_counts(
    high: FloatArray,
    low: FloatArray,
    index: IntArray,
    high_to: FloatArray,
    low_to: FloatArray,
    index_to: IntArray,
    width: int,
    below: IntArray,
) -> None:
    """Merge neighbouring runs of ``width``, adding to ``below`` of both points of each inversion."""
    n = high.size
    for left in range(0, n, 2 * width):
        middle = min(left + width, n)
        right = min(left + 2 * width, n)
        i = left
        j = middle
        for o in range(left, right):
            if j >= right or (
                i < middle and (high[i] < high[j] or (high[i] == high[j] and low[i] <= low[j]))
            ):
                high_to[o] = high[i]
                low_to[o] = low[i]
                index_to[o] = index[i]
                below[index[i]] += j - middle
                i += 1
            else:
                high_to[o] = high[j]
                low_to[o] = low[j]
                index_to[o] = index[j]
                below[index[j]] += middle - i
                j += 1


@kernel(numba.void(ro(_F8), ro(_F8), _F8, _I8[::1], _I8[::1]))
def count_slopes_per_row(
    t: FloatArray, y: FloatArray, slope: float, below: IntArray, equal: IntArray
) -> None:
    """Write, per point, how many of its slopes are below ``slope`` and how many points share its intercept.

    ``t`` ascends, and ``y`` within equal times. The points that share an intercept include the point
    itself and those that repeat it.
    """
    n = t.size
    high = np.empty(n)
    low = np.empty(n)
    index = np.arange(n)
    high_to = np.empty(n)
    low_to = np.empty(n)
    index_to = np.empty(n, dtype=np.int64)
    below[:] = 0
    intercepts(t, y, slope, high, low)
    width = 1
    while width < n:
        _merge_counts(high, low, index, high_to, low_to, index_to, width, below)
        high, high_to = high_to, high
        low, low_to = low_to, low
        index, index_to = index_to, index
        width *= 2
    start = 0
    for i in range(1, n + 1):
        if i == n or high[i] != high[start] or low[i] != low[start]:
            for k in range(start, i):
                equal[index[k]] = i - start
            start = i
