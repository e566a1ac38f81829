"""Order of the slopes of all pairs of points, in O(n log n) time and O(n) memory.

Point i maps to the intercept z_i(a) = y_i - a t_i of the line of slope a through it. For t_i < t_j the pair's
slope is less than a if and only if z_j < z_i: slopes below a are *inversions*, which a merge sort counts;
slopes between two values are the inversions between two orders, which it can also walk through
(Cole, Salowe, Steiger & Szemeredi 1989; Matousek 1991; Dillencourt, Mount & Netanyahu 1992).

Intercepts are carried in twice the working precision (Dekker 1971). Their order is then that of the true
slopes of the given numbers, also where all slopes agree to the last digit.
"""

from __future__ import annotations

import numba
import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import device, kernel, ro
from estimators.regression.counter import sequence_key, unit_uniform

_F8 = numba.float64
_I8 = numba.int64
_STREAM = 0x5105
_SPLITTER = 134217729.0  # 2^27 + 1


@device
def intercepts(t: FloatArray, y: FloatArray, slope: float, high: FloatArray, low: FloatArray) -> None:
    """Write y - slope t as unevaluated sums ``high + low``; infinite slopes order by time."""
    n = t.size
    if not np.isfinite(slope):
        for i in range(n):
            high[i] = -t[i] if slope > 0.0 else t[i]
            low[i] = 0.0
        return
    big = slope * _SPLITTER
    slope_head = big - (big - slope)
    slope_tail = slope - slope_head
    for i in range(n):
        x = t[i]
        big = x * _SPLITTER
        head = big - (big - x)
        tail = x - head
        product = slope * x
        error = ((slope_head * head - product) + slope_head * tail + slope_tail * head) + slope_tail * tail
        total = y[i] - product
        back = total - y[i]
        rest = (y[i] - (total - back)) - (product + back)
        rest -= error
        high[i] = total + rest
        low[i] = rest - (high[i] - total)


@device
def merge_level(
    high: FloatArray,
    low: FloatArray,
    index: IntArray,
    high_to: FloatArray,
    low_to: FloatArray,
    index_to: IntArray,
    width: int,
    t: FloatArray,
    y: FloatArray,
    before: int,
    total: int,
    key: np.uint64,
    found: int,
    out: FloatArray,
) -> tuple[int, int]:
    """Merge neighbouring runs of ``width``; return the inversions and the picked slopes so far.

    Of ``total`` inversions, numbered as they come, ``out.size`` are picked: one at random from each of so
    many equal shares. ``before`` were counted and ``found`` picked by earlier levels.
    """
    n = high.size
    wanted = out.size
    inversions = before
    due = _due(found, wanted, total, key)
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
                i += 1
                continue
            # Every element still on the left is greater than this one from the right.
            crossed = middle - i
            while found < wanted and due < inversions + crossed:
                one = index[i + due - inversions]
                other = index[j]
                first = min(one, other)
                last = max(one, other)
                out[found] = (y[last] - y[first]) / (t[last] - t[first])
                found += 1
                due = _due(found, wanted, total, key)
            inversions += crossed
            high_to[o] = high[j]
            low_to[o] = low[j]
            index_to[o] = index[j]
            j += 1
    return inversions, found


@device
def _due(found: int, wanted: int, total: int, key: np.uint64) -> int:
    """Tell which inversion to pick next."""
    if wanted == total:
        return found
    if wanted == 0:
        return total
    return min(int((found + unit_uniform(key, found)) * (total / wanted)), total - 1)


@device
def merge_sort(
    high: FloatArray,
    low: FloatArray,
    index: IntArray,
    t: FloatArray,
    y: FloatArray,
    total: int,
    key: np.uint64,
    out: FloatArray,
) -> tuple[int, int]:
    """Sort by (high, low), stably; return the number of inversions and of picked slopes."""
    n = high.size
    high_to = np.empty(n)
    low_to = np.empty(n)
    index_to = np.empty(n, dtype=np.int64)
    inversions = 0
    found = 0
    width = 1
    in_place = True
    while width < n:
        if in_place:
            inversions, found = merge_level(
                high, low, index, high_to, low_to, index_to, width, t, y, inversions, total, key, found, out
            )
        else:
            inversions, found = merge_level(
                high_to, low_to, index_to, high, low, index, width, t, y, inversions, total, key, found, out
            )
        in_place = not in_place
        width *= 2
    if not in_place:
        high[:] = high_to
        low[:] = low_to
        index[:] = index_to
    return inversions, found


@kernel(numba.void(ro(_F8), ro(_F8), _F8, _I8[::1]))
def count_inversions(t: FloatArray, y: FloatArray, slope: float, counts: IntArray) -> None:
    """Count the pairs i < j with z_j < z_i, and those with z_j = z_i, at a finite ``slope``.

    Written to ``counts``, in this order. ``t`` ascends, and ``y`` within equal times; pairs of one time are
    then never counted, but for repeated points among the equal ones.
    """
    n = t.size
    high = np.empty(n)
    low = np.empty(n)
    intercepts(t, y, slope, high, low)
    below, _ = merge_sort(high, low, np.arange(n), t, y, 0, np.uint64(0), np.empty(0))
    equal = 0
    run = 0
    for i in range(1, n):
        run = run + 1 if high[i] == high[i - 1] and low[i] == low[i - 1] else 0
        equal += run
    counts[0] = below
    counts[1] = equal


@kernel(_I8(ro(_F8), ro(_F8), _F8, _F8, _I8, _I8, _F8[::1]))
def pick_slopes(
    t: FloatArray, y: FloatArray, above: float, below: float, total: int, round_: int, out: FloatArray
) -> int:
    """Write slopes strictly between two values (infinite ones included); return how many were found.

    With ``out`` of size ``total``, their number, all of them; else a stratified random choice that is
    another one in each round.
    """
    n = t.size
    high = np.empty(n)
    low = np.empty(n)
    # Ties of z at the lower value must not become inversions: among them later times come first.
    order = np.arange(n)
    if np.isfinite(above):
        order = order[::-1].copy()
        intercepts(t[::-1].copy(), y[::-1].copy(), above, high, low)
        merge_sort(high, low, order, t, y, 0, np.uint64(0), np.empty(0))
    intercepts(t[order], y[order], below, high, low)
    _, found = merge_sort(high, low, order, t, y, total, sequence_key(_STREAM, round_), out)
    return found
