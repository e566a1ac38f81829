r"""The posterior over sets of faulty satellites, of one epoch.

Each set F of k satellites is a hypothesis: their ranges carry biases b_i ~ N(0, (s B)^2), the rest noise of
s sigma_i, position and clocks are anything. The integrals over position, clocks and biases are Gaussian, so
that the marginal likelihood is a closed form in the parity space of the solution that uses all satellites
(METHODS_GNSS, "A decision that is honest and still answers"):

    ln w_F = k ln th + (n - k) ln(1 - th)
             + ln mean_B exp{ - 1/2 ln|S_FF + D_B| - sum_F ln(B / sigma_i)
                              - (a + m/2) ln(1 + (z'z - z_F'(S_FF + D_B)^-1 z_F) / (2 b)) },

D_B = diag(sigma_i^2 / B^2), m = n - p, th the prior probability of a fault. Where METHODS fixes the scale s
of the noise beforehand, here s^2 has an inverse-gamma prior (a, b) and is integrated out, which turns the
exponential into the power of a Student density: sigmas that are stated too large or too small change the
confidence of an answer, and hardly the answer.

Sets are enumerated by depth-first search, each extending the Cholesky factor of its parent by one row; where
there are too many, larger sets are found by a beam of the best ones, and by consensus.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.snapshot.consensus_sets import HOPELESS, MOST_PROPOSED, propose_sets
from estimators.gnss.snapshot.fault_weight import BIASES_M, LARGEST_SET, extend, fill_volume, log_weight
from estimators.kernels import device

BEAM = 32
MOST_ENUMERATED = 2000
CAPACITY = MOST_ENUMERATED + LARGEST_SET * BEAM + 1 + MOST_PROPOSED


@device
def enumerated_size(n: int, most: int) -> int:
    """Largest size up to which all sets are enumerated."""
    total = 1.0
    binomial = 1.0
    size = 0
    while size < most:
        binomial *= (n - size) / (size + 1.0)
        total += binomial
        if total > MOST_ENUMERATED:
            break
        size += 1
    return size


@device
def is_exhaustive(n: int, freedom: int) -> bool:
    """Whether every set that the data can judge is enumerated."""
    return freedom <= LARGEST_SET and enumerated_size(n, freedom) == freedom


@device
def weigh_fault_sets(
    A: FloatArray,
    S: FloatArray,
    z: FloatArray,
    sigma: FloatArray,
    clock: IntArray,
    order: IntArray,
    freedom: int,
    suspicious: bool,
    fault_prior: float,
    shape: float,
    scale: float,
    members: IntArray,
    sizes: IntArray,
    weights: FloatArray,
) -> int:
    """Fill fault sets and their ln weights, the empty set first; returns how many.

    Parameters
    ----------
    A, S, z, sigma : ndarray
        Whitened design, parity matrix and whitened residuals of the solution by all satellites; noise in
        metres.
    clock : ndarray of int64, shape (n,)
        Receiver clock of each satellite.
    order : ndarray of int64, shape (n,)
        Satellites in an order that does not hang on how they were given.
    freedom : int
        n - p.
    suspicious : bool
        Whether the residuals are too large for noise; otherwise large sets are not sampled.
    fault_prior, shape, scale : float
        Prior probability of a fault; inverse-gamma prior of the squared noise scale.
    members : ndarray of int64, shape (CAPACITY, LARGEST_SET)
        Out; satellites of each set, in increasing order.
    sizes : ndarray of int64, shape (CAPACITY,)
        Out.
    weights : ndarray of float64, shape (CAPACITY,)
        Out; ln w up to a constant.
    """
    n = z.size
    count = BIASES_M.size
    ridge = np.zeros((count + 1, n))
    squares = 0.0
    for i in range(n):
        squares += z[i] * z[i]
        for b in range(count):
            ridge[b + 1, i] = (sigma[i] / BIASES_M[b]) ** 2
    factor = np.empty((count + 1, LARGEST_SET, LARGEST_SET))
    solved = np.empty((count + 1, LARGEST_SET))
    explained = np.empty((count + 1, LARGEST_SET))
    determinant = np.empty((count + 1, LARGEST_SET))
    volume = np.ones(count)
    current = np.zeros(LARGEST_SET, np.int64)

    most = min(freedom, LARGEST_SET)
    enumerated = enumerated_size(n, most)
    weights[0] = log_weight(n, 0, freedom, squares, volume, explained, determinant, fault_prior, shape, scale)
    sizes[0] = 0
    found = 1
    best = weights[0]

    # Depth first, members increasing; `current[depth]` is the satellite tried next at that depth.
    depth = 0
    while depth >= 0 and enumerated > 0:
        i = current[depth]
        if i >= n:
            depth -= 1
            if depth >= 0:
                current[depth] += 1
            continue
        if not extend(S, z, ridge, current, depth, i, factor, solved, explained, determinant):
            current[depth] += 1
            continue
        size = depth + 1
        fill_volume(sigma, current, size, volume)
        weights[found] = log_weight(
            n, size, freedom, squares, volume, explained, determinant, fault_prior, shape, scale
        )
        best = max(best, weights[found])
        sizes[found] = size
        for row in range(size):
            members[found, row] = current[row]
        found += 1
        if size < enumerated:
            current[size] = i + 1
            depth = size
        else:
            current[depth] += 1

    if enumerated < most and enumerated > 0:
        found = _beam(
            S, z, ridge, sigma, squares, freedom, fault_prior, shape, scale, enumerated, most, best,
            members, sizes, weights, found, factor, solved, explained, determinant,
        )  # fmt: skip
        if suspicious:
            found = propose_sets(
                A, S, z, ridge, sigma, clock, order, squares, fault_prior, shape, scale, enumerated, most,
                members, sizes, weights, found,
            )  # fmt: skip
    return found


@device
def _beam(
    S: FloatArray,
    z: FloatArray,
    ridge: FloatArray,
    sigma: FloatArray,
    squares: float,
    freedom: int,
    fault_prior: float,
    shape: float,
    scale: float,
    size: int,
    most: int,
    best: float,
    members: IntArray,
    sizes: IntArray,
    weights: FloatArray,
    found: int,
    factor: FloatArray,
    solved: FloatArray,
    explained: FloatArray,
    determinant: FloatArray,
) -> int:
    """Extend the best sets of one size by every satellite, keep the best of the next, and so on."""
    n = z.size
    count = BIASES_M.size
    parents = _heaviest(sizes, weights, found, size)
    trial = np.empty(BEAM * n)
    parent_of = np.empty(BEAM * n, np.int64)
    added = np.empty(BEAM * n, np.int64)
    volume = np.empty(count)
    row_of = np.empty(LARGEST_SET, np.int64)
    while size < most and parents.size > 0:
        tried = 0
        for parent in parents:
            for row in range(size):
                extend(S, z, ridge, members[parent], row, members[parent, row],
                       factor, solved, explained, determinant)  # fmt: skip
            for i in range(n):
                held = False
                for row in range(size):
                    held = held or members[parent, row] == i
                if held or not extend(
                    S, z, ridge, members[parent], size, i, factor, solved, explained, determinant
                ):
                    continue
                fill_volume(sigma, members[parent], size, volume)
                for b in range(count):
                    volume[b] *= BIASES_M[b] / sigma[i]
                trial[tried] = log_weight(
                    n, size + 1, freedom, squares, volume, explained, determinant,
                    fault_prior, shape, scale,
                )  # fmt: skip
                parent_of[tried] = parent
                added[tried] = i
                tried += 1
        if tried == 0:
            break
        size += 1
        first = found
        # Stable, so that equal weights keep the order in which they were tried.
        order = np.argsort(-trial[:tried], kind="mergesort")
        for place in order:
            if found - first == BEAM or found == CAPACITY:
                break
            insert_member(members[parent_of[place]], size - 1, added[place], row_of)
            if not is_known(members, first, found, size, row_of):
                for row in range(size):
                    members[found, row] = row_of[row]
                sizes[found] = size
                weights[found] = trial[place]
                found += 1
        parents = np.arange(first, found)
        if weights[first] < best - HOPELESS:
            break
        best = max(best, weights[first])
    return found


@device
def _heaviest(sizes: IntArray, weights: FloatArray, found: int, size: int) -> IntArray:
    """Up to BEAM sets of one size, the heaviest first."""
    places = np.flatnonzero(sizes[:found] == size)
    order = np.argsort(-weights[places], kind="mergesort")
    return places[order[:BEAM]]


@device
def insert_member(members: IntArray, size: int, i: int, out: IntArray) -> None:
    """Members with ``i`` at its place."""
    row = size
    while row > 0 and members[row - 1] > i:
        out[row] = members[row - 1]
        row -= 1
    out[row] = i
    for k in range(row):
        out[k] = members[k]


@device
def is_known(members: IntArray, first: int, last: int, size: int, wanted: IntArray) -> bool:
    """Whether a set is among those of its size from one place to another."""
    for place in range(first, last):
        same = True
        for row in range(size):
            if members[place, row] != wanted[row]:
                same = False
                break
        if same:
            return True
    return False
