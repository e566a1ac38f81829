"""Starts for a standing receiver from minimal subsets of satellites, as RANSAC draws them.

Where half of the satellites lie in every epoch, no single epoch prefers the right place to any other that as
many satellites meet in exactly; all epochs together do, if only one of them proposes it.
"""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np

from estimators.arrays import FloatArray
from estimators.gnss.series.snapshots import score_at
from estimators.gnss.snapshot.problem import solve_problem
from estimators.gnss.table import EpochTable

_PROPOSERS = 2
_MOST_SUBSETS = 150
_KEPT = 8
_APART_M = 30.0
"""Places closer than this climb to the same top."""
_FORGIVING_SCALE = 3.0
"""Minimal subsets place a receiver a few times less well than all its satellites."""
_SEED = 20140923


def starts_of_subsets(table: EpochTable, fault_prior: float) -> list[FloatArray]:
    """Places that minimal subsets of an epoch or two give, those that all epochs like best.

    Parameters
    ----------
    table : EpochTable
    fault_prior : float

    Returns
    -------
    list of ndarray, shape (3,)
    """
    sizes = np.diff(table.offsets)
    proposers = np.argsort(-sizes, kind="stable")[:_PROPOSERS]
    scored: list[tuple[float, FloatArray]] = []
    for k in proposers:
        epoch = table.epoch(int(k))
        n, p = int(sizes[k]), 3 + len(epoch.letters[0])
        for rows in _subsets(n, p):
            used = np.zeros(n, dtype=np.bool_)
            used[list(rows)] = True
            problem = solve_problem(epoch, used)
            if problem is not None:
                place = np.ascontiguousarray(problem.state[:3])
                likes = score_at(table, place, _FORGIVING_SCALE, fault_prior).likelihood.sum()
                scored.append((float(likes), place))
    scored.sort(key=lambda pair: -pair[0])
    kept: list[FloatArray] = []
    for _, place in scored:
        if len(kept) < _KEPT and all(np.linalg.norm(place - other) > _APART_M for other in kept):
            kept.append(place)
    return kept


def _subsets(n: int, p: int) -> list[tuple[int, ...]]:
    """All subsets, or as many of them drawn as time allows."""
    if n < p:
        return []
    if math.comb(n, p) <= _MOST_SUBSETS:
        return list(combinations(range(n), p))
    rng = np.random.default_rng(_SEED)
    return [tuple(rng.choice(n, p, replace=False).tolist()) for _ in range(_MOST_SUBSETS)]
