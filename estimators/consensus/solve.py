"""Compiled solvers of linear models: through s = p points exactly, through more by least squares.

Both stand in plain loops with a fixed order of summation, so that the same points give the same bytes
wherever they are solved.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.scan import Rows, residual_at
from estimators.kernels import device

RANK_TOLERANCE = 16.0 * np.finfo(np.float64).eps
"""Pivots below this share of the largest entry are taken for rounding of a zero."""


@device
def solve_exactly(rows: Rows, sample: IntArray, system: FloatArray, theta: FloatArray) -> bool:
    """Model through p points, by elimination with row pivoting; False if the sample is degenerate.

    Parameters
    ----------
    rows : Rows
        Not weighted: a model through p points does not depend on their weights.
    sample : ndarray of int64, shape (p,)
    system : ndarray of float64, shape (p, p + 1)
        Room.
    theta : ndarray of float64, shape (p,)
        Written.
    """
    p = theta.size
    if p == 2:
        sound, theta[0], theta[1] = solve_two(rows, sample[0], sample[1])
        return sound
    largest = 0.0
    for i in range(p):
        for j in range(p):
            system[i, j] = rows.columns[j, rows.base + sample[i]]
            largest = max(largest, abs(system[i, j]))
        system[i, p] = rows.y[sample[i]]
    for j in range(p):
        pivot = j
        for i in range(j + 1, p):
            if abs(system[i, j]) > abs(system[pivot, j]):
                pivot = i
        if not abs(system[pivot, j]) > RANK_TOLERANCE * largest:
            return False
        if pivot != j:
            for k in range(j, p + 1):
                system[j, k], system[pivot, k] = system[pivot, k], system[j, k]
        for i in range(j + 1, p):
            factor = system[i, j] / system[j, j]
            for k in range(j + 1, p + 1):
                system[i, k] -= factor * system[j, k]
    for j in range(p - 1, -1, -1):
        value = system[j, p]
        for k in range(j + 1, p):
            value -= system[j, k] * theta[k]
        theta[j] = value / system[j, j]
    return True


@device
def solve_two(rows: Rows, i: int, k: int) -> tuple[bool, float, float]:
    """Eliminate as :func:`solve_exactly` does, for points i and k of two columns, in registers.

    Returns whether the sample is sound, and the two coefficients.
    """
    a0, a1, a2 = rows.columns[0, rows.base + i], rows.columns[1, rows.base + i], rows.y[i]
    b0, b1, b2 = rows.columns[0, rows.base + k], rows.columns[1, rows.base + k], rows.y[k]
    least = RANK_TOLERANCE * max(abs(a0), abs(a1), abs(b0), abs(b1))
    if abs(b0) > abs(a0):
        a0, a1, a2, b0, b1, b2 = b0, b1, b2, a0, a1, a2
    if not abs(a0) > least:
        return False, 0.0, 0.0
    factor = b0 / a0
    b1 -= factor * a1
    b2 -= factor * a2
    if not abs(b1) > least:
        return False, 0.0, 0.0
    second = b2 / b1
    return True, (a2 - a1 * second) / a0, second


@device
def fit_members(
    rows: Rows, members: IntArray, count: int, start: FloatArray, system: FloatArray, theta: FloatArray
) -> bool:
    """Least squares through the first ``count`` members, as a correction of the model ``start``.

    Solving for the correction keeps the digits that normal equations lose: their error is relative to the
    residuals of ``start``, not to the values. Iterated, it is the classic refinement of least squares.

    Returns
    -------
    bool
        False, with ``theta`` equal to ``start``, if the members do not determine a model.
    """
    p = start.size
    if p == 2:
        return _fit_two(rows, members, count, start, theta)
    for i in range(p):
        theta[i] = start[i]
        for j in range(p + 1):
            system[i, j] = 0.0
    for m in range(count):
        r = residual_at(rows, start, members[m])
        for i in range(p):
            x = rows.columns[i, rows.base + members[m]]
            system[i, p] += x * r
            for j in range(i + 1):
                system[i, j] += x * rows.columns[j, rows.base + members[m]]
    if not _factor(system, p):
        return False
    for i in range(p):
        for j in range(i):
            system[i, p] -= system[i, j] * system[j, p]
        system[i, p] /= system[i, i]
    for i in range(p - 1, -1, -1):
        for j in range(i + 1, p):
            system[i, p] -= system[j, i] * system[j, p]
        system[i, p] /= system[i, i]
    for i in range(p):
        if not math.isfinite(start[i] + system[i, p]):
            return False
    for i in range(p):
        theta[i] = start[i] + system[i, p]
    return True


@device
def _fit_two(rows: Rows, members: IntArray, count: int, start: FloatArray, theta: FloatArray) -> bool:
    """Fit two columns as :func:`fit_members` does, in registers."""
    a, b = start[0], start[1]
    theta[0], theta[1] = a, b
    s00 = s10 = s11 = g0 = g1 = 0.0
    for m in range(count):
        i = members[m]
        x0 = rows.columns[0, rows.base + i]
        x1 = rows.columns[1, rows.base + i]
        r = (rows.y[i] - a * x0) - b * x1
        s00 += x0 * x0
        s10 += x1 * x0
        s11 += x1 * x1
        g0 += x0 * r
        g1 += x1 * r
    return _correct_two(s00, s10, s11, g0, g1, theta)


@device
def fit_two_near(rows: Rows, points: IntArray, size: int, T: float, theta: FloatArray) -> bool:
    """Fit two columns to those of the first ``size`` points with |residual| <= T, in place.

    The same as listing them and calling :func:`fit_members`: the others add zeros, which change no sum, and
    a loop of fixed length without branches lets one fit begin before the last has ended.

    Returns
    -------
    bool
        False, with ``theta`` as it was, if there are no more than two or they do not determine a model.
    """
    a, b = theta[0], theta[1]
    s00 = s10 = s11 = g0 = g1 = 0.0
    count = 0
    for m in range(size):
        i = points[m]
        x0 = rows.columns[0, rows.base + i]
        x1 = rows.columns[1, rows.base + i]
        r = (rows.y[i] - a * x0) - b * x1
        inside = abs(r) <= T
        count += 1 if inside else 0
        s00 += x0 * x0 if inside else 0.0
        s10 += x1 * x0 if inside else 0.0
        s11 += x1 * x1 if inside else 0.0
        g0 += x0 * r if inside else 0.0
        g1 += x1 * r if inside else 0.0
    return count > 2 and _correct_two(s00, s10, s11, g0, g1, theta)


@device
def _correct_two(s00: float, s10: float, s11: float, g0: float, g1: float, theta: FloatArray) -> bool:
    """Add the solution of two normal equations to ``theta``, by the steps of :func:`fit_members`."""
    if not s00 > RANK_TOLERANCE * s00:
        return False
    d0 = math.sqrt(s00)
    below = s10 / d0
    reduced = s11 - below * below
    if not reduced > RANK_TOLERANCE * s11:
        return False
    d1 = math.sqrt(reduced)
    g0 /= d0
    g1 = (g1 - below * g0) / d1 / d1
    g0 = (g0 - below * g1) / d0
    if not (math.isfinite(theta[0] + g0) and math.isfinite(theta[1] + g1)):
        return False
    theta[0] += g0
    theta[1] += g1
    return True


@device
def _factor(system: FloatArray, p: int) -> bool:
    """Cholesky factor of the lower triangle in place; False if it is singular to working precision."""
    for j in range(p):
        diagonal = system[j, j]
        reduced = diagonal
        for k in range(j):
            reduced -= system[j, k] * system[j, k]
        if not reduced > RANK_TOLERANCE * diagonal:
            return False
        system[j, j] = math.sqrt(reduced)
        for i in range(j + 1, p):
            value = system[i, j]
            for k in range(j):
                value -= system[i, k] * system[j, k]
            system[i, j] = value / system[j, j]
    return True
