"""From weighted fault sets to an answer: which of them matter, where they lead, what to leave out.

The position under a set F is x_F = x_0 - N A_F' S_FF^-1 z_F. The answer is the set that minimises the tail at
the alert limit (:mod:`estimators.gnss.snapshot.tails`), or as few of its satellites as do as well
(METHODS_GNSS, "A decision that is honest and still answers").
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.snapshot.fault_weight import LARGEST_SET
from estimators.gnss.snapshot.tails import tail
from estimators.kernels import device

HEAVY = 256
"""Sets whose positions are computed, at most."""
CANDIDATES = 12
"""Sets among which the answer is chosen."""
_INDIFFERENT = 1e-3
"""Of sets whose positions are far off with probabilities this close to the least, the likeliest is taken."""
_NEGLIGIBLE = 0.1
"""Share of the risk that sets may take together whose positions are not worth computing."""


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
def heaviest(
    weights: FloatArray, found: int, untested: float, risk: float, places: IntArray, shares: FloatArray
) -> tuple[int, float]:
    """Places and probabilities of the heaviest sets, in decreasing order.

    The others found go with the last of these, the least probable place that is known.

    Parameters
    ----------
    weights : ndarray
        ln w of the sets found.
    found : int
    untested : float
        Weight of the sets that nothing can judge, in units of the heaviest found.
    risk : float
        Sets that take a small share of it together are left out.
    places, shares : ndarray, shape (HEAVY,)
        Out.

    Returns
    -------
    count : int
    anywhere : float
        Probability of the sets that nothing can judge.
    """
    order = np.argsort(-weights[:found], kind="mergesort")
    largest = weights[order[0]]
    total = untested
    for k in range(found):
        total += math.exp(weights[order[k]] - largest)
    rest = 0.0
    count = found
    while count > 1:
        share = math.exp(weights[order[count - 1]] - largest) / total
        if count <= HEAVY and rest + share > _NEGLIGIBLE * risk:
            break
        rest += share
        count -= 1
    for k in range(count):
        places[k] = order[k]
        shares[k] = math.exp(weights[order[k]] - largest) / total
    shares[count - 1] += rest
    return count, untested / total


@device
def empty_share(places: IntArray, shares: FloatArray) -> float:
    """Probability that no satellite is faulty; the empty set is the first that is weighed."""
    share = 0.0
    for h in range(places.size):
        if places[h] == 0:
            share = shares[h]
    return share


@device
def safest(alert_m: float, place: FloatArray, variance: FloatArray, nu: int, shares: FloatArray) -> int:
    """Which of the heaviest sets leads to the position that is least likely to be far off.

    Parameters
    ----------
    alert_m : float
    place : ndarray, shape (count, 3)
        Positions of the sets, the heaviest first, in a local frame.
    variance : ndarray, shape (count,)
        Of their larger horizontal semi-axes.
    nu : int
    shares : ndarray, shape (count,)
    """
    count = shares.size
    candidates = min(count, CANDIDATES)
    distance, risks = np.empty(count), np.empty(candidates)
    for h in range(candidates):
        for g in range(count):
            distance[g] = math.hypot(place[h, 0] - place[g, 0], place[h, 1] - place[g, 1])
        risks[h] = tail(alert_m, distance, variance, nu, shares)
    best = 0
    while risks[best] > risks.min() + _INDIFFERENT:
        best += 1
    return best


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
