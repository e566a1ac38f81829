"""How well the line describes its inliers."""

from __future__ import annotations

import math

from estimators.arrays import FloatArray
from estimators.regression.influence import INLIERS, SSE, VALUE, VALUE_SQUARE

_LEAST_VARIATION = 1e-20
"""Of the squared values: below it their variation is rounding."""


def fit_quality(sums: FloatArray) -> tuple[float | None, float | None]:
    """R2 and root mean square error on inliers.

    Parameters
    ----------
    sums : ndarray of float64
        From :func:`estimators.regression.influence.influence_sums`.

    Returns
    -------
    r2 : float or None
        1 - SSE / SST; None without inliers or where they do not vary.
    rmse : float or None
        sqrt(SSE / inliers).
    """
    inliers = float(sums[INLIERS])
    if inliers == 0:
        return None, None
    r2, rmse = quality(inliers, float(sums[SSE]), float(sums[VALUE]), float(sums[VALUE_SQUARE]))
    return (None if math.isnan(r2) else r2), rmse


def quality(inliers: float, sse: float, value: float, value_square: float) -> tuple[float, float]:
    """Compute :func:`fit_quality` in plain arithmetic, which compiled code runs to the same bits.

    Returns
    -------
    tuple of float
        R2, NaN where the inliers do not vary, and root mean square error; there is an inlier at least.
    """
    sst = value_square - value * value / inliers
    r2 = 1.0 - sse / sst if sst > _LEAST_VARIATION * value_square else math.nan
    return r2, math.sqrt(sse / inliers)
