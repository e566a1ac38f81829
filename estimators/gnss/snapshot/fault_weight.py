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
SEEN = 30.0
"""Satellites that the prior probability of a fault is worth. With very many, that is with independent faults,
as many epochs are answered, and twice as many of those with four faults of 50 m wrongly."""
SINGULAR = 1e-9
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
        if not volume * pivot > SINGULAR:
            return False
        reciprocal = 1.0 / math.sqrt(pivot)
        factor[b, depth, depth] = reciprocal
        solved[b, depth] = held * reciprocal
        explained[b, depth] = before + solved[b, depth] * solved[b, depth]
        determinant[b, depth] = volume * pivot
    return True


@device
def next_odds(n: int, size: int, fault_prior: float) -> float:
    """Prior probability of a set of ``size + 1`` satellites relative to one of ``size``.

    The probability of a fault is unknown and common to the satellites of an epoch: where one range lies,
    others do more often. It has a beta density of mean ``fault_prior`` and of the weight of ``SEEN``
    satellites, which makes the sizes of fault sets beta-binomial.
    """
    return (SEEN * fault_prior + size) / (SEEN * (1.0 - fault_prior) + n - size - 1.0)


@device
def fill_priors(n: int, fault_prior: float, priors: FloatArray) -> None:
    """Write ln of the prior probability of one set of each size from 0, relative to the empty set."""
    priors[0] = 0.0
    for size in range(priors.size - 1):
        priors[size + 1] = priors[size] + math.log(next_odds(n, size, fault_prior))


@device
def log_weight(
    prior: float, halves: int, squares: float, scale: float, explained: FloatArray, width: FloatArray
) -> float:
    """Unnormalised ln w_F.

    The mean over B is taken relative to the term of the largest B, whose sum of squares is the least, with
    powers by multiplication: much of the time of an epoch goes by here.

    Parameters
    ----------
    prior : float
        ln of the prior probability.
    halves : int
        2 a + m, twice the power of the density.
    squares, scale : float
        z'z and b.
    explained : ndarray, shape (biases + 1,)
        z_F' (S_FF + D_B)^-1 z_F, an infinite B first.
    width : ndarray, shape (biases,)
        |S_FF + D_B| times the product of (B / sigma_i)^2 over F.
    """
    count = width.size
    least = scale + 0.5 * max(0.0, squares - explained[count])
    odd = halves % 2 == 1
    total = 0.0
    for b in range(count):
        ratio = least / (scale + 0.5 * max(0.0, squares - explained[b + 1]))
        total += whole_power(ratio, halves // 2) * math.sqrt((ratio if odd else 1.0) / width[b])
    return prior - 0.5 * halves * math.log(least / scale) + math.log(total / count)


@device
def fill_width(
    sigma: FloatArray, members: IntArray, size: int, determinant: FloatArray, width: FloatArray
) -> None:
    """Multiply the determinants of a set, an infinite bias first, by the products of (B / sigma_i)^2."""
    for b in range(width.size):
        width[b] = determinant[b + 1]
        for row in range(size):
            width[b] *= (BIASES_M[b] / sigma[members[row]]) ** 2


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
