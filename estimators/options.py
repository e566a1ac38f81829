"""RobustOptions: everything that is not data and not an argument of its own."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from estimators.arrays import InputError


@dataclass(frozen=True, slots=True)
class RobustOptions:
    """Settings of the search; the defaults serve every preset.

    Attributes
    ----------
    confidence : float
        Wanted probability of at least one all-inlier sample (default 0.99; METHODS.md 2.2).
    max_hypotheses : int
        Upper bound on minimal samples drawn (default 10 000).
    min_hypotheses : int
        Lower bound, on all paths (default 64): a clean pair is not yet a good model (METHODS.md 2.2).
    work_budget : int
        Enumerate all minimal samples when C(n, s) * n residual evaluations fit in it (default 2e5).
    threshold_sigmas : float
        Inlier threshold in noise scales where no threshold is given (default 2.7, 99.3 % of a normal
        population; METHODS_TRENDS: labels).
    acceptable_inliers : int or None
        Consensus that ``fischler-bolles`` accepts and stops at; default: half of the points, at least 7
        (METHODS.md 2.1: "t >= 7" for a line).
    correct_serial_correlation : bool
        Widen intervals by the effective sample size (default True; METHODS.md 12).
    resamples : int
        Series that ``uncertainty="bootstrap"`` and ``"permutation"`` fit again (default 400: a p-value of
        0.05 is then true to 0.01).

    Raises
    ------
    InputError
        If a value is out of its range.
    """

    confidence: float = 0.99
    max_hypotheses: int = 10_000
    min_hypotheses: int = 64
    work_budget: int = 200_000
    threshold_sigmas: float = 2.7
    acceptable_inliers: int | None = None
    correct_serial_correlation: bool = True
    resamples: int = 400

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if isinstance(value, float) and not math.isfinite(value):
                raise InputError(item.name, "must be a finite number")
        if not 0 < self.confidence < 1:
            raise InputError("confidence", "must lie between 0 and 1, both excluded")
        if not 1 <= self.max_hypotheses <= 10_000_000:
            raise InputError("max_hypotheses", "must lie between 1 and 10 000 000")
        if not 1 <= self.min_hypotheses <= self.max_hypotheses:
            raise InputError("min_hypotheses", "must lie between 1 and max_hypotheses")
        if not 0 <= self.work_budget <= 10**10:
            raise InputError("work_budget", "must lie between 0 and 1e10")
        if not 1 <= self.threshold_sigmas <= 10:
            raise InputError("threshold_sigmas", "must lie between 1 and 10")
        if self.acceptable_inliers is not None and self.acceptable_inliers < 3:
            raise InputError("acceptable_inliers", "must be at least 3")
        if not 99 <= self.resamples <= 10_000:
            raise InputError("resamples", "must lie between 99 and 10 000")
