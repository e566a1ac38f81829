"""The weight of one set of faulty satellites: its marginal likelihood times its prior.

The factors of S_FF + D_B are built row by row, one satellite after the other, for every prior size B of a
fault at once; the equation stands in :mod:`estimators.gnss.snapshot.fault_sets`.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import device

LARGEST_SET = 10
BIASES_M = np.array([30.0, 100.0, 300.0, 1000.0, 3000.0])
"""Standard deviations of a fault in metres, one for all faults of an epoch, equally likely."""
_SINGULAR = 1e-9
"""Least |S_FF|, the factor by which exclusion shrinks |A'A|; unlike a pivot it knows no order."""


@device
def extend(
    S: FloatArray,
    z: FloatArray,
    ridge: FloatArray,
    members: IntArray,
    depth: int,
    i: int,
    factor: FloatArray,
    solved: FloatArray,
    explained: FloatArray,
    determinant: FloatArray,
) -> bool:
    """Append satellite i to the factors of a set of ``depth`` satellites, for every prior size of a bias.

    Row 0 is the limit of an infinite bias, which is the exclusion of the satellites. The diagonal of the
    factors holds reciprocals: the search multiplies by them far more often than it divides here.

    Returns
    -------
    bool
        False where the satellites cannot be excluded together: the others do not determine the position.
    """
    for b in range(ridge.shape[0]):
        pivot = S[i, i] + ridge[b, i]
        held = z[i]
        for row in range(depth):
            value = S[i, members[row]]
            for k in range(row):
                value -= factor[b, depth, k] * factor[b, row, k]
            value *= factor[b, row, row]
            factor[b, depth, row] = value
            pivot -= value * value
            held -= value * solved[b, row]
        before, volume = (explained[b, depth - 1], determinant[b, depth - 1]) if depth > 0 else (0.0, 1.0)
        if not volume * pivot > _SINGULAR:
            return False
        reciprocal = 1.0 / math.sqrt(pivot)
        factor[b, depth, depth] = reciprocal
        solved[b, depth] = held * reciprocal
        explained[b, depth] = before + solved[b, depth] * solved[b, depth]
        determinant[b, depth] = volume * pivot
    return True


@device
def fill_volume(sigma: FloatArray, members: IntArray, size: int, volume: FloatArray) -> None:
    """Products of B / sigma_i over a set."""
    for b in range(volume.size):
        volume[b] = 1.0
        for row in range(size):
            volume[b] *= BIASES_M[b] / sigma[members[row]]


@device
def log_weight(
    n: int,
    size: int,
    freedom: int,
    squares: float,
    volume: FloatArray,
    explained: FloatArray,
    determinant: FloatArray,
    fault_prior: float,
    shape: float,
    scale: float,
) -> float:
    """Unnormalised ln w_F; ``volume[b]`` is the product of B / sigma_i over F.

    The mean over B is taken relative to the term of the largest B, whose sum of squares is the least, with
    powers by multiplication: most of the time of an epoch goes by here.
    """
    prior = size * math.log(fault_prior) + (n - size) * math.log(1.0 - fault_prior)
    power = shape + 0.5 * freedom
    if size == 0:
        return prior - power * math.log1p(0.5 * squares / scale)
    count = volume.size
    least = scale + 0.5 * max(0.0, squares - explained[count, size - 1])
    halves = int(2.0 * power + 0.5)
    total = 0.0
    for b in range(count):
        left = scale + 0.5 * max(0.0, squares - explained[b + 1, size - 1])
        ratio = math.sqrt(least / left)
        total += whole_power(ratio, halves) / (volume[b] * math.sqrt(determinant[b + 1, size - 1]))
    return prior - power * math.log(least / scale) + math.log(total / count)


@device
def whole_power(x: float, n: int) -> float:
    """Raise to a power n >= 0 by squaring."""
    held = 1.0
    while n > 0:
        if n & 1:
            held *= x
        x *= x
        n >>= 1
    return held
