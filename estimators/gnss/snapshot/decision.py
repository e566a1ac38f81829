r"""From weighted fault sets to an answer: which satellites to leave out, how sure, and how far off at most.

The position under a set F is x_F = x_0 - N A_F' S_FF^-1 z_F. The probability that the truth lies farther than
r from a position x is bounded by

    tail(r) = sum_G w_G (1 + u^2 / (nu s_G^2))^(-nu/2),  u = max(0, r - |x_G - x|),

the radial tail of a two-dimensional Student density of nu degrees of freedom whose scale s_G is the larger
semi-axis. The answer is the set that minimises the tail at the alert limit; its protection level solves
tail(r) = risk (METHODS_GNSS, "A decision that is honest and still answers").
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.snapshot.fault_weight import LARGEST_SET
from estimators.kernels import device

HEAVY = 64
"""Sets whose positions are computed; the others' weight is counted with the lightest of these."""
CANDIDATES = 12
"""Sets among which the answer is chosen."""
_NEGLIGIBLE = 1e-9
_PRECISION = 1e-6
"""Of a protection level, relative."""


@device
def exclude(
    S: FloatArray, z: FloatArray, gain: FloatArray, members: IntArray, size: int, shift: FloatArray,
    spread: FloatArray,
) -> float:  # fmt: skip
    """Move the position and widen its covariance as leaving out a set does.

    Parameters
    ----------
    S, z, gain : ndarray
    members : ndarray of int64
    size : int
    shift : ndarray, shape (3,)
        Out, metres, Cartesian.
    spread : ndarray, shape (3, 3)
        Out; what is added to the covariance, at unit scale.

    Returns
    -------
    float
        Sum of squares that the set explains.
    """
    factor = np.empty((size, size))
    solved = np.empty(size)
    whitened = np.empty((3, size))
    explained = 0.0
    for row in range(size):
        i = members[row]
        pivot = S[i, i]
        held = z[i]
        for k in range(row):
            value = S[i, members[k]]
            for j in range(k):
                value -= factor[row, j] * factor[k, j]
            value /= factor[k, k]
            factor[row, k] = value
            pivot -= value * value
            held -= value * solved[k]
        root = math.sqrt(max(pivot, 1e-300))
        factor[row, row] = root
        solved[row] = held / root
        explained += solved[row] * solved[row]
        for axis in range(3):
            value = gain[axis, i]
            for k in range(row):
                value -= factor[row, k] * whitened[axis, k]
            whitened[axis, row] = value / root
    for axis in range(3):
        shift[axis] = 0.0
        for row in range(size):
            shift[axis] -= whitened[axis, row] * solved[row]
        for other in range(3):
            spread[axis, other] = 0.0
            for row in range(size):
                spread[axis, other] += whitened[axis, row] * whitened[other, row]
    return explained


@device
def to_local(
    axes: FloatArray, shift: FloatArray, covariance: FloatArray, moved: FloatArray
) -> tuple[float, float]:
    """East, north and up of a shift; variances of the larger horizontal semi-axis and of the height."""
    local = np.empty((3, 3))
    for row in range(3):
        moved[row] = 0.0
        for k in range(3):
            moved[row] += axes[row, k] * shift[k]
        for column in range(3):
            held = 0.0
            for k in range(3):
                for j in range(3):
                    held += axes[row, k] * covariance[k, j] * axes[column, j]
            local[row, column] = held
    middle = 0.5 * (local[0, 0] + local[1, 1])
    half = 0.5 * (local[0, 0] - local[1, 1])
    return middle + math.sqrt(half * half + local[0, 1] * local[0, 1]), local[2, 2]


@device
def radial_tail(beyond: float, variance: float, nu: float) -> float:
    """Probability to lie farther than ``beyond`` from the centre, for a Student density in the plane."""
    if beyond <= 0.0:
        return 1.0
    return math.exp(-0.5 * nu * math.log1p(beyond * beyond / (nu * variance)))


@device
def tail(radius: float, distance: FloatArray, variance: FloatArray, nu: float, weights: FloatArray) -> float:
    """Probability bound that the truth lies farther than ``radius`` from a position."""
    total = 0.0
    for g in range(weights.size):
        total += weights[g] * radial_tail(radius - distance[g], variance[g], nu)
    return total


@device
def solve_tail(
    risk: float, distance: FloatArray, variance: FloatArray, nu: float, weights: FloatArray
) -> float:
    """Radius whose tail is the risk, by bisection between powers of two."""
    low, high = 0.0, 1.0
    for _ in range(60):
        if tail(high, distance, variance, nu, weights) <= risk:
            break
        low = high
        high *= 2.0
    while high - low > _PRECISION * high:
        middle = 0.5 * (low + high)
        if tail(middle, distance, variance, nu, weights) > risk:
            low = middle
        else:
            high = middle
    return high


@device
def heaviest(weights: FloatArray, found: int, places: IntArray, shares: FloatArray) -> int:
    """Places and probabilities of the heaviest sets, in decreasing order; returns how many."""
    largest = -math.inf
    for k in range(found):
        largest = max(largest, weights[k])
    total = 0.0
    for k in range(found):
        total += math.exp(weights[k] - largest)
    order = np.argsort(-weights[:found], kind="mergesort")
    count = 0
    while count < min(HEAVY, found):
        share = math.exp(weights[order[count]] - largest) / total
        if share < _NEGLIGIBLE and count > 0:
            break
        places[count] = order[count]
        shares[count] = share
        count += 1
    return count


@device
def fault_probabilities(
    members: IntArray, sizes: IntArray, weights: FloatArray, found: int, out: FloatArray
) -> None:
    """Probability of each satellite to be faulty: the weight of the sets that hold it."""
    largest = -math.inf
    for k in range(found):
        largest = max(largest, weights[k])
    total = 0.0
    for i in range(out.size):
        out[i] = 0.0
    for k in range(found):
        share = math.exp(weights[k] - largest)
        total += share
        for row in range(sizes[k]):
            out[members[k, row]] += share
    for i in range(out.size):
        out[i] = min(1.0, out[i] / total)


@device
def smallest_subset(
    S: FloatArray,
    z: FloatArray,
    gain: FloatArray,
    axes: FloatArray,
    members: IntArray,
    size: int,
    allowed_shift: float,
    allowed_squares: FloatArray,
    kept: IntArray,
) -> int:
    """Fewest satellites of a set whose exclusion does as well; returns how many, and writes them.

    A subset does as well if it explains nearly as much (``allowed_squares[d]`` may be left to d satellites
    that stay) and moves the position, horizontally, to within ``allowed_shift`` of where the whole set does.
    """
    shift = np.empty(3)
    moved = np.empty(3)
    whole = np.empty(3)
    spread = np.empty((3, 3))
    chosen = np.empty(LARGEST_SET, np.int64)
    full = exclude(S, z, gain, members, size, shift, spread)
    to_local(axes, shift, spread, whole)
    for wanted in range(size):
        best = -1.0
        for mask in range(1 << size):
            count = 0
            for row in range(size):
                if mask >> row & 1:
                    if count < wanted:
                        chosen[count] = members[row]
                    count += 1
            if count != wanted:
                continue
            explained = exclude(S, z, gain, chosen, wanted, shift, spread)
            to_local(axes, shift, spread, moved)
            near = math.hypot(moved[0] - whole[0], moved[1] - whole[1]) <= allowed_shift
            if near and full - explained <= allowed_squares[size - wanted] and explained > best:
                best = explained
                for row in range(wanted):
                    kept[row] = chosen[row]
        if best >= 0.0:
            return wanted
    for row in range(size):
        kept[row] = members[row]
    return size
