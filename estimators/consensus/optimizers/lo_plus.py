"""LO+: local optimisation whose least squares see few points (Lebeda, Matas & Chum 2012; METHODS.md 6.2).

The inner steps fit at most 7 s points, so that their cost does not grow with the data; one iterated least
squares over all inliers ends the run. The search calls it at the ends of blocks of 64 hypotheses, which
takes the place of the authors' start after 50.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from estimators.consensus.optimizers.plan import Plan


@dataclass(frozen=True, slots=True)
class LoPlus:
    """Ten inner samples, bounded least squares with a shrinking threshold, one full finish.

    Attributes
    ----------
    repetitions : int
        Inner samples (default 10).
    multiple : int
        Most points per inner least squares, in sample sizes (default 7).
    steps : int
        Least-squares steps (default 4).
    multiplier : float
        First threshold over the last (default sqrt(2)).
    """

    repetitions: int = 10
    multiple: int = 7
    steps: int = 4
    multiplier: float = math.sqrt(2.0)

    def plan(self, sample_size: int) -> Plan:
        """Inner samples and steps are bounded by ``multiple`` sample sizes."""
        most = self.multiple * sample_size
        return Plan(self.repetitions, most, most, self.steps, self.multiplier, 1)
