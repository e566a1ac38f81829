"""LO-RANSAC: an inner RANSAC over the inliers of a new best model (Chum, Matas & Kittler 2003).

Steps and constants as METHODS.md 6.1 has them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from estimators.consensus.optimizers.plan import Plan


@dataclass(frozen=True, slots=True)
class LoRansac:
    """Ten non-minimal samples, each followed by least squares on all its inliers with a shrinking threshold.

    Attributes
    ----------
    repetitions : int
        Inner samples (default 10).
    sample : int
        Largest inner sample, bounded by half of the inliers (default 14).
    steps : int
        Least-squares steps per repetition (default 4, as in USAC).
    multiplier : float
        First threshold over the last (default sqrt(2): USAC's 2.0 on the squared error).
    """

    repetitions: int = 10
    sample: int = 14
    steps: int = 4
    multiplier: float = math.sqrt(2.0)

    def plan(self, sample_size: int) -> Plan:
        """All inliers take part in every step."""
        sample = max(self.sample, sample_size + 1)
        return Plan(self.repetitions, sample, 0, self.steps, self.multiplier, 0)
