"""Compiled rows: residuals of models, their scores, and the scan that values a block of models.

This is the inner loop that the readable engine and the compiled path share. Residuals come in chunks of
:data:`CHUNK` points; a chunk is valued by :func:`score_chunk`, whose eight partial sums are added in one
fixed order, and the chunks are added in order too. No matrix product is involved: regrouping one changes
the last bits (METHODS.md 14).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from estimators.arrays import BoolArray, CodeArray, FloatArray, IntArray
from estimators.kernels import device

CHUNK = 256
"""Points valued between two looks at the bound; a chunk of residuals stays in the fastest cache."""

COUNT, MSAC = 0, 1
"""Codes of the scores in compiled code."""


class Rows(NamedTuple):
    """Points of one series inside arrays that may hold many.

    Attributes
    ----------
    columns : ndarray of float64, shape (p, total)
    base : int
        Where the series starts in the columns.
    y : ndarray of float64, shape (n,)
        Values of this series.
    """

    columns: FloatArray
    base: int
    y: FloatArray


class Value(NamedTuple):
    """What a model is worth: lower loss first, then more inliers, then smaller squares (METHODS.md 13.7).

    Squares are compared after adding 1: models whose inliers are their own samples have squares of nothing
    but rounding, and a tie broken by rounding would not survive a change of units.

    Attributes
    ----------
    loss : float
    inliers : int
    squares : float
        Sum of (r / T)^2 over the inliers; at equal counts it orders as their rms does.
    """

    loss: float
    inliers: int
    squares: float


NOTHING = Value(np.inf, 0, np.inf)
"""Value that any model beats."""


@device
def is_better(a: Value, b: Value) -> bool:
    """Whether ``a`` is worth strictly more than ``b``."""
    if a.loss != b.loss:
        return a.loss < b.loss
    if a.inliers != b.inliers:
        return a.inliers > b.inliers
    return 1.0 + a.squares < 1.0 + b.squares


@device
def copy_into(target: FloatArray, source: FloatArray) -> None:
    """Copy ``target.size`` elements; compiles in a fraction of the time that a slice assignment takes."""
    for i in range(target.size):
        target[i] = source[i]


@device
def fill_residuals(rows: Rows, theta: FloatArray, start: int, count: int, out: FloatArray) -> None:
    """Signed residuals y - theta . x of ``count`` points from ``start`` on."""
    y = rows.y[start : start + count]
    first = rows.columns[0, rows.base + start : rows.base + start + count]
    a = theta[0]
    for i in range(count):
        out[i] = y[i] - a * first[i]
    for j in range(1, theta.size):
        column = rows.columns[j, rows.base + start : rows.base + start + count]
        b = theta[j]
        for i in range(count):
            out[i] -= b * column[i]


@device
def residual_at(rows: Rows, theta: FloatArray, i: int) -> float:
    """Signed residual of one point, to the bit what :func:`fill_residuals` gives."""
    residual: float = rows.y[i]
    for j in range(theta.size):
        residual -= theta[j] * rows.columns[j, rows.base + i]
    return residual


@device
def score_chunk(score: int, r: FloatArray, count: int, T: float) -> Value:
    """Value of ``count`` residuals; they are overwritten.

    COUNT: rho = 0 for |r| <= T, else 1. MSAC: rho = (r / T)^2 for |r| <= T, else 1 (Torr & Zisserman 2000).
    """
    # Squares are taken after division by T, so that values near the ends of the number range do no harm.
    inverse = 1.0 / T
    inliers = 0
    for i in range(count):
        inside = abs(r[i]) <= T
        inliers += 1 if inside else 0
        scaled = r[i] * inverse if inside else 0.0
        r[i] = scaled * scaled
    q0 = q1 = q2 = q3 = q4 = q5 = q6 = q7 = 0.0
    whole = count - count % 8
    for i in range(0, whole, 8):
        q0 += r[i]
        q1 += r[i + 1]
        q2 += r[i + 2]
        q3 += r[i + 3]
        q4 += r[i + 4]
        q5 += r[i + 5]
        q6 += r[i + 6]
        q7 += r[i + 7]
    for i in range(whole, count):
        q0 += r[i]
    squares = ((q0 + q1) + (q2 + q3)) + ((q4 + q5) + (q6 + q7))
    loss = float(count - inliers)
    if score == MSAC:
        loss += squares
    return Value(loss, inliers, squares)


class Scan(NamedTuple):
    """Room for the values of a block of models.

    Attributes
    ----------
    alive : ndarray of uint8, shape (m,)
        1 for models to value; set to 0 when the bound refuses one.
    loss, squares : ndarray of float64, shape (m,)
    inliers : ndarray of int64, shape (m,)
    residual : ndarray of float64, shape (CHUNK,)
    """

    alive: CodeArray
    loss: FloatArray
    inliers: IntArray
    squares: FloatArray
    residual: FloatArray


@device
def scan_models(
    rows: Rows,
    thetas: FloatArray,
    count: int,
    score: int,
    T: float,
    bound: float,
    scan: Scan,
    cancel: CodeArray,
) -> int:
    """Value the living models among the first ``count``; return the number of residuals computed.

    Points are visited chunk by chunk and models inside a chunk, so that large data pass through the cache
    once per block. A model whose partial loss exceeds ``bound`` cannot come below it any more, since no
    term is negative and rounding keeps sums monotone: dropping it changes no result (Capel 2005).
    """
    n = rows.y.size
    evaluations = 0
    for k in range(count):
        scan.loss[k] = 0.0
        scan.inliers[k] = 0
        scan.squares[k] = 0.0
    for start in range(0, n, CHUNK):
        if cancel[0]:
            break
        size = min(CHUNK, n - start)
        for k in range(count):
            if scan.alive[k]:
                fill_residuals(rows, thetas[k], start, size, scan.residual)
                part = score_chunk(score, scan.residual, size, T)
                scan.loss[k] += part.loss
                scan.inliers[k] += part.inliers
                scan.squares[k] += part.squares
                evaluations += size
                if scan.loss[k] > bound:
                    scan.alive[k] = 0
    return evaluations


@device
def best_of(scan: Scan, count: int) -> int:
    """Index of the best living model, the earliest among equals; -1 if none lives."""
    best = -1
    for k in range(count):
        if scan.alive[k] and (best < 0 or is_better(value_of(scan, k), value_of(scan, best))):
            best = k
    return best


@device
def value_of(scan: Scan, k: int) -> Value:
    """Value of the k-th model."""
    return Value(scan.loss[k], scan.inliers[k], scan.squares[k])


@device
def select_members(rows: Rows, theta: FloatArray, T: float, residual: FloatArray, members: IntArray) -> int:
    """List the points with |residual| <= T in ascending order; return their number."""
    n = rows.y.size
    found = 0
    for start in range(0, n, CHUNK):
        size = min(CHUNK, n - start)
        fill_residuals(rows, theta, start, size, residual)
        for i in range(size):
            members[found] = start + i
            found += 1 if abs(residual[i]) <= T else 0
    return found


@device
def mark_members(rows: Rows, theta: FloatArray, T: float, residual: FloatArray, inlier: BoolArray) -> int:
    """Flag the points with |residual| <= T; return their number."""
    n = rows.y.size
    found = 0
    for start in range(0, n, CHUNK):
        size = min(CHUNK, n - start)
        fill_residuals(rows, theta, start, size, residual)
        for i in range(size):
            inside = abs(residual[i]) <= T
            inlier[start + i] = inside
            found += 1 if inside else 0
    return found
