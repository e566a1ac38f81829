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
    sse = float(sums[SSE])
    sst = float(sums[VALUE_SQUARE]) - float(sums[VALUE]) ** 2 / inliers
    varies = sst > _LEAST_VARIATION * float(sums[VALUE_SQUARE])
    return (1.0 - sse / sst if varies else None), math.sqrt(sse / inliers)
