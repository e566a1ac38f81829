"""Which series are in order already, and their times since the first: compiled, for a slice of series.

An orderly series is what :func:`estimators.series.as_series` takes without copying: finite, strictly
ascending, nothing missing, nothing huge. All others are left to ``as_series`` itself.
"""

from __future__ import annotations

import numpy as np
from numba import types

from estimators.arrays import LARGEST_TIME, LARGEST_VALUE, SMALLEST_TIME, BoolArray, FloatArray, IntArray
from estimators.kernels import device, kernel, ro

_MISSING = np.iinfo(np.int64).min
"""NaT as an integer."""

_REAL, _INT, _FLAG = types.float64, types.int64, types.boolean


@device
def _is_orderly(internal: FloatArray, y: FloatArray) -> bool:
    last = -np.inf
    for i in range(internal.size):
        if not (internal[i] > last and internal[i] < np.inf and abs(y[i]) <= LARGEST_VALUE):
            return False
        last = internal[i]
    return True


@kernel(types.void(ro(_INT), ro(_INT), ro(_REAL), ro(_REAL), _REAL[::1], _FLAG[::1]))
def place_numbers(
    offsets: IntArray,
    starts: IntArray,
    t: FloatArray,
    y: FloatArray,
    internal: FloatArray,
    orderly: BoolArray,
) -> None:
    """Subtract the first of plain times; ``starts`` says where in ``t`` each series begins."""
    for k in range(starts.size):
        a, b = offsets[k], offsets[k + 1]
        if a == b:
            orderly[k] = True
            continue
        s = starts[k]
        first = t[s]
        for i in range(a, b):
            internal[i] = t[s + i - a] - first
        largest = max(t[s + b - a - 1], -first)
        in_reach = largest <= LARGEST_TIME and (largest <= 0.0 or largest >= SMALLEST_TIME)
        orderly[k] = in_reach and _is_orderly(internal[a:b], y[a:b])


@kernel(types.void(ro(_INT), ro(_INT), ro(_INT), ro(_REAL), _REAL, _FLAG, _REAL[::1], _FLAG[::1]))
def place_integers(
    offsets: IntArray,
    starts: IntArray,
    t: IntArray,
    y: FloatArray,
    per_unit: float,
    dated: bool,
    internal: FloatArray,
    orderly: BoolArray,
) -> None:
    """Subtract the first of integer times before they become floats, then divide by ``per_unit``.

    A difference that 64 bits cannot hold turns up negative, which is not in order.
    """
    for k in range(starts.size):
        a, b = offsets[k], offsets[k + 1]
        if a == b:
            orderly[k] = True
            continue
        s = starts[k]
        first = t[s]
        for i in range(a, b):
            # Unsigned arithmetic is modulo 2**64, also where the difference has no room.
            internal[i] = float(np.int64(np.uint64(t[s + i - a]) - np.uint64(first))) / per_unit
        missing = dated and first == _MISSING
        orderly[k] = not missing and _is_orderly(internal[a:b], y[a:b])
