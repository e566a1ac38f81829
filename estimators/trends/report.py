"""What a trend says to people, in words: :func:`describe` turns an answer into a :class:`Report`.

A report is short strings; :mod:`estimators.trends.layout` sets them as text and as HTML, and the command
line sets the same ones in colour.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from estimators.arrays import IntArray
from estimators.inference.intervals import student_quantile
from estimators.result import Estimate
from estimators.time_axis import TimeAxis
from estimators.trends.facts import facts, notice_lines, slope_unit
from estimators.trends.units import MISSING, SECOND, moment_text, p_value_text, rounded, significant

if TYPE_CHECKING:
    from estimators.trends.trend import Prediction, Trend

_OUTLIERS_SHOWN = 5
_PREDICTIONS_SHOWN = 10


@dataclass(frozen=True, slots=True)
class EstimateLine:
    """One parameter in words: name with its unit, value, standard error, interval, p-value."""

    name: str
    value: str
    stderr: str
    interval: str
    p_value: str


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
    outlying = np.flatnonzero(~trend.points.inlier & np.isfinite(trend.points.residual))
    prediction = trend.prediction
    told = {item.code for item in trend.notices}
    more = () if prediction is None else tuple(item for item in prediction.notices if item.code not in told)
    return Report(
        title=f"Robust trend: {trend.model} by {trend.consensus.method}",
        equation=_equation(trend, time_name, value_name),
        level=f"{100 * trend.uncertainty.level:g} %",
        estimates=tuple(_estimates(trend, time_name)),
        facts=tuple(facts(trend)),
        outliers=tuple(_outliers(trend, outlying)),
        outliers_total=int(outlying.size),
        predictions=() if prediction is None else tuple(_predictions(prediction, trend.consensus.sigma)),
        predictions_total=0 if prediction is None else int(prediction.time.size),
        notices=tuple(notice_lines(trend.notices + more)),
    )


def _scaled(estimate: Estimate, factor: float) -> Estimate:
    def times(value: float | None) -> float | None:
        return None if value is None else value * factor

    return Estimate(
        value=estimate.value * factor,
        stderr=times(estimate.stderr),
        low=times(estimate.low),
        high=times(estimate.high),
    )


def _level_amid(trend: Trend) -> tuple[float, Estimate] | None:
    """Level at the center of the data, where the intercept is a far extrapolation and says little."""
    if trend.axis.kind == "datetime":
        return None
    line = trend.geometry
    first, last = line.span
    at_zero = -float(trend.axis.origin)
    if first - (last - first) <= at_zero <= last + (last - first):
        return None
    origin, internal = float(trend.axis.origin), line.center
    # A round time amid the data reads better than their very center, if floats that large can be round.
    step = 10.0 ** math.floor(math.log10(last - first) - 1)
    if math.ulp(origin) < step:
        internal = round((origin + internal) / step) * step - origin
    there = dataclasses.replace(trend, axis=TimeAxis("number", 0.0)).predict([internal])
    value, low, high = float(there.value[0]), float(there.confidence_low[0]), float(there.confidence_high[0])
    if not math.isfinite(high):
        return origin + internal, Estimate(value, None, None, None)
    stderr = (high - value) / student_quantile(trend.uncertainty.level, trend.uncertainty.dof)
    return origin + internal, Estimate(value, stderr, low, high)


def _equation(trend: Trend, time_name: str, value_name: str) -> str:
    unit = slope_unit(trend)
    slope = _scaled(trend.parameters["slope"], unit.seconds)
    intercept = trend.parameters["intercept"]
    change = f"{'-' if slope.value < 0 else '+'} {rounded(abs(slope.value), slope.stderr)}"
    amid = _level_amid(trend)
    if amid is not None:
        center, level = amid
        return f"{value_name} = {rounded(level.value, level.stderr)} {change} · ({time_name} - {center:.10g})"
    start = f"{value_name} = {rounded(intercept.value, intercept.stderr)} {change}"
    if trend.axis.kind == "datetime":
        return f"{start} · ({unit.name}s since {moment_text(trend.origin)})"
    return f"{start} · {time_name}"


def _estimates(trend: Trend, time_name: str) -> Iterable[EstimateLine]:
    unit = slope_unit(trend)
    slope = trend.parameters["slope"]
    yield _estimate_line(f"slope{unit.per}", _scaled(slope, unit.seconds), p_value_text(trend.p_value))
    if unit.name and unit != SECOND:
        yield _estimate_line("slope per second", slope)
    where = moment_text(trend.origin)
    at_origin = where if trend.axis.kind == "datetime" else f"{time_name} = {where}"
    yield _estimate_line(f"level at {at_origin}", trend.parameters["intercept"])
    amid = _level_amid(trend)
    if amid is not None:
        yield _estimate_line(f"level at {time_name} = {amid[0]:.10g}", amid[1])


def _estimate_line(name: str, estimate: Estimate, p_value: str = "") -> EstimateLine:
    return EstimateLine(
        name=name,
        value=rounded(estimate.value, estimate.stderr),
        stderr=MISSING if estimate.stderr is None else rounded(estimate.stderr, estimate.stderr),
        interval=_interval(estimate.low, estimate.high, estimate.stderr),
        p_value=p_value,
    )


def _interval(low: float | None, high: float | None, scale: float | None) -> str:
    if low is None or high is None or not (math.isfinite(low) and math.isfinite(high)):
        return MISSING
    return f"[{rounded(low, scale)}, {rounded(high, scale)}]"


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
            _interval(low, high, scale),
            _interval(float(prediction.prediction_low[row]), float(prediction.prediction_high[row]), scale),
        )
