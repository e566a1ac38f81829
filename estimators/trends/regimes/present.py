"""The fit of the present regime: changes are found, the last stretch is fitted, earlier ones are listed."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from estimators.arrays import FloatArray, Reason
from estimators.inference.intervals import student_quantile
from estimators.noise.resolution import find_quantisation, scale_floor
from estimators.notices import NoticeCode, notice
from estimators.result import Estimate, NoFit
from estimators.series import Series
from estimators.trends.line.fit import LEAST_FLOOR, fit_line
from estimators.trends.regimes.changes import find_changes
from estimators.trends.regimes.regime import Regime
from estimators.trends.request import Request
from estimators.trends.trend import Trend

REGIMES: Mapping[str, str] = MappingProxyType(
    {"all": "the whole series", "last": "the series since it last left its line for good"}
)
"""What ``fit_trend(regime=...)`` takes, and what is fitted."""

Fit = Callable[[Request], Trend | NoFit]


def fit_regime(request: Request, fit: Fit) -> Trend | NoFit:
    """Fit what was asked for: the whole series, or its present regime.

    Changes are looked for in what the trend of the whole series leaves over, so that a shape with a season
    or a curvature is not cut where it bends.

    Parameters
    ----------
    request : Request
    fit : callable
        Of the shape.

    Returns
    -------
    Trend or NoFit
    """
    if request.regime == "all":
        return fit(request)
    plain = dataclasses.replace(request, uncertainty="effective-n")
    whole = fit(plain)
    if isinstance(whole, NoFit):
        return whole
    series = request.series
    starts = _changes(request, whole)
    first = starts[-1]
    if first == 0:
        trend = whole if plain == request else fit(request)
    else:
        trend = fit(dataclasses.replace(request, series=_stretch(series, first, series.n)))
    if isinstance(trend, NoFit):
        return trend
    edges = itertools.pairwise([*starts, series.n])
    regimes = tuple(_regime(request, whole, start, stop) for start, stop in edges)
    notices = trend.notices
    if first > 0:
        notices += (notice(NoticeCode.earlier_regimes, regimes=len(starts) - 1, rows=first),)
    return dataclasses.replace(trend, regimes=regimes, notices=notices)


def _changes(request: Request, whole: Trend) -> list[int]:
    """First usable point of every regime; points of one time stay together."""
    series = request.series
    residual = _residual(series, whole)
    usable = np.flatnonzero(np.isfinite(residual))
    left = np.ascontiguousarray(residual[usable])
    floor = max(scale_floor(series.y, find_quantisation(series.y, series.t)), LEAST_FLOOR)
    if whole.noise is not None and whole.noise.domain == "multiplicative":
        floor = LEAST_FLOOR + float(np.finfo(np.float64).eps)
    weights = None if series.weights is None else series.weights[usable]
    t = np.ascontiguousarray(series.t[usable])
    starts = find_changes(t, left, weights, floor, request.sigma, request.options)
    return sorted({int(np.searchsorted(series.t, t[start], side="left")) for start in starts})


def _residual(series: Series, whole: Trend) -> FloatArray:
    """Take off the trend, in units in which the noise is even; NaN where the shape has no use for a row."""
    rows = slice(None) if series.rows is None else series.rows
    residual = whole.points.residual[rows]
    if whole.noise is None or whole.noise.domain != "multiplicative":
        return residual
    fitted = series.y - residual
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.log(series.y / fitted))


def _stretch(series: Series, start: int, stop: int) -> Series:
    """Part of a series; the usable rows before it say that they belong to an earlier regime."""
    rows = np.arange(series.n) if series.rows is None else series.rows
    reasons = series.reasons.copy()
    reasons[rows[:start]] = Reason.earlier_regime
    part = slice(start, stop)
    weights = None
    if series.weights is not None:
        weights = series.weights[part] / series.weights[part].mean()
    return dataclasses.replace(
        series,
        t=np.ascontiguousarray(series.t[part]),
        y=np.ascontiguousarray(series.y[part]),
        weights=weights,
        rows=rows[part],
        reasons=reasons,
    )


def _regime(request: Request, whole: Trend, start: int, stop: int) -> Regime:
    """Describe a regime by its straight line, whatever the shape of the trend."""
    series = request.series
    rows = np.arange(series.n) if series.rows is None else series.rows
    asked = dataclasses.replace(
        request, series=_stretch(series, start, stop), uncertainty="effective-n", regime="all"
    )
    if whole.noise is not None and whole.noise.domain == "multiplicative":
        # They are given as shares of the level; a straight line has no use for them.
        asked = dataclasses.replace(asked, threshold=None, sigma=None)
    line = fit_line(asked)
    first, last = (_plain(series.input_time[rows[place]]) for place in (start, stop - 1))
    if isinstance(line, NoFit):
        return Regime(first, last, stop - start, 0, None, None)
    return Regime(
        start=first,
        end=last,
        n=line.consensus.n,
        inliers=line.consensus.inliers,
        slope=line.parameters["slope"],
        level=_level_at(line, float(series.t[stop - 1])),
    )


def _plain(moment: np.generic) -> Any:
    return moment if isinstance(moment, np.datetime64) else moment.item()


def _level_at(line: Trend, at: float) -> Estimate:
    quantile = student_quantile(line.uncertainty.level, line.uncertainty.dof)
    bands = line.geometry.bands(np.array([at]), quantile)
    value, low, high = (float(x[0]) for x in (bands.value, bands.confidence_low, bands.confidence_high))
    if line.uncertainty.dof is None:
        return Estimate(value, None, None, None)
    return Estimate(value, (high - value) / quantile, low, high)
