"""The verb :func:`fit_trend`: from a time series to a :class:`~estimators.trends.trend.Trend`.

It checks what it is given and leaves the fit to the shape that was asked for.
"""

from __future__ import annotations

import dataclasses
from typing import Any

from estimators.arrays import LARGEST_VALUE, ArrayLike, InputError
from estimators.consensus.presets import PRESETS
from estimators.options import RobustOptions
from estimators.result import NoFit, NoFitReason
from estimators.series import as_series
from estimators.trends.arguments import check_fraction, check_positive, check_seed, look_up
from estimators.trends.bases.settings import Basis, check_basis
from estimators.trends.exponential.domain import NOISE_CHOICES
from estimators.trends.magnitude import in_value_units, value_unit
from estimators.trends.models import MODELS, TrendModel
from estimators.trends.questions.crossing import check_values
from estimators.trends.regimes.present import REGIMES, fit_regime
from estimators.trends.request import Request, no_fit
from estimators.trends.resampling import UNCERTAINTIES
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
    uncertainty: str = "effective-n",
    noise: str = "auto",
    degree: int | None = None,
    seasonal: Any = None,
    harmonics: int | None = None,
    columns: Any = None,
    regime: str = "all",
    reach: ArrayLike | None = None,
    horizon: Any = None,
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
        Of methods that sample, and of resampling; ``auto`` does not depend on it.
    uncertainty : str
        How intervals and p-value are made (default ``"effective-n"``, a formula for correlated residuals):
        ``"hac"``, ``"bootstrap"`` or ``"permutation"`` on request; see docs/uncertainty.md.
    noise : str
        Of an exponential: ``"multiplicative"`` (a share of the level; threshold and sigma are then of
        ln(value)), ``"additive"``, or ``"auto"``, told from the data (default).
    degree : int, optional
        Of the polynomial of ``model="linear"``, 0 to 5 (default 1).
    seasonal : period, sequence of periods, or "auto", optional
        Seasons to fit together with the trend: periods in the unit of time (seconds for points in time), as
        timedeltas, or ``"hour"``, ``"day"``, ``"week"``, ``"month"``, ``"year"``; ``"auto"`` finds them.
    harmonics : int, optional
        Pairs of cosine and sine per season, 1 to 8 (default: as many as the data support).
    columns : mapping of str to array_like, or array_like of shape (n,) or (n, k), optional
        Further columns of ``model="linear"``, one entry per row; at other times they stand at their means
        unless :meth:`Trend.predict` is given them.
    regime : {"all", "last"}
        ``"last"`` fits the present regime: the series since it last left its line for good. Earlier ones are
        listed; their rows take no part.
    reach : float or array_like, optional
        Values to reach; :meth:`Trend.time_to` answers for each, as it does at any time.
    horizon : time, optional
        Time by which ``reach`` is wanted.
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
    look_up("uncertainty", uncertainty, UNCERTAINTIES)
    look_up("noise", noise, NOISE_CHOICES)
    basis = check_basis(degree, harmonics, columns, seasonal)
    _check_taken(shape, basis)
    threshold = check_positive("threshold", threshold)
    sigma = check_positive("sigma", sigma)
    level = check_fraction("level", level)
    seed = check_seed(seed)
    look_up("regime", regime, REGIMES)
    values_to_reach = () if reach is None else check_values(reach)
    if horizon is not None and not values_to_reach:
        raise InputError("horizon", "is for values to reach; give them in reach")
    settings = _DEFAULTS if options is None else options
    if not isinstance(settings, RobustOptions):
        raise InputError("options", "expected a RobustOptions")
    times, values = unpack_series(t, y)
    series = as_series(times, values, None if weights is None else plain_column(weights))
    if series.n == 0:
        message = "There are no usable points: every row is missing or invalid."
        return no_fit(NoFitReason.no_data, message, series)
    request = Request(
        series, preset, threshold, sigma, level, seed, settings, uncertainty, noise, basis, regime
    )
    trend = _fit_any_magnitude(request, shape)
    if values_to_reach and isinstance(trend, Trend):
        crossings = tuple(trend.time_to(value, horizon=horizon) for value in values_to_reach)
        trend = dataclasses.replace(trend, crossings=crossings)
    if predict is None or isinstance(trend, NoFit):
        return trend
    if trend.alternative is not None:
        other = dataclasses.replace(trend.alternative, prediction=trend.alternative.predict(predict, level))
        trend = dataclasses.replace(trend, alternative=other)
    return dataclasses.replace(trend, prediction=trend.predict(predict, level))


def _check_taken(shape: TrendModel, basis: Basis) -> None:
    for setting in basis.asked():
        if setting not in shape.takes:
            takers = ", ".join(row.name for row in MODELS.values() if setting in row.takes)
            raise InputError(setting, f"has no meaning for the model {shape.name}; it has for: {takers}")


def _fit_any_magnitude(request: Request, model: TrendModel) -> Trend | NoFit:
    """Fit in a unit in which squares of the values do not underflow; nearly always the caller's."""
    series = request.series
    unit = value_unit(series.y)
    if unit == 1.0 or model.any_magnitude:
        return fit_regime(request, model.fit)
    threshold, sigma = request.threshold, request.sigma
    magnified = dataclasses.replace(
        request,
        series=dataclasses.replace(series, y=series.y / unit),
        threshold=None if threshold is None else min(threshold / unit, LARGEST_VALUE),
        sigma=None if sigma is None else min(sigma / unit, LARGEST_VALUE),
    )
    trend = fit_regime(magnified, model.fit)
    return trend if isinstance(trend, NoFit) else in_value_units(trend, unit)
