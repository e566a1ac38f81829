"""One entry per input row: results of the usable points put back where their rows were."""

from __future__ import annotations

import numpy as np

from estimators.arrays import BoolArray, FloatArray, Reason
from estimators.result import Points
from estimators.series import Series


def unlabelled_rows(series: Series) -> Points:
    """Rows of a series without a model: nothing but the reasons from the input."""
    n = series.n_input
    nothing = np.full(n, np.nan)
    return Points(np.zeros(n, dtype=np.bool_), nothing, nothing.copy(), series.reasons.copy())


def label_rows(series: Series, inlier: BoolArray, probability: FloatArray, residual: FloatArray) -> Points:
    """Labels per input row, in input order.

    Parameters
    ----------
    series : Series
    inlier, probability, residual : ndarray, shape (m,)
        Per usable point, in the order of time.
    """
    if series.rows is None:
        # Every row took part and is ok (0) or an outlier (1): the reason is the flag turned round.
        return Points(inlier, probability, residual, np.logical_not(inlier).view(np.uint8))
    codes = series.reasons.copy()
    n = series.n_input
    points = Points(np.zeros(n, dtype=np.bool_), np.full(n, np.nan), np.full(n, np.nan), codes)
    rows = series.rows
    points.inlier[rows] = inlier
    points.probability[rows] = probability
    points.residual[rows] = residual
    codes[rows[~inlier]] = Reason.outlier
    return points
