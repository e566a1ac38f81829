"""Large fault sets of many satellites: the best sets of one size, each with one satellite more, and so on.

Sets of a size are ranked by what they explain, z_F' S_FF^-1 z_F, which asks for one factor only; those that
are kept get their weight (:mod:`estimators.gnss.snapshot.fault_weight`).
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.snapshot.fault_weight import BIASES_M, LARGEST_SET, extend, fill_width, log_weight
from estimators.kernels import device

BEAM = 64
"""Sets kept of a size, at most, and two for every satellite. With 32 of them, one epoch in a thousand of 32
satellites and 8 faults went astray."""
_HOPELESS = 12.0
"""A beam whose best set is exp(-12) times as likely as the best of all ends, once it explains the ranges."""


@device
def search_beam(
    S: FloatArray,
    z: FloatArray,
    sigma: FloatArray,
    squares: float,
    freedom: int,
    halves: int,
    scale: float,
    priors: FloatArray,
    size: int,
    members: IntArray,
    sizes: IntArray,
    weights: FloatArray,
    found: int,
) -> int:
    """Add sets of more than ``size`` satellites; returns how many sets there are then.

    Parameters
    ----------
    S, z, sigma, freedom, members, sizes, weights
        As in :func:`estimators.gnss.snapshot.fault_sets.weigh_fault_sets`.
    squares : float
        z'z.
    halves, scale : int, float
        As in :func:`estimators.gnss.snapshot.fault_weight.log_weight`.
    priors : ndarray
        ln prior of a set, by size, up to the largest that is looked for.
    size : int
        Up to which all sets are there.
    found : int
        Sets that are there.
    """
    n = z.size
    width = min(BEAM, 2 * n)
    count = BIASES_M.size
    ridge = np.zeros((count + 1, n))
    for b in range(count):
        for i in range(n):
            ridge[b + 1, i] = (sigma[i] / BIASES_M[b]) ** 2
    excluding = ridge[:1]
    factor = np.empty((count + 1, LARGEST_SET, LARGEST_SET))
    solved, explained = np.empty((count + 1, LARGEST_SET)), np.empty((count + 1, LARGEST_SET))
    determinant = np.empty((count + 1, LARGEST_SET))
    most = priors.size - 1
    parents = _heaviest(sizes, weights, found, size, width)
    trial = np.empty(width * n)
    parent_of = np.empty(width * n, np.int64)
    added = np.empty(width * n, np.int64)
    volume = np.empty(count)
    best = weights[:found].max()
    row_of = np.empty(LARGEST_SET, np.int64)
    while size < most and parents.size > 0:
        tried = 0
        for parent in parents:
            for row in range(size):
                extend(S, z, excluding, members[parent], row, members[parent, row],
                       factor, solved, explained, determinant)  # fmt: skip
            for i in range(n):
                held = False
                for row in range(size):
                    held = held or members[parent, row] == i
                if not held and extend(
                    S, z, excluding, members[parent], size, i, factor, solved, explained, determinant
                ):
                    trial[tried] = explained[0, size]
                    parent_of[tried] = parent
                    added[tried] = i
                    tried += 1
        size += 1
        first = found
        heaviest = -np.inf
        # Stable, so that equal sets keep the order in which they were tried.
        order = np.argsort(-trial[:tried], kind="mergesort")
        for place in order:
            if found - first == width or found == sizes.size:
                break
            insert_member(members[parent_of[place]], size - 1, added[place], row_of)
            if is_known(members, first, found, size, row_of):
                continue
            for row in range(size):
                members[found, row] = row_of[row]
                extend(S, z, ridge, row_of, row, row_of[row], factor, solved, explained, determinant)
            fill_width(sigma, row_of, size, determinant[:, size - 1], volume)
            weights[found] = log_weight(priors[size], halves, squares, scale, explained[:, size - 1], volume)
            heaviest = max(heaviest, weights[found])
            sizes[found] = size
            found += 1
        parents = np.arange(first, found)
        if found == first or (heaviest < best - _HOPELESS and squares - trial[order[0]] <= freedom):
            break
        best = max(best, heaviest)
    return found


@device
def _heaviest(sizes: IntArray, weights: FloatArray, found: int, size: int, most: int) -> IntArray:
    """Sort the sets of one size, the heaviest first."""
    places = np.flatnonzero(sizes[:found] == size)
    order = np.argsort(-weights[places], kind="mergesort")
    return places[order[:most]]


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
