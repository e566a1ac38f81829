"""A trend at requested times: its value, where the trend lies, and where a new reading will."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from estimators.arrays import FloatArray, InputError
from estimators.inference.intervals import student_quantile
from estimators.notices import Notice, NoticeCode, notice
from estimators.trends.bases.own import bands_with_columns
from estimators.trends.presentation.dictionary import prediction_to_dict
from estimators.trends.unpack import plain_column

if TYPE_CHECKING:
    from estimators.trends.trend import Trend


@dataclass(frozen=True, slots=True)
class Prediction:
    """The trend at requested times, with two bands.

    Attributes
    ----------
    time : ndarray, shape (k,)
        As asked for (numbers or datetime64[ns]).
    value : ndarray of float64, shape (k,)
        The trend.
    confidence_low, confidence_high : ndarray of float64, shape (k,)
        Where the *trend* lies; NaN where the data leave no way to tell.
    prediction_low, prediction_high : ndarray of float64, shape (k,)
        Where a *new inlier* of mean weight will lie.
    level : float
    notices : tuple of Notice
        ``extrapolation`` where a time lies outside of the data.
    """

    time: np.ndarray[Any, Any]
    value: FloatArray
    confidence_low: FloatArray
    confidence_high: FloatArray
    prediction_low: FloatArray
    prediction_high: FloatArray
    level: float
    notices: tuple[Notice, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """JSON-safe columns."""
        return prediction_to_dict(self)


def predict(trend: Trend, times: ArrayLike, level: float | None, columns: Any) -> Prediction:
    """Answer :meth:`estimators.Trend.predict`."""
    wanted = trend.uncertainty.level if level is None else float(level)
    if not 0 < wanted < 1:
        raise InputError("level", "must lie between 0 and 1, both excluded")
    asked, internal = trend.axis.read(plain_column(times))
    curve = trend.geometry
    quantile = student_quantile(wanted, trend.uncertainty.dof)
    if columns is None:
        bands = curve.bands(internal, quantile)
    else:
        bands = bands_with_columns(curve, internal, quantile, columns)
    outside = (internal < curve.span[0]) | (internal > curve.span[1])
    notices = (
        (notice(NoticeCode.extrapolation, times=int(np.count_nonzero(outside))),) if np.any(outside) else ()
    )
    return Prediction(
        time=asked,
        value=bands.value,
        confidence_low=bands.confidence_low,
        confidence_high=bands.confidence_high,
        prediction_low=bands.prediction_low,
        prediction_high=bands.prediction_high,
        level=wanted,
        notices=notices,
    )
