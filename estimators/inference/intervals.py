"""Quantiles and intervals of Student's t."""

from __future__ import annotations

import math

from scipy.special import ndtri, stdtr, stdtrit


def student_quantile(level: float, dof: float | None) -> float:
    """Two-sided quantile: a central share ``level`` of Student's t lies within ± it.

    Parameters
    ----------
    level : float
        Between 0 and 1.
    dof : float or None
        Degrees of freedom; infinity is the normal law, None gives NaN.

    Returns
    -------
    float

    Examples
    --------
    >>> round(student_quantile(0.95, 10.0), 4)
    2.2281
    """
    if dof is None:
        return math.nan
    upper = 0.5 * (1.0 + level)
    if math.isinf(dof):
        return float(ndtri(upper))
    return float(stdtrit(dof, upper))


def two_sided_p(statistic: float, dof: float | None) -> float | None:
    """Probability of a |t| as large as this if the truth is zero; None without degrees of freedom."""
    if dof is None or math.isnan(statistic):
        return None
    return float(2.0 * stdtr(dof, -abs(statistic)))
