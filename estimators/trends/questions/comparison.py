"""Whether two trends differ: Welch's test of two slopes with uncertainties of their own.

The degrees of freedom are Satterthwaite's (1946, "An approximate distribution of estimates of variance
components"): (a + b)^2 / (a^2 / m + b^2 / n), a and b the squared standard errors with m and n degrees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from estimators.arrays import InputError
from estimators.inference.intervals import student_quantile, two_sided_p
from estimators.result import Estimate

if TYPE_CHECKING:
    from estimators.trends.trend import Trend


@dataclass(frozen=True, slots=True)
class Difference:
    """Slope of one trend less that of another.

    Attributes
    ----------
    slope : Estimate
        Per unit of time (per second for points in time).
    p_value : float or None
        Of "the slopes are equal", for trends of different data; None where an uncertainty is unknown.
    dof : float or None
        Degrees of freedom of Student's t.
    level : float
        Confidence level of the interval.
    """

    slope: Estimate
    p_value: float | None
    dof: float | None
    level: float

    @property
    def is_significant(self) -> bool:
        """Whether the interval leaves out 0."""
        return self.p_value is not None and self.p_value < 1.0 - self.level

    def to_dict(self) -> dict[str, Any]:
        """JSON-safe form."""
        slope = self.slope
        return {
            "slope": {"value": slope.value, "stderr": slope.stderr, "low": slope.low, "high": slope.high},
            "p_value": self.p_value,
            "dof": self.dof if self.dof is None or math.isfinite(self.dof) else None,
            "level": self.level,
        }


def differs_from(one: Trend, other: Any, level: float | None) -> Difference:
    """Answer :meth:`estimators.Trend.differs_from`."""
    wanted = one.uncertainty.level if level is None else float(level)
    if not 0 < wanted < 1:
        raise InputError("level", "must lie between 0 and 1, both excluded")
    slopes = [getattr(trend, "parameters", {}).get("slope") for trend in (one, other)]
    if slopes[0] is None:
        raise InputError("model", f"a trend of model {one.model} has no slope to compare")
    if slopes[1] is None:
        raise InputError("other", "must be a Trend with a slope")
    if one.axis.kind != other.axis.kind:
        raise InputError("other", "has times of another kind; both must be numbers or points in time")
    mine: Estimate = slopes[0]
    theirs: Estimate = slopes[1]
    apart = mine.value - theirs.value
    dof = _degrees(mine.stderr, one.uncertainty.dof, theirs.stderr, other.uncertainty.dof)
    if dof is None or mine.stderr is None or theirs.stderr is None:
        return Difference(Estimate(apart, None, None, None), None, None, wanted)
    stderr = math.hypot(mine.stderr, theirs.stderr)
    half = student_quantile(wanted, dof) * stderr
    statistic = apart / stderr if stderr > 0.0 else math.copysign(math.inf, apart) if apart else 0.0
    slope = Estimate(apart, stderr, apart - half, apart + half)
    return Difference(slope, two_sided_p(statistic, dof), dof, wanted)


def _degrees(
    stderr: float | None, dof: float | None, other_stderr: float | None, other_dof: float | None
) -> float | None:
    """Satterthwaite's degrees of freedom; None where an uncertainty is unknown."""
    if stderr is None or dof is None or other_stderr is None or other_dof is None:
        return None
    total = math.hypot(stderr, other_stderr)
    if total == 0.0:
        return min(dof, other_dof)
    # Shares of the variance instead of the variances: these may underflow.
    one, two = (stderr / total) ** 2, (other_stderr / total) ** 2
    inverse = one * one / dof + two * two / other_dof
    return 1.0 / inverse if inverse > 0.0 else math.inf
