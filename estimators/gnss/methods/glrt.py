"""Method ``glrt``: generalised likelihood ratio test over all sets of faulty satellites.

The likelihood of a fault set, maximised over position, clocks and biases, decreases with the sum of squares
that the other satellites leave: SSE - z_F' S_FF^-1 z_F (METHODS_GNSS, "Identities worth having"). Of each
size the likeliest set is found, and the smallest size is taken whose rest passes the chi-square test; where
none passes, the set that comes nearest to its limit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from estimators.gnss.methods.protocol import Verdict
from estimators.gnss.methods.subset_search import find_smallest_passing
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.fault_weight import LARGEST_SET
from estimators.gnss.snapshot.problem import Problem
from estimators.result import Ledger


@dataclass(frozen=True, slots=True)
class Glrt:
    """Smallest likely fault set that passes chi square, one redundant satellite left to test it."""

    def judge(self, problem: Problem, options: PositionOptions) -> Verdict:
        """Search the fault sets, smallest first."""
        n = problem.used.size
        freedom = n - problem.state.size
        excluded = np.zeros(n, dtype=np.bool_)
        if freedom < 1:
            return Verdict(excluded, "exhaustive")
        most = min(freedom - 1, LARGEST_SET)
        limits = np.asarray(chdtri(freedom - np.arange(most + 1), options.false_alarm), dtype=np.float64)
        chosen, counts = np.empty(LARGEST_SET, dtype=np.int64), np.empty(2, dtype=np.int64)
        size = find_smallest_passing(problem.S, problem.z, most, limits, chosen, counts)
        excluded[chosen[:size]] = True
        sets, whole = counts.tolist()
        return Verdict(excluded, "exhaustive" if whole else "closed", Ledger(scored=sets))
