"""Method ``huber``: iteratively reweighted least squares by Huber's loss, which weighs instead of excluding.

Minimises sum rho(r_i / sigma_i), rho quadratic up to k and linear beyond: weights w = min(1, k / |u|) on the
squared residuals u = r / sigma (Huber 1964, "Robust estimation of a location parameter", Annals of
Mathematical Statistics 35). Each step solves the ranges themselves, not their linearisation.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from estimators.gnss.methods.protocol import Verdict
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.problem import Problem, solve_problem
from estimators.gnss.snapshot.reweigh import TUNING
from estimators.result import Ledger

_STEPS = 200
_SETTLED = 1e-9


@dataclass(frozen=True, slots=True)
class Huber:
    """Huber weights at the sigmas as given.

    Attributes
    ----------
    tuning : float
        Residual in sigmas where the loss turns linear.
    """

    tuning: float = TUNING

    def judge(self, problem: Problem, options: PositionOptions) -> Verdict:  # noqa: ARG002  # asks nothing
        """Weigh the satellites; ``inflation`` is the square root of what is taken off each weight."""
        table = problem.table
        inflation = np.ones(problem.used.size)
        steps = 0
        while steps < _STEPS:
            steps += 1
            solved = solve_problem(dataclasses.replace(table, sigma_m=table.sigma_m * inflation))
            if solved is None:
                break
            before = inflation
            # The solver whitens by the inflated sigmas.
            inflation = np.sqrt(np.maximum(1.0, np.abs(solved.z * before) / self.tuning))
            if float(np.max(np.abs(inflation / before - 1.0))) < _SETTLED:
                break
        ledger = Ledger(optimizations=1, scored=steps, point_evaluations=steps * problem.used.size)
        return Verdict(np.zeros(problem.used.size, dtype=np.bool_), "closed", ledger, inflation)
