"""Weights of fault sets by dense algebra, to compare the compiled search with."""

from __future__ import annotations

import math

import numpy as np

from estimators.gnss.snapshot.fault_sets import CAPACITY, weigh_fault_sets
from estimators.gnss.snapshot.fault_weight import BIASES_M, LARGEST_SET, SEEN
from estimators.gnss.snapshot.problem import Problem
from estimators.gnss.snapshot.solved import SCALE_RATE, SCALE_SHAPE

PRIOR = 0.1


def log_prior(n: int, k: int) -> float:
    """Beta-binomial probability of one set, relative to the empty one."""
    a, b = SEEN * PRIOR, SEEN * (1.0 - PRIOR)
    return math.lgamma(a + k) + math.lgamma(b + n - k) - math.lgamma(a) - math.lgamma(b + n)


def weight_of(problem: Problem, members: tuple[int, ...]) -> float:
    """ln w_F by dense algebra, for sets of any size."""
    n, rows = problem.used.size, list(members)
    sigma, z = problem.table.sigma_m[rows], problem.z[rows]
    terms = []
    for bias in BIASES_M:
        spread = problem.S[np.ix_(rows, rows)] + np.diag((sigma / bias) ** 2)
        left = problem.squares - (z @ np.linalg.solve(spread, z) if rows else 0.0)
        terms.append(
            -0.5 * np.linalg.slogdet(spread)[1]
            - np.sum(np.log(bias / sigma))
            - (SCALE_SHAPE + 0.5 * problem.freedom) * math.log1p(0.5 * left / SCALE_RATE)
        )
    return log_prior(n, len(rows)) + float(np.logaddexp.reduce(terms)) - math.log(BIASES_M.size)


def weighed(problem: Problem, limit: float = 0.0) -> dict[tuple[int, ...], float]:
    """Sets that the search finds and their ln weights; ``limit`` as for the search."""
    members = np.empty((CAPACITY, LARGEST_SET), np.int64)
    sizes, weights = np.empty(CAPACITY, np.int64), np.empty(CAPACITY)
    found = weigh_fault_sets(
        problem.A, problem.S, problem.z, problem.table.sigma_m, problem.table.clock,
        np.argsort(problem.table.pseudoranges_m), problem.freedom, limit, PRIOR, SCALE_SHAPE, SCALE_RATE,
        members, sizes, weights,
    )  # fmt: skip
    return {tuple(members[k, : sizes[k]].tolist()): float(weights[k]) for k in range(found)}
