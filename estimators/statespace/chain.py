r"""Least squares along a chain of states: the smoother of Rauch, Tung and Striebel in information form.

Minimised is

    sum_k (1/2 x_k' H_k x_k - g_k' x_k) + 1/2 sum_k (x_{k+1} - F_k x_k)' W_k (x_{k+1} - F_k x_k),

H_k and g_k what is measured at k, W_k the inverse of the process noise. The normal equations are block
tridiagonal; forward elimination and back substitution cost O(T d^3). The information form takes states about
which nothing is measured, and W of any size; only the whole must be determined.

Sums run in fixed order and no BLAS is called, so that equal input gives equal bits.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.kernels import device

_SINGULAR = 1e-14


@device
def invert(matrix: FloatArray, inverse: FloatArray, factor: FloatArray) -> bool:
    """Inverse of a symmetric positive matrix; False where it is not positive to working precision."""
    d = matrix.shape[0]
    for j in range(d):
        pivot = matrix[j, j]
        for k in range(j):
            pivot -= factor[j, k] * factor[j, k]
        if not pivot > _SINGULAR * abs(matrix[j, j]) or not math.isfinite(pivot):
            return False
        root = math.sqrt(pivot)
        factor[j, j] = root
        for i in range(j + 1, d):
            held = matrix[i, j]
            for k in range(j):
                held -= factor[i, k] * factor[j, k]
            factor[i, j] = held / root
    for column in range(d):
        for j in range(column, d):
            held = 1.0 if j == column else 0.0
            for k in range(column, j):
                held -= factor[j, k] * inverse[k, column]
            inverse[j, column] = held / factor[j, j]
        for j in range(d - 1, column - 1, -1):
            held = inverse[j, column]
            for k in range(j + 1, d):
                held -= factor[k, j] * inverse[k, column]
            inverse[j, column] = held / factor[j, j]
        for j in range(column, d):
            inverse[column, j] = inverse[j, column]
    return True


@device
def solve_chain(
    H: FloatArray, g: FloatArray, F: FloatArray, W: FloatArray, x: FloatArray, P: FloatArray
) -> bool:
    """Smoothed states and their covariances.

    Parameters
    ----------
    H : ndarray, shape (T, d, d)
        Information; overwritten.
    g : ndarray, shape (T, d)
        Overwritten.
    F, W : ndarray, shape (T - 1, d, d)
        Transition, and inverse of the covariance of its noise.
    x : ndarray, shape (T, d)
        Out.
    P : ndarray, shape (T, d, d)
        Out.

    Returns
    -------
    bool
        False where the measurements do not determine the states.
    """
    T, d = g.shape
    back = np.empty((max(T - 1, 1), d, d))
    coupling = np.empty((d, d))
    factor = np.empty((d, d))
    held = np.empty((d, d))
    for k in range(T):
        if k + 1 < T:
            # coupling = W F; its transpose times F is what the step adds to the earlier state.
            _multiply(W[k], F[k], coupling)
            for i in range(d):
                for j in range(d):
                    total = 0.0
                    for m in range(d):
                        total += F[k, m, i] * coupling[m, j]
                    H[k, i, j] += total
                    H[k + 1, i, j] += W[k, i, j]
        # P[k] holds the inverse of the eliminated block until the way back.
        if not invert(H[k], P[k], factor):
            return False
        if k + 1 < T:
            # The later block loses W F P F' W; its right side gains W F P g.
            _multiply(coupling, P[k], held)
            for i in range(d):
                for j in range(d):
                    back[k, i, j] = held[i, j]
                    total = 0.0
                    for m in range(d):
                        total += held[i, m] * coupling[j, m]
                    H[k + 1, i, j] -= total
                gained = 0.0
                for m in range(d):
                    gained += held[i, m] * g[k, m]
                g[k + 1, i] += gained
    for k in range(T - 1, -1, -1):
        for i in range(d):
            total = 0.0
            for j in range(d):
                total += P[k, i, j] * g[k, j]
            x[k, i] = total
        if k + 1 < T:
            # x_k += P F' W x_{k+1};  P_k += (P F' W) P_{k+1} (P F' W)'.
            for i in range(d):
                total = 0.0
                for j in range(d):
                    total += back[k, j, i] * x[k + 1, j]
                x[k, i] += total
            for i in range(d):
                for j in range(d):
                    total = 0.0
                    for m in range(d):
                        total += P[k + 1, i, m] * back[k, m, j]
                    held[i, j] = total
            for i in range(d):
                for j in range(d):
                    total = 0.0
                    for m in range(d):
                        total += back[k, m, i] * held[m, j]
                    P[k, i, j] += total
    return True


@device
def _multiply(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    d = a.shape[0]
    for i in range(d):
        for j in range(d):
            total = 0.0
            for m in range(d):
                total += a[i, m] * b[m, j]
            out[i, j] = total
