"""How well the line describes its inliers."""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import BoolArray, FloatArray


def fit_quality(y: FloatArray, residual: FloatArray, inlier: BoolArray) -> tuple[float | None, float | None]:
    """R2 and root mean square error on inliers.

    Parameters
    ----------
    y, residual : ndarray of float64, shape (n,)
    inlier : ndarray of bool, shape (n,)

    Returns
    -------
    r2 : float or None
        1 - SSE / SST; None without inliers or where they do not vary.
    rmse : float or None
        sqrt(SSE / inliers).
    """
    kept = residual[inlier]
    if kept.size == 0:
        return None, None
    values = y[inlier]
    sse = float(np.sum(kept * kept))
    centred = values - values.mean()
    sst = float(np.sum(centred * centred))
    return (1.0 - sse / sst if sst > 0 else None), math.sqrt(sse / kept.size)
