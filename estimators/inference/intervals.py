"""Quantiles and intervals of Student's t."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import ndtri, stdtr, stdtrit

from estimators.arrays import FloatArray


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


def student_quantiles(level: float, dof: FloatArray) -> FloatArray:
    """Quantiles of :func:`student_quantile` for many degrees of freedom, the same to the bit.

    Parameters
    ----------
    level : float
        Between 0 and 1.
    dof : ndarray of float64, shape (m,)
        NaN gives NaN.

    Returns
    -------
    ndarray of float64, shape (m,)

    Examples
    --------
    >>> student_quantiles(0.95, np.array([10.0, np.inf, np.nan])).round(4)
    array([2.2281, 1.96  ,    nan])
    """
    upper = 0.5 * (1.0 + level)
    return np.where(np.isinf(dof), ndtri(upper), stdtrit(np.where(np.isinf(dof), 1.0, dof), upper))


def two_sided_p(statistic: float, dof: float | None) -> float | None:
    """Probability of a |t| as large as this if the truth is zero; None without degrees of freedom."""
    if dof is None or math.isnan(statistic):
        return None
    return float(2.0 * stdtr(dof, -abs(statistic)))
