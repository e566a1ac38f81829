"""Order statistics in linear time, for compiled code.

Quickselect with Hoare's partition, which halves the work also where all values are equal, and with pivots
taken at scattered places, so that no arrangement of the values makes it quadratic. The answer is an
element of the input and so does not depend on the pivots. Outside of compiled code ``numpy.partition``
gives the same elements.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray
from estimators.kernels import device

# Knuth's MMIX generator; only its high bits are used, to place pivots.
_MULTIPLIER = np.uint64(6364136223846793005)
_INCREMENT = np.uint64(1442695040888963407)
_SHIFT = np.uint64(33)


@device
def kth_smallest(work: FloatArray, size: int, k: int) -> float:
    """Element of rank ``k`` (from 0) among the first ``size`` of ``work``, which is reordered."""
    low = 0
    high = size - 1
    state = np.uint64(size)
    while low < high:
        state = state * _MULTIPLIER + _INCREMENT
        pivot = work[low + np.int64(state >> _SHIFT) % (high - low + 1)]
        i = low
        j = high
        while i <= j:
            while work[i] < pivot:
                i += 1
            while pivot < work[j]:
                j -= 1
            if i <= j:
                held = work[i]
                work[i] = work[j]
                work[j] = held
                i += 1
                j -= 1
        if k <= j:
            high = j
        elif k >= i:
            low = i
        else:
            return float(pivot)
    return float(work[k])


@device
def median_of(work: FloatArray, size: int) -> float:
    """Median of the first ``size`` of ``work``, which is reordered; even sizes average the middle two."""
    half = size // 2
    upper = kth_smallest(work, size, half)
    if size % 2 == 1:
        return upper
    lower = float(work[0])
    for i in range(1, half):
        lower = max(lower, float(work[i]))
    return 0.5 * (lower + upper)
