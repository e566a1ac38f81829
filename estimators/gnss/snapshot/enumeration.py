"""Every fault set up to a size, depth first, by elimination.

Taking a satellite into the set eliminates its row and column from S + D_B and z, for every prior size B of
a bias at once (index 0: an infinite one). What is left of the other satellites' rows serves all sets that
extend this one, and a set of the last size needs no more than a diagonal entry: sets cost a few
multiplications each.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.snapshot.fault_weight import BIASES_M, SINGULAR, log_weight
from estimators.kernels import device


@device
def enumerate_sets(
    S: FloatArray,
    z: FloatArray,
    sigma: FloatArray,
    squares: float,
    halves: int,
    scale: float,
    priors: FloatArray,
    most: int,
    members: IntArray,
    sizes: IntArray,
    weights: FloatArray,
) -> int:
    """Write all sets of 1 to ``most`` satellites after the empty one; returns how many there are with it.

    Parameters
    ----------
    S, z, sigma, members, sizes, weights
        As in :func:`estimators.gnss.snapshot.fault_sets.weigh_fault_sets`.
    squares : float
        z'z.
    halves, scale : int, float
        As in :func:`estimators.gnss.snapshot.fault_weight.log_weight`.
    priors : ndarray
        ln prior of a set, by size.
    most : int
    """
    n = z.size
    count = BIASES_M.size + 1
    found = 1
    if most == 0:
        return found
    left = np.empty((most, count, n, n))
    held = np.empty((most, count, n))
    explained = np.zeros((most + 1, count))
    determinant = np.ones(most + 1)
    width = np.ones((most + 1, count - 1))
    current = np.zeros(most, np.int64)
    ratio = np.ones((count, n))
    for i in range(n):
        for b in range(1, count):
            ratio[b, i] = (BIASES_M[b - 1] / sigma[i]) ** 2
    for b in range(count):
        for i in range(n):
            held[0, b, i] = z[i]
            for j in range(i + 1):
                left[0, b, i, j] = S[i, j]
            if b > 0:
                left[0, b, i, i] += 1.0 / ratio[b, i]

    # `current[depth]` is the satellite tried next at that depth; members increase.
    depth = 0
    while depth >= 0:
        i = current[depth]
        if i >= n:
            depth -= 1
            if depth >= 0:
                current[depth] += 1
            continue
        determinant[depth + 1] = determinant[depth] * left[depth, 0, i, i]
        if not determinant[depth + 1] > SINGULAR:
            # The other satellites do not determine the position.
            current[depth] += 1
            continue
        for b in range(count):
            pivot = left[depth, b, i, i]
            explained[depth + 1, b] = explained[depth, b] + held[depth, b, i] ** 2 / pivot
            if b > 0:
                width[depth + 1, b - 1] = width[depth, b - 1] * pivot * ratio[b, i]
        weights[found] = log_weight(
            priors[depth + 1], halves, squares, scale, explained[depth + 1], width[depth + 1]
        )
        sizes[found] = depth + 1
        for row in range(depth + 1):
            members[found, row] = current[row]
        found += 1
        if depth + 1 == most:
            current[depth] += 1
            continue
        for b in range(count):
            reciprocal = 1.0 / left[depth, b, i, i]
            for j in range(i + 1, n):
                factor = left[depth, b, j, i] * reciprocal
                held[depth + 1, b, j] = held[depth, b, j] - factor * held[depth, b, i]
                first = j if depth + 2 == most else i + 1
                for k in range(first, j + 1):
                    left[depth + 1, b, j, k] = left[depth, b, j, k] - factor * left[depth, b, k, i]
        depth += 1
        current[depth] = i + 1
    return found
