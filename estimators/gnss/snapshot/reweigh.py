r"""The position of satellites that agree, but not equally well: Huber's weights and his scale, together.

Satellites that nobody would call faulty still err by more than their messages say now and then: a clock that
is metres off, a group delay, a reflection. Least squares divides such an error among all. Here

    sum_i psi(r_i / s) a_i = 0,   sum_i psi(r_i / s)^2 = beta (n - p),   psi(u) = max(-k, min(k, u)),

are solved together for the state and the scale s (Huber 1964, "Robust estimation of a location parameter",
Annals of Mathematical Statistics 35, Proposal 2; Huber 1981, "Robust Statistics", 7.7 and 7.8: the problem is
convex, and weights and scale in turns reach its solution). Beta is E psi^2 under Gaussian noise. The scale is
that of the epoch itself, so nothing depends on whether sigmas are stated too large. Fewer than three
redundant satellites cannot tell which of them errs, and their answer is that of least squares.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import BoolArray, FloatArray
from estimators.gnss.snapshot.linearise import factorise, fill_normal, solve_factorised
from estimators.kernels import device

TUNING = 1.345
"""Residual in units of the scale from which on a range counts less: 95 % of the efficiency of least squares
under Gaussian noise (Huber 1981, 4.2 and 7.7)."""
_DENSITY = math.exp(-0.5 * TUNING**2) / math.sqrt(2.0 * math.pi)
_INSIDE = math.erf(TUNING / math.sqrt(2.0))
_BETA = _INSIDE - 2.0 * TUNING * _DENSITY + TUNING**2 * (1.0 - _INSIDE)
"""E psi(u)^2 of a standard normal u."""
_LEAST = 1e-12
"""Squared residual below which nothing counts less: no range is known to a millionth of its noise."""
_MOST_STEPS = 200
_CONVERGED_M = 1e-6


@device
def reweigh(A: FloatArray, z: FloatArray, used: BoolArray, state: FloatArray, weight: FloatArray) -> None:
    """Move a state from the least-squares solution over the used rows to that of Huber's weights.

    The move is linear in the design at hand: its error, move^2 / (2 rho), is a micrometre for ten metres.

    Parameters
    ----------
    A, z : ndarray, shape (n, p) and (n,)
        Whitened design and residuals at ``state``.
    used : ndarray of bool, shape (n,)
    state : ndarray, shape (p,)
        In and out.
    weight : ndarray, shape (n,)
        Out: what a range counts, 1 where it agrees with the others and 0 where it is not used.
    """
    n, p = A.shape
    count, squares, largest = 0, 0.0, 0.0
    for i in range(n):
        weight[i] = 1.0 if used[i] else 0.0
        if used[i]:
            count += 1
            squares += z[i] * z[i]
            largest = max(largest, z[i] * z[i])
    share = _BETA * (count - p)
    if count <= p or largest * share <= TUNING**2 * squares:
        return
    scaled, target, residual = np.empty((n, p)), np.empty(n), z.copy()
    factor, move, before = np.empty((p, p)), np.zeros(p), np.empty(p)
    limit = TUNING**2 * squares / share
    for _ in range(_MOST_STEPS):
        held = 0.0
        for i in range(n):
            if used[i]:
                held += min(residual[i] * residual[i], limit)
        limit = max(TUNING**2 * held / share, _LEAST)
        for i in range(n):
            if used[i]:
                square = residual[i] * residual[i]
                weight[i] = math.sqrt(limit / square) if square > limit else 1.0
            root = math.sqrt(weight[i])
            target[i] = root * z[i]
            for j in range(p):
                scaled[i, j] = root * A[i, j]
        for j in range(p):
            before[j] = move[j]
        fill_normal(scaled, target, used, factor, move)
        if not factorise(factor):
            for i in range(n):
                weight[i] = 1.0 if used[i] else 0.0
            return
        solve_factorised(factor, move)
        changed = 0.0
        for j in range(p):
            changed = max(changed, abs(move[j] - before[j]))
        for i in range(n):
            residual[i] = z[i]
            for j in range(p):
                residual[i] -= A[i, j] * move[j]
        if changed < _CONVERGED_M:
            break
    for j in range(p):
        state[j] += move[j]
