"""Method ``greedy``: the satellite whose exclusion leaves the least sum of squares, until the rest passes.

The greedy residual method of Blanch, Walter and Enge 2015, "Fast multiple fault exclusion with a large number
of measurements" (ION ITM): cost grows with the number of faults, not with the number of fault sets. Excluding
i lowers the sum of squares by z_i^2 / S_ii. Unlike ``raim`` it asks no w-test: an epoch that fails the
chi-square test loses satellites until it passes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.gnss.methods.one_by_one import Standing, exclude_one_by_one
from estimators.gnss.methods.protocol import Verdict
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.problem import Problem


@dataclass(frozen=True, slots=True)
class Greedy:
    """Steepest descent of the sum of squares."""

    def judge(self, problem: Problem, options: PositionOptions) -> Verdict:
        """Exclude satellites until the chi-square test passes or redundancy ends."""

        def steepest(standing: Standing) -> int | None:
            row = int(np.argmax(standing.w))
            return row if standing.w[row] > 0.0 else None

        return exclude_one_by_one(problem, options.false_alarm, steepest)
