"""Method ``p-ransac``: consensus of the satellites outside minimal subsets, in the style of P-RANSAC.

Castaldo, Angrisano, Gaglione and Troisi 2014, "P-RANSAC: An integrity monitoring approach for GNSS signal
degraded scenario" (International Journal of Navigation and Observation 173818): positions from minimal
subsets are compared with the ranges outside. Here the threshold holds the subset's own covariance, subsets of
poor geometry are refused, the largest consensus wins whose least-squares residuals pass the chi-square test,
and ties go to the least weighted cost (METHODS 11.2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from estimators.arrays import BoolArray
from estimators.gnss.methods.minimal_subsets import judge_subsets
from estimators.gnss.methods.protocol import Verdict
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.problem import Problem
from estimators.result import Ledger


@dataclass(frozen=True, slots=True)
class PRansac:
    """Largest consensus over minimal subsets.

    Attributes
    ----------
    largest_pdop : float
        Subsets of worse geometry are refused; a dilution above 20 is customarily called poor.
    """

    largest_pdop: float = 20.0

    def judge(self, problem: Problem, options: PositionOptions) -> Verdict:
        """Leave out whoever does not agree with the subset that most satellites agree with.

        Where no consensus of more satellites than a minimal subset's passes the test, nothing is left out.
        """
        n, p = problem.A.shape
        subsets = judge_subsets(problem, options.threshold_sigmas)
        allowed = np.flatnonzero((subsets.pdop <= self.largest_pdop) & (subsets.agreeing > p))
        excluded = np.zeros(n, dtype=np.bool_)
        fitted: set[bytes] = set()
        for row in allowed[np.lexsort((subsets.cost[allowed], -subsets.agreeing[allowed]))]:
            agrees = subsets.agrees[row]
            if agrees.tobytes() in fitted:
                continue
            fitted.add(agrees.tobytes())
            limit = float(chdtri(int(agrees.sum()) - p, options.false_alarm))
            if _squares_without(problem, ~agrees) <= limit:
                excluded = ~agrees
                break
        ledger = Ledger(
            drawn=subsets.drawn,
            degenerate=subsets.singular,
            invalid=subsets.members.shape[0] - allowed.size,
            scored=allowed.size,
            point_evaluations=subsets.members.shape[0] * (n - p),
            optimizations=len(fitted),
        )
        return Verdict(excluded, "exhaustive" if subsets.exhaustive else "sampled", ledger)


def _squares_without(problem: Problem, left_out: BoolArray) -> float:
    """Sum of squares that least squares over the others leaves: SSE - z_F' S_FF^-1 z_F."""
    rows = np.flatnonzero(left_out)
    z = problem.z[rows]
    return float(problem.z @ problem.z - z @ np.linalg.solve(problem.S[np.ix_(rows, rows)], z))
