"""Method ``ranco``: range consensus over few good subsets, for a bounded number of faults.

Schroth, Rippl, Ene, Blanch, Walter and Enge 2008, "Enhancements of the range consensus algorithm (RANCO)"
(ION GNSS): subsets are ranked by their weighted dilution of precision, and only as many of the best are
solved as leave, whichever satellites fail up to the bound, one subset without a failed one. The subset with
the fewest satellites outside its threshold wins; these are the faulty ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import types

from estimators.arrays import BoolArray, IntArray
from estimators.gnss.methods.minimal_subsets import (
    MOST_ENUMERATED,
    all_subsets,
    judge_subsets,
)
from estimators.gnss.methods.protocol import Verdict
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.problem import Problem
from estimators.kernels import kernel, ro
from estimators.result import Ledger


@dataclass(frozen=True, slots=True)
class Ranco:
    """Range consensus, bounded by ``options.most_faults``."""

    def judge(self, problem: Problem, options: PositionOptions) -> Verdict:
        """Leave out the satellites outside the best subset's threshold, if these are few enough."""
        n, p = problem.A.shape
        excluded = np.zeros(n, dtype=np.bool_)
        # One satellite outside the subset has to agree with it.
        bound = min(options.most_faults, n - p - 1)
        if bound < 1:
            return Verdict(excluded, "closed")
        while math.comb(n, bound) > MOST_ENUMERATED:
            bound -= 1
        subsets = judge_subsets(problem, options.threshold_sigmas)
        ranked = np.argsort(subsets.wdop, kind="stable")
        chosen = ranked[cover_faults(n, bound, subsets.members[ranked])]
        ledger = Ledger(
            drawn=subsets.drawn,
            degenerate=subsets.singular,
            scored=chosen.size,
            point_evaluations=subsets.members.shape[0] * (n - p),
        )
        if chosen.size > 0:
            # The first of those with the most satellites inside is the best ranked.
            best = chosen[np.argmax(subsets.agreeing[chosen])]
            if n - subsets.agreeing[best] <= bound:
                excluded = ~subsets.agrees[best]
        return Verdict(excluded, "exhaustive" if subsets.exhaustive else "sampled", ledger)


def cover_faults(n: int, faults: int, ranked: IntArray) -> IntArray:
    """Choose subsets, the first ranked ones, of which one is healthy whoever fails.

    Parameters
    ----------
    n : int
        Satellites.
    faults : int
        Largest number of them that fail.
    ranked : ndarray of int64, shape (m, p)
        Members of the subsets, the best first.

    Returns
    -------
    ndarray of int64
        Rows of ``ranked``: each avoids a set of failures that none before it avoids.

    Examples
    --------
    >>> cover_faults(4, 1, np.array([[0, 1], [0, 2], [2, 3], [1, 3]])).tolist()
    [0, 1, 2]
    """
    useful = np.zeros(ranked.shape[0], dtype=np.bool_)
    _cover(all_subsets(n, faults), n, np.ascontiguousarray(ranked), useful)
    return np.flatnonzero(useful).astype(np.int64)


@kernel(types.void(types.int64[:, ::1], types.int64, ro(types.int64, 2), types.boolean[::1]))
def _cover(failures: IntArray, n: int, ranked: IntArray, useful: BoolArray) -> None:
    """Strike out the failures that each subset avoids, until none is left; ``failures`` is used up."""
    left, faults = failures.shape
    inside = np.zeros(n, np.bool_)
    for row in range(ranked.shape[0]):
        if left == 0:
            break
        inside[:] = False
        for k in range(ranked.shape[1]):
            inside[ranked[row, k]] = True
        kept = 0
        for f in range(left):
            avoided = True
            for k in range(faults):
                avoided = avoided and not inside[failures[f, k]]
            if not avoided:
                for k in range(faults):
                    failures[kept, k] = failures[f, k]
                kept += 1
        useful[row] = kept < left
        left = kept
