"""For each size, the fault set that explains most of the sum of squares.

Sets are judged by z_F' S_FF^-1 z_F, what their exclusion takes off the sum of squares. All sets of a size are
enumerated depth first, each extending the Cholesky factor of its parent by one row; where a size has too
many, a beam extends the best sets of the size below.
"""

from __future__ import annotations

import numpy as np
from numba import types

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.snapshot.beam import insert_member, is_known
from estimators.gnss.snapshot.fault_weight import LARGEST_SET, extend
from estimators.kernels import device, kernel, ro

MOST_ENUMERATED = 50_000
"""Sets of one size; C(32, 4) is 35,960."""
BEAM = 64


@device
def _count_sets(n: int, size: int) -> int:
    """Binomial coefficient, or one more than the limit where it passes it."""
    total = 1.0
    for k in range(size):
        total *= (n - k) / (k + 1.0)
        if total > 2.0 * MOST_ENUMERATED:
            return MOST_ENUMERATED + 1
    return int(total + 0.5)


@device
def _enumerate(
    S: FloatArray,
    z: FloatArray,
    size: int,
    ridge: FloatArray,
    factor: FloatArray,
    solved: FloatArray,
    explained: FloatArray,
    determinant: FloatArray,
    members: IntArray,
    gained: FloatArray,
) -> int:
    """Write every set of a size whose exclusion leaves the position determined; returns how many."""
    n = z.size
    current = np.zeros(LARGEST_SET, np.int64)
    found = 0
    depth = 0
    while depth >= 0:
        i = current[depth]
        if i > n - size + depth:
            depth -= 1
            if depth >= 0:
                current[depth] += 1
            continue
        if not extend(S, z, ridge, current, depth, i, factor, solved, explained, determinant):
            current[depth] += 1
            continue
        if depth + 1 < size:
            current[depth + 1] = i + 1
            depth += 1
            continue
        for row in range(size):
            members[found, row] = current[row]
        gained[found] = explained[0, depth]
        found += 1
        current[depth] += 1
    return found


@device
def _extend_best(
    S: FloatArray,
    z: FloatArray,
    size: int,
    parents: IntArray,
    members: IntArray,
    ridge: FloatArray,
    factor: FloatArray,
    solved: FloatArray,
    explained: FloatArray,
    determinant: FloatArray,
    children: IntArray,
    gained: FloatArray,
) -> int:
    """Best sets of a size among those that add one satellite to a parent; returns how many."""
    n = z.size
    trial = np.empty(parents.size * n)
    parent_of = np.empty(parents.size * n, np.int64)
    added = np.empty(parents.size * n, np.int64)
    tried = 0
    for parent in parents:
        for row in range(size - 1):
            extend(
                S, z, ridge, members[parent], row, members[parent, row], factor, solved, explained,
                determinant,
            )  # fmt: skip
        for i in range(n):
            held = False
            for row in range(size - 1):
                held = held or members[parent, row] == i
            if not held and extend(
                S, z, ridge, members[parent], size - 1, i, factor, solved, explained, determinant
            ):
                trial[tried] = explained[0, size - 1]
                parent_of[tried] = parent
                added[tried] = i
                tried += 1
    order = np.argsort(-trial[:tried], kind="mergesort")
    row_of = np.empty(LARGEST_SET, np.int64)
    found = 0
    for place in order:
        if found == BEAM:
            break
        insert_member(members[parent_of[place]], size - 1, added[place], row_of)
        if not is_known(children, 0, found, size, row_of):
            for row in range(size):
                children[found, row] = row_of[row]
            gained[found] = trial[place]
            found += 1
    return found


@kernel(
    types.int64(
        ro(types.float64, 2),
        ro(types.float64),
        types.int64,
        ro(types.float64),
        types.int64[::1],
        types.int64[::1],
    )
)
def find_smallest_passing(
    S: FloatArray, z: FloatArray, most: int, limits: FloatArray, chosen: IntArray, counts: IntArray
) -> int:
    """Smallest fault set whose exclusion brings the sum of squares under its limit.

    Parameters
    ----------
    S, z : ndarray
        Parity matrix and least-squares residuals of all satellites.
    most : int
        Largest size, at most ``LARGEST_SET``.
    limits : ndarray, shape (most + 1,)
        Limit of the sum of squares after the exclusion of so many satellites.
    chosen : ndarray of int64, shape (LARGEST_SET,)
        Out: the set; where none passes, the one that is nearest to its limit.
    counts : ndarray of int64, shape (2,)
        Out: sets judged; 1 if every set of the sizes searched was among them.

    Returns
    -------
    int
        Size of the set.
    """
    n = z.size
    squares = 0.0
    for i in range(n):
        squares += z[i] * z[i]
    counts[0], counts[1] = 1, 1
    if squares <= limits[0]:
        return 0
    ridge = np.zeros((1, n))
    factor = np.empty((1, LARGEST_SET, LARGEST_SET))
    solved = np.empty((1, LARGEST_SET))
    explained = np.empty((1, LARGEST_SET))
    determinant = np.empty((1, LARGEST_SET))
    members = np.empty((0, LARGEST_SET), np.int64)
    gained = np.empty(0)
    found = 0
    nearest, best_size = squares / limits[0], 0
    for size in range(1, most + 1):
        total = _count_sets(n, size)
        if total <= MOST_ENUMERATED:
            members = np.empty((total, LARGEST_SET), np.int64)
            gained = np.empty(total)
            found = _enumerate(S, z, size, ridge, factor, solved, explained, determinant, members, gained)
        else:
            counts[1] = 0
            parents = np.argsort(-gained[:found], kind="mergesort")[:BEAM]
            children = np.empty((BEAM, LARGEST_SET), np.int64)
            gained = np.empty(BEAM)
            found = _extend_best(
                S, z, size, parents, members, ridge, factor, solved, explained, determinant,
                children, gained,
            )  # fmt: skip
            members = children
        if found == 0:
            break
        counts[0] += found
        best = np.argmax(gained[:found])
        distance = max(0.0, squares - gained[best]) / limits[size]
        if distance < nearest:
            nearest = distance
            best_size = size
            for row in range(size):
                chosen[row] = members[best, row]
        if distance <= 1.0:
            break
    return best_size
