"""What a trend says to people, in words: :func:`describe` turns an answer into a :class:`Report`.

A report is short strings; :mod:`estimators.trends.presentation.layout` sets them as text and as HTML, and the
command line sets the same ones in colour.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from estimators.arrays import IntArray
from estimators.trends.presentation.facts import facts, notice_lines
from estimators.trends.presentation.units import moment_text, rounded, significant
from estimators.trends.presentation.wording import WORDS
from estimators.trends.presentation.words import EstimateLine, interval_text

if TYPE_CHECKING:
    from estimators.trends.prediction import Prediction
    from estimators.trends.trend import Trend

_OUTLIERS_SHOWN = 5
_PREDICTIONS_SHOWN = 10


@dataclass(frozen=True, slots=True)
class Report:
    """A trend in words, ready to be laid out.

    Attributes
    ----------
    title, equation : str
    level : str
        Confidence level of all intervals, as a percentage.
    estimates : tuple of EstimateLine
    facts : tuple of (str, str)
        Label and sentence.
    outliers : tuple of (str, str, str)
        Time, value and distance from the trend of the farthest outliers.
    outliers_total : int
    predictions : tuple of (str, str, str, str)
        Time, trend, confidence interval and prediction interval of the first predictions.
    predictions_total : int
    notices : tuple of (str, str)
        What is worth knowing, and what to do about it.
    """

    title: str
    equation: str
    level: str
    estimates: tuple[EstimateLine, ...]
    facts: tuple[tuple[str, str], ...]
    outliers: tuple[tuple[str, str, str], ...]
    outliers_total: int
    predictions: tuple[tuple[str, str, str, str], ...]
    predictions_total: int
    notices: tuple[tuple[str, str], ...]


def describe(trend: Trend, *, time_name: str = "t", value_name: str = "y") -> Report:
    """Put an answer into words.

    Parameters
    ----------
    trend : Trend
    time_name, value_name : str
        What the columns are called (default ``t`` and ``y``).

    Returns
    -------
    Report

    Examples
    --------
    >>> import numpy as np
    >>> from estimators import fit_trend
    >>> describe(fit_trend(np.arange(20.0), 3.0 + 2.0 * np.arange(20.0))).equation
    'y = 3 + 2 · t'
    """
    words = WORDS[trend.model]
    outlying = np.flatnonzero(~trend.points.inlier & np.isfinite(trend.points.residual))
    prediction = trend.prediction
    told = {item.code for item in trend.notices}
    more = () if prediction is None else tuple(item for item in prediction.notices if item.code not in told)
    return Report(
        title=f"Robust trend: {trend.model} by {trend.consensus.method}",
        equation=words.equation(trend, time_name, value_name),
        level=f"{100 * trend.uncertainty.level:g} %",
        estimates=tuple(words.estimates(trend, time_name)),
        facts=tuple(facts(trend)),
        outliers=tuple(_outliers(trend, outlying)),
        outliers_total=int(outlying.size),
        predictions=() if prediction is None else tuple(_predictions(prediction, trend.consensus.sigma)),
        predictions_total=0 if prediction is None else int(prediction.time.size),
        notices=tuple(notice_lines(trend.notices + more)),
    )


def _outliers(trend: Trend, rows: IntArray) -> Iterable[tuple[str, str, str]]:
    residual, sigma = trend.points.residual, trend.consensus.sigma
    farthest = rows[np.argsort(-np.abs(residual[rows]), kind="stable")[:_OUTLIERS_SHOWN]]
    for row in farthest:
        off = f"{residual[row]:+.4g}"
        # On data without noise sigma is the arithmetic's, and a ratio to it means nothing.
        if abs(residual[row]) < 1e6 * sigma:
            off += f" ({residual[row] / sigma:+.3g} sigma)"
        yield moment_text(trend.time[row]), significant(float(trend.values[row]), 6), off


def _predictions(prediction: Prediction, sigma: float) -> Iterable[tuple[str, str, str, str]]:
    for row in range(min(prediction.time.size, _PREDICTIONS_SHOWN)):
        low, high = float(prediction.confidence_low[row]), float(prediction.confidence_high[row])
        scale = min((high - low) / 2, sigma) if math.isfinite(high - low) else None
        yield (
            moment_text(prediction.time[row]),
            rounded(float(prediction.value[row]), scale),
            interval_text(low, high, scale),
            interval_text(
                float(prediction.prediction_low[row]), float(prediction.prediction_high[row]), scale
            ),
        )
