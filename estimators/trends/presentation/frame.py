"""A trend as a pandas data frame: one row per input row."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from estimators.arrays import FloatArray, Reason
from estimators.trends.bases.own import columns_at_rows

if TYPE_CHECKING:
    import pandas as pd

    from estimators.trends.trend import Trend


def trend_to_frame(trend: Trend) -> pd.DataFrame:
    """One row per input row, in input order.

    Parameters
    ----------
    trend : Trend

    Returns
    -------
    pandas.DataFrame
        With a RangeIndex and the columns ``time`` (datetime64 stays datetime64), ``value``, ``fit``,
        ``confidence_low``, ``confidence_high``, ``prediction_low``, ``prediction_high`` (at the level of
        the fit; NaN where the time is missing or the data leave no way to tell), ``inlier``,
        ``probability``, ``residual`` and ``reason`` (categorical).

    Raises
    ------
    ImportError
        If pandas is not installed (extra ``[pandas]``).
    """
    import pandas as pd  # noqa: PLC0415

    known = np.isfinite(trend.axis.to_internal(trend.time))
    bands = trend.predict(trend.time[known], columns=columns_at_rows(trend.geometry, known))

    def on_known_rows(values: FloatArray) -> FloatArray:
        column = np.full(known.size, np.nan)
        column[known] = values
        return column

    names = pd.Index([member.name for member in Reason])
    return pd.DataFrame(
        {
            "time": trend.time,
            "value": trend.values,
            "fit": on_known_rows(bands.value),
            "confidence_low": on_known_rows(bands.confidence_low),
            "confidence_high": on_known_rows(bands.confidence_high),
            "prediction_low": on_known_rows(bands.prediction_low),
            "prediction_high": on_known_rows(bands.prediction_high),
            "inlier": trend.points.inlier,
            "probability": trend.points.probability,
            "residual": trend.points.residual,
            "reason": pd.Categorical.from_codes(trend.points.reason_codes.astype(np.int8), categories=names),
        }
    )
