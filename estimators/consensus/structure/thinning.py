"""Fewer points for the choice of a structure: strided rows, single precision, rounding undone."""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import device

_GOLDEN = 0.6180339887498949
_TIED_SHARE = 0.1


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
def to_unit_range(
    t: FloatArray,
    y: FloatArray,
    index: IntArray,
    middle: float,
    unit: float,
    out_t: FloatArray,
    out_y: FloatArray,
) -> None:
    """Copy the rows of ``index``, values in units of the range about its middle.

    In single precision on purpose: the structure must not hinge on the last digits of the data, which a
    change of units alters. Rounded values are spread evenly over their quantum (METHODS_TRENDS: "Frame"),
    or ties would look like a line without noise.
    """
    for k in range(index.size):
        i = index[k]
        out_t[k] = np.float32(t[i])
        out_y[k] = np.float32((y[i] - middle) / unit)
    tied, quantum = _quantum(out_y)
    if tied > _TIED_SHARE and quantum < 0.5:
        u = 0.5
        for k in range(index.size):
            u += _GOLDEN
            u -= math.floor(u)
            out_y[k] += quantum * (u - 0.5)


@device
def _quantum(values: FloatArray) -> tuple[float, float]:
    """Share of tied neighbours among the sorted values, and the smallest gap between different ones."""
    ordered = np.sort(values)
    ties = 0
    gap = np.inf
    for i in range(1, ordered.size):
        d = ordered[i] - ordered[i - 1]
        if d == 0.0:
            ties += 1
        elif d < gap:
            gap = d
    return ties / max(1, ordered.size - 1), gap
