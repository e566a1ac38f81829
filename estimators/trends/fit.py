"""The verb :func:`fit_trend`: from a time series to a :class:`~estimators.trends.trend.Trend`.

It checks what it is given and leaves the fit to the shape that was asked for.
"""

from __future__ import annotations

import dataclasses

from estimators.arrays import LARGEST_VALUE, ArrayLike, InputError
from estimators.consensus.presets import PRESETS
from estimators.options import RobustOptions
from estimators.result import NoFit, NoFitReason
from estimators.series import as_series
from estimators.trends.arguments import check_fraction, check_positive, check_seed, look_up
from estimators.trends.magnitude import in_value_units, value_unit
from estimators.trends.models import MODELS, TrendModel
from estimators.trends.request import Request, no_fit
from estimators.trends.trend import Trend
from estimators.trends.unpack import plain_column, unpack_series

_DEFAULTS = RobustOptions()


def fit_trend(
    t: ArrayLike,
    y: ArrayLike | None = None,
    *,
    model: str = "line",
    method: str = "auto",
    threshold: float | None = None,
    sigma: float | None = None,
    weights: ArrayLike | None = None,
    level: float = 0.95,
    seed: int = 0,
    predict: ArrayLike | None = None,
    options: RobustOptions | None = None,
) -> Trend | NoFit:
    """Fit a trend that outliers cannot move.

    Parameters
    ----------
    t : array_like, shape (n,)
        Times: numbers (0, or 1e-30 to 1e30 in size), datetime64, ``datetime``; any order, repeats allowed.
        A pandas Series may be given alone: its index is the time.
    y : array_like, shape (n,)
        Values up to 1e60 in size; NaN and None are missing, infinities are invalid.
    model : str
        Shape of the trend; see :func:`estimators.models` (default ``"line"``).
    method : str
        Preset; see :func:`estimators.methods` (default ``"auto"``, which needs no threshold).
    threshold : float, optional
        Largest |residual| of an inlier, in units of the values.
    sigma : float, optional
        Noise scale of an inlier; estimated where it is not given.
    weights : array_like, shape (n,), optional
        Precisions, 1/variance up to scale; 0 leaves a row out.
    level : float
        Confidence level of all intervals (default 0.95).
    seed : int
        Of methods that sample; ``auto`` does not depend on it.
    predict : array_like, optional
        Times to predict at; more at any time by :meth:`Trend.predict`.
    options : RobustOptions, optional

    Returns
    -------
    Trend or NoFit
        ``NoFit`` is falsy and says why.

    Raises
    ------
    InputError
        If an argument cannot be used; ``field`` names it.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(30.0)
    >>> y = 5.0 + 0.5 * t + np.random.default_rng(0).normal(scale=0.1, size=30)
    >>> y[[3, 11, 12, 25]] += [9.0, -7.0, 12.0, 30.0]
    >>> trend = fit_trend(t, y)
    >>> round(trend.parameters["slope"].value, 2), np.flatnonzero(~trend.points.inlier).tolist()
    (0.5, [3, 11, 12, 25])
    """
    preset = look_up("method", method, PRESETS)
    shape = look_up("model", model, MODELS)
    threshold = check_positive("threshold", threshold)
    sigma = check_positive("sigma", sigma)
    level = check_fraction("level", level)
    seed = check_seed(seed)
    settings = _DEFAULTS if options is None else options
    if not isinstance(settings, RobustOptions):
        raise InputError("options", "expected a RobustOptions")
    times, values = unpack_series(t, y)
    series = as_series(times, values, None if weights is None else plain_column(weights))
    if series.n == 0:
        message = "There are no usable points: every row is missing or invalid."
        return no_fit(NoFitReason.no_data, message, series)
    request = Request(series, preset, threshold, sigma, level, seed, settings)
    trend = _fit_any_magnitude(request, shape)
    if predict is None or isinstance(trend, NoFit):
        return trend
    return dataclasses.replace(trend, prediction=trend.predict(predict, level))


def _fit_any_magnitude(request: Request, model: TrendModel) -> Trend | NoFit:
    """Fit in a unit in which squares of the values do not underflow; nearly always the caller's."""
    series = request.series
    unit = value_unit(series.y)
    if unit == 1.0:
        return model.fit(request)
    threshold, sigma = request.threshold, request.sigma
    magnified = dataclasses.replace(
        request,
        series=dataclasses.replace(series, y=series.y / unit),
        threshold=None if threshold is None else min(threshold / unit, LARGEST_VALUE),
        sigma=None if sigma is None else min(sigma / unit, LARGEST_VALUE),
    )
    trend = model.fit(magnified)
    return trend if isinstance(trend, NoFit) else in_value_units(trend, unit)
