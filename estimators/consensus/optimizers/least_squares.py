"""One iterated least squares on the consensus set: LO' of Lebeda, Matas & Chum (2012; METHODS.md 6.2)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from estimators.consensus.optimizers.plan import Plan


@dataclass(frozen=True, slots=True)
class LeastSquares:
    """Least squares on the inliers, repeated while the threshold shrinks.

    Attributes
    ----------
    steps : int
        Least-squares steps (default 4, as in LO+).
    multiplier : float
        First threshold over the last (default sqrt(2), as in LO+).
    """

    steps: int = 4
    multiplier: float = math.sqrt(2.0)

    def plan(self, sample_size: int) -> Plan:
        """Only the finish."""
        del sample_size
        return Plan(0, 0, 0, self.steps, self.multiplier, 1)
