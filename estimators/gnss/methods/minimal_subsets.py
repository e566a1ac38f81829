"""Positions from as few satellites as determine them, and who among the others agrees.

A subset s of p = 3 + n_sys satellites gives the state A_s^-1 z_s with covariance P_s = (A_s' A_s)^-1. The
residual of a satellite outside, z_j - a_j' x_s, has the variance 1 + a_j' P_s a_j in units of its own noise:
the subset's uncertainty belongs in the threshold (METHODS 11.2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.randomness import SAMPLES, draw_distinct, random_key
from estimators.gnss.snapshot.problem import Problem
from estimators.kernels import device, kernel, ro

MOST_ENUMERATED = 50_000
"""C(32, 4) is 35,960; beyond, subsets are sampled."""
SAMPLED = 2_000
"""With eight of 32 satellites faulty and four clocks, one subset of seven in ten is healthy: C(24, 7) /
C(32, 7) = 0.10."""
_SINGULAR = 1e-9


@dataclass(frozen=True, slots=True)
class JudgedSubsets:
    """Minimal subsets and what the other satellites say to them; refused ones are left out.

    Attributes
    ----------
    members : ndarray of int64, shape (m, p)
    agrees : ndarray of bool, shape (m, n)
        Satellites within the threshold, the subset's own included.
    agreeing : ndarray of int64, shape (m,)
        How many these are.
    cost : ndarray, shape (m,)
        Sum of the agreeing satellites' squared residuals, each in its own variance.
    pdop : ndarray, shape (m,)
        Position dilution of precision of the subset.
    wdop : ndarray, shape (m,)
        The same weighted: standard deviation of the position in metres.
    drawn, singular : int
    exhaustive : bool
    """

    members: IntArray
    agrees: BoolArray
    agreeing: IntArray
    cost: FloatArray
    pdop: FloatArray
    wdop: FloatArray
    drawn: int
    singular: int
    exhaustive: bool


def judge_subsets(problem: Problem, kappa: float) -> JudgedSubsets:
    """Solve every minimal subset, or a fixed sample of them, and count who agrees.

    Parameters
    ----------
    problem : Problem
    kappa : float
        Threshold in standard deviations.
    """
    n, p = problem.A.shape
    total = math.comb(n, p)
    exhaustive = total <= MOST_ENUMERATED
    members = all_subsets(n, p) if exhaustive else _sampled_subsets(n, p)
    agrees = np.zeros((members.shape[0], n), dtype=np.bool_)
    agreeing = np.empty(members.shape[0], dtype=np.int64)
    cost, pdop, wdop = np.empty(agreeing.size), np.empty(agreeing.size), np.empty(agreeing.size)
    _judge(problem.A, problem.z, problem.table.sigma_m, members, kappa, agrees, agreeing, cost, pdop, wdop)
    solved = agreeing >= 0
    return JudgedSubsets(
        members[solved],
        agrees[solved],
        agreeing[solved],
        cost[solved],
        pdop[solved],
        wdop[solved],
        members.shape[0],
        int(np.sum(~solved)),
        exhaustive,
    )


def all_subsets(n: int, size: int) -> IntArray:
    """All subsets of a size, in lexicographic order.

    Parameters
    ----------
    n, size : int

    Returns
    -------
    ndarray of int64, shape (C(n, size), size)

    Examples
    --------
    >>> all_subsets(3, 2).tolist()
    [[0, 1], [0, 2], [1, 2]]
    """
    members = np.empty((math.comb(n, size), size), dtype=np.int64)
    _fill_all(n, members)
    return members


def _sampled_subsets(n: int, size: int) -> IntArray:
    members = np.empty((SAMPLED, size), dtype=np.int64)
    _fill_sample(n, members)
    return members


@kernel(types.void(types.int64, types.int64[:, ::1]))
def _fill_all(n: int, members: IntArray) -> None:
    p = members.shape[1]
    current = np.arange(p)
    for row in range(members.shape[0]):
        for k in range(p):
            members[row, k] = current[k]
        k = p - 1
        while k >= 0 and current[k] == n - p + k:
            k -= 1
        if k < 0:
            break
        current[k] += 1
        for j in range(k + 1, p):
            current[j] = current[j - 1] + 1


@kernel(types.void(types.int64, types.int64[:, ::1]))
def _fill_sample(n: int, members: IntArray) -> None:
    """Uniform random subsets, the same for every epoch of n satellites."""
    for row in range(members.shape[0]):
        draw_distinct(random_key(0, SAMPLES, row), n, members.shape[1], members[row])


@device
def _invert(matrix: FloatArray, inverse: FloatArray) -> bool:
    """Gauss-Jordan elimination with row pivoting; False where the matrix is singular."""
    p = matrix.shape[0]
    largest = 0.0
    for r in range(p):
        for c in range(p):
            largest = max(largest, abs(matrix[r, c]))
            inverse[r, c] = 1.0 if r == c else 0.0
    for c in range(p):
        pivot = c
        for r in range(c + 1, p):
            if abs(matrix[r, c]) > abs(matrix[pivot, c]):
                pivot = r
        if not abs(matrix[pivot, c]) > _SINGULAR * largest:
            return False
        for k in range(p):
            matrix[c, k], matrix[pivot, k] = matrix[pivot, k], matrix[c, k]
            inverse[c, k], inverse[pivot, k] = inverse[pivot, k], inverse[c, k]
        scale = 1.0 / matrix[c, c]
        for k in range(p):
            matrix[c, k] *= scale
            inverse[c, k] *= scale
        for r in range(p):
            factor = matrix[r, c]
            if r != c and factor != 0.0:
                for k in range(p):
                    matrix[r, k] -= factor * matrix[c, k]
                    inverse[r, k] -= factor * inverse[c, k]
    return True


@kernel(
    types.void(
        ro(types.float64, 2),
        ro(types.float64),
        ro(types.float64),
        ro(types.int64, 2),
        types.float64,
        types.boolean[:, ::1],
        types.int64[::1],
        types.float64[::1],
        types.float64[::1],
        types.float64[::1],
    )
)
def _judge(
    A: FloatArray,
    z: FloatArray,
    sigma: FloatArray,
    members: IntArray,
    kappa: float,
    agrees: BoolArray,
    agreeing: IntArray,
    cost: FloatArray,
    pdop: FloatArray,
    wdop: FloatArray,
) -> None:
    """Fill the numbers of each subset; -1 agreeing where it determines no position."""
    n, p = A.shape
    matrix, inverse = np.empty((p, p)), np.empty((p, p))
    state = np.empty(p)
    inside = np.zeros(n, np.bool_)
    for row in range(members.shape[0]):
        for k in range(p):
            for j in range(p):
                matrix[k, j] = A[members[row, k], j]
        if not _invert(matrix, inverse):
            agreeing[row] = -1
            continue
        plain, weighted = 0.0, 0.0
        for k in range(p):
            i = members[row, k]
            inside[i] = True
            for axis in range(3):
                plain += (inverse[axis, k] / sigma[i]) ** 2
                weighted += inverse[axis, k] ** 2
        pdop[row], wdop[row] = math.sqrt(plain), math.sqrt(weighted)
        for j in range(p):
            state[j] = 0.0
            for k in range(p):
                state[j] += inverse[j, k] * z[members[row, k]]
        count, total = p, 0.0
        for i in range(n):
            if inside[i]:
                inside[i] = False
                agrees[row, i] = True
                continue
            residual, variance = z[i], 1.0
            for j in range(p):
                residual -= A[i, j] * state[j]
            for k in range(p):
                held = 0.0
                for j in range(p):
                    held += A[i, j] * inverse[j, k]
                variance += held * held
            squared = residual * residual / variance
            if squared <= kappa * kappa:
                count += 1
                agrees[row, i] = True
                total += squared
        agreeing[row], cost[row] = count, total
