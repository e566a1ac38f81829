"""Method ``raim``: receiver autonomous integrity monitoring by least-squares residuals.

The sum of squared residuals is chi-square distributed with n - p degrees of freedom (Parkinson and Axelrad
1988, "Autonomous GPS integrity monitoring using the pseudorange residual", Navigation 35). Where it fails,
the satellite of the largest w-test statistic is excluded if that passes the limit N^-1(1 - Pfa / 2n)
(Baarda 1968, "A testing procedure for use in geodetic networks"), and so on while n - p >= 2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from estimators.gnss.methods.one_by_one import Standing, exclude_one_by_one
from estimators.gnss.methods.protocol import Verdict
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.problem import Problem


@dataclass(frozen=True, slots=True)
class Raim:
    """Chi-square test, then w-tests, one satellite at a time."""

    def judge(self, problem: Problem, options: PositionOptions) -> Verdict:
        """Exclude satellites that both tests accuse."""

        def most_significant(standing: Standing) -> int | None:
            row = int(np.argmax(standing.w))
            present = int(np.sum(~standing.excluded))
            return row if standing.w[row] > -float(ndtri(options.false_alarm / (2 * present))) else None

        return exclude_one_by_one(problem, options.false_alarm, most_significant)
