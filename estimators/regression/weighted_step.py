"""The weighted least-squares step that every iteration here is made of, for compiled code.

A step solves for a *correction* from present residuals, so that repeating it refines the solution: what
the first solve loses to rounding, the next one finds in the residuals. The design is centred by its first
column (the constant) before products are formed, because uncentred sums square the condition of data
that stand far from the origin (METHODS.md 13.2). Sums run in the order of the points; no BLAS.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray
from estimators.kernels import device

_EPS = 2.220446049250313e-16
_CENTRED_NOTHING = (32 * _EPS) ** 2  # energy of rounding errors relative to that of the column itself
_REDUCED_NOTHING = 64 * _EPS  # rounding of a pivot relative to what it was before reduction


@device
def weighted_step(columns: FloatArray, residual: FloatArray, weights: FloatArray, step: FloatArray) -> int:
    """Write the ``step`` that minimises sum w (r - step @ columns)^2; return the rank.

    Coefficients that the weighted points do not determine (zero pivots) get a step of 0: they stay as
    they are.
    """
    p, n = columns.shape
    mean = np.zeros(p)
    step[:] = 0.0
    energy = 0.0
    level = 0.0
    for i in range(n):
        wx = weights[i] * columns[0, i]
        energy += wx * columns[0, i]
        level += wx * residual[i]
    if not energy > 0.0:
        return 0
    level /= energy
    if p == 1:
        step[0] = level
        return 1

    for j in range(1, p):
        product = 0.0
        for i in range(n):
            product += weights[i] * columns[0, i] * columns[j, i]
        mean[j] = product / energy

    # Lower triangle of the centred products; row 0 holds the right-hand side.
    gram = np.zeros((p, p))
    for j in range(1, p):
        raw = 0.0
        right = 0.0
        for i in range(n):
            x = columns[j, i] - mean[j] * columns[0, i]
            raw += weights[i] * columns[j, i] * columns[j, i]
            gram[j, j] += weights[i] * x * x
            right += weights[i] * x * (residual[i] - level * columns[0, i])
        if not gram[j, j] > _CENTRED_NOTHING * raw:
            gram[j, j] = 0.0
        gram[0, j] = right
        for k in range(1, j):
            product = 0.0
            for i in range(n):
                product += (
                    weights[i]
                    * (columns[j, i] - mean[j] * columns[0, i])
                    * (columns[k, i] - mean[k] * columns[0, i])
                )
            gram[j, k] = product
    rank = 1 + solve_centred(gram, step)
    step[0] = level
    for j in range(1, p):
        step[0] -= mean[j] * step[j]
    return rank


@device
def solve_centred(gram: FloatArray, step: FloatArray) -> int:
    """Solve ``gram[1:, 1:] step[1:] = gram[0, 1:]`` by L D L' of the lower triangle; return the rank.

    In place and without square roots: data that are exact in binary give coefficients that are exact.
    """
    p = gram.shape[0]
    rank = 0
    for j in range(1, p):
        before = gram[j, j]
        pivot = before
        for k in range(1, j):
            pivot -= gram[j, k] * gram[j, k] * gram[k, k]
        usable = pivot > _REDUCED_NOTHING * before
        gram[j, j] = pivot if usable else 0.0
        rank += 1 if usable else 0
        for i in range(j + 1, p):
            value = gram[i, j]
            for k in range(1, j):
                value -= gram[i, k] * gram[j, k] * gram[k, k]
            gram[i, j] = value / pivot if usable else 0.0
    for j in range(1, p):
        value = gram[0, j]
        for k in range(1, j):
            value -= gram[j, k] * step[k]
        step[j] = value
    for back in range(1, p):
        j = p - back
        value = step[j] / gram[j, j] if gram[j, j] > 0.0 else 0.0
        if gram[j, j] > 0.0:
            for i in range(j + 1, p):
                value -= gram[i, j] * step[i]
        step[j] = value
    return rank


@device
def residuals_of(columns: FloatArray, y: FloatArray, theta: FloatArray, residual: FloatArray) -> None:
    """Write y - theta @ columns, summed in the order of the coefficients."""
    p, n = columns.shape
    for i in range(n):
        fitted = theta[0] * columns[0, i]
        for j in range(1, p):
            fitted += theta[j] * columns[j, i]
        residual[i] = y[i] - fitted


@device
def largest_value(columns: FloatArray, theta: FloatArray) -> float:
    """Largest |theta @ columns| over the points."""
    p, n = columns.shape
    largest = 0.0
    for i in range(n):
        value = 0.0
        for j in range(p):
            value += theta[j] * columns[j, i]
        largest = max(largest, abs(value))
    return largest
