"""Exact fits through minimal samples: as many points as coefficients."""

from __future__ import annotations

import numba
import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import kernel, ro

_EPS = 2.220446049250313e-16
_F8 = numba.float64


def solve_samples(columns: FloatArray, y: FloatArray, samples: IntArray) -> FloatArray:
    """Exact fits of minimal samples, without the degenerate ones.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
    y : ndarray of float64, shape (n,)
    samples : ndarray of int64, shape (m, p)
        Indices of points.

    Returns
    -------
    ndarray of float64, shape (k, p)
        k <= m, in the order of the samples.
    """
    thetas = np.empty(samples.shape)
    found = _solve_samples(columns, y, np.ascontiguousarray(samples), thetas)
    return thetas[:found]


@kernel(numba.int64(ro(_F8, 2), ro(_F8), ro(numba.int64, 2), _F8[:, ::1]))
def _solve_samples(columns: FloatArray, y: FloatArray, samples: IntArray, thetas: FloatArray) -> int:
    """Write the exact fits of the samples that have one, in order; return how many."""
    m, p = samples.shape
    matrix = np.empty((p, p + 1))
    found = 0
    for s in range(m):
        largest = 0.0
        for i in range(p):
            for j in range(p):
                matrix[i, j] = columns[j, samples[s, i]]
                largest = max(largest, abs(matrix[i, j]))
            matrix[i, p] = y[samples[s, i]]
        solvable = True
        for j in range(p):
            best = j
            for i in range(j + 1, p):
                if abs(matrix[i, j]) > abs(matrix[best, j]):
                    best = i
            if not abs(matrix[best, j]) > 4.0 * _EPS * largest:
                solvable = False
                break
            for k in range(p + 1):
                held = matrix[j, k]
                matrix[j, k] = matrix[best, k]
                matrix[best, k] = held
            for i in range(j + 1, p):
                factor = matrix[i, j] / matrix[j, j]
                for k in range(j, p + 1):
                    matrix[i, k] -= factor * matrix[j, k]
        if not solvable:
            continue
        for back in range(p):
            j = p - 1 - back
            value = matrix[j, p]
            for k in range(j + 1, p):
                value -= matrix[j, k] * thetas[found, k]
            thetas[found, j] = value / matrix[j, j]
        found += 1
    return found
