"""The verb :func:`fit_trend`: from a time series to a :class:`~estimators.trends.trend.Trend`.

It reads as the work is done: check, frame, settle the scale, search, infer, label, and say what was seen.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from estimators.arrays import LARGEST_VALUE, ArrayLike, InputError
from estimators.consensus.found import LineData, Scale
from estimators.consensus.presets import PRESETS, Preset
from estimators.inference.intervals import two_sided_p
from estimators.inference.probability import inlier_probability
from estimators.inference.sandwich import LineUncertainty, line_uncertainty
from estimators.noise.resolution import Quantisation, find_quantisation, scale_floor
from estimators.options import RobustOptions
from estimators.regression.influence import INLIERS, influence_sums
from estimators.result import Consensus, NoFit, NoFitReason, Uncertainty
from estimators.series import Series, as_series
from estimators.trends.arguments import check_fraction, check_positive, check_seed, look_up
from estimators.trends.labels import label_rows, unlabelled_rows
from estimators.trends.line import Frame, line_geometry, line_parameters
from estimators.trends.magnitude import in_value_units, value_unit
from estimators.trends.models import MODELS
from estimators.trends.observations import Evidence, collect_notices, input_notices
from estimators.trends.quality import fit_quality
from estimators.trends.runner_up import find_runner_up
from estimators.trends.trend import Trend
from estimators.trends.unpack import plain_column, unpack_series

_DEFAULTS = RobustOptions()

_LEAST_FLOOR = float(np.finfo(np.float64).eps) / LARGEST_VALUE
"""Resolution of the smallest values that are fitted as they are; reached where all values are 0."""


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
    look_up("model", model, MODELS)
    threshold = check_positive("threshold", threshold)
    sigma = check_positive("sigma", sigma)
    level = check_fraction("level", level)
    seed = check_seed(seed)
    settings = _DEFAULTS if options is None else options
    if not isinstance(settings, RobustOptions):
        raise InputError("options", "expected a RobustOptions")
    times, values = unpack_series(t, y)
    series = as_series(times, values, None if weights is None else plain_column(weights))
    refused = _refuse(series)
    if refused is not None:
        return refused
    trend = _fit_any_magnitude(series, preset, threshold, sigma, level, seed, settings)
    if predict is None or isinstance(trend, NoFit):
        return trend
    return dataclasses.replace(trend, prediction=trend.predict(predict, level))


def _fit_any_magnitude(
    series: Series,
    preset: Preset,
    threshold: float | None,
    sigma: float | None,
    level: float,
    seed: int,
    options: RobustOptions,
) -> Trend | NoFit:
    """Fit in a unit in which squares of the values do not underflow; nearly always the caller's."""
    unit = value_unit(series.y)
    if unit == 1.0:
        return _fit(series, preset, threshold, sigma, level, seed, options)
    magnified = dataclasses.replace(series, y=series.y / unit)
    threshold = None if threshold is None else min(threshold / unit, LARGEST_VALUE)
    sigma = None if sigma is None else min(sigma / unit, LARGEST_VALUE)
    trend = _fit(magnified, preset, threshold, sigma, level, seed, options)
    return trend if isinstance(trend, NoFit) else in_value_units(trend, unit)


def _fit(
    series: Series,
    preset: Preset,
    threshold: float | None,
    sigma: float | None,
    level: float,
    seed: int,
    options: RobustOptions,
) -> Trend | NoFit:
    frame = Frame.of(series.t)
    data = LineData(frame.apply(series.t), series.y, series.weights)
    quantisation = find_quantisation(series.y, series.t)
    scale = _settle_scale(data, preset, threshold, sigma, quantisation, options)
    if isinstance(scale, NoFit):
        return _no_fit(scale.reason, scale.message, series)
    found = preset.search.run(data, scale, options, seed)
    if isinstance(found, NoFit):
        return _no_fit(found.reason, found.message, series)
    root = None if series.weights is None else np.sqrt(series.weights)
    sums = found.sums
    if sums is None:
        sums = influence_sums(data.t, data.y, found.residual, root, found.sigma, found.threshold, found.loss)
    spread = line_uncertainty(
        sums,
        series.n,
        found.sigma,
        found.spread,
        correct_serial_correlation=options.correct_serial_correlation,
    )
    geometry = line_geometry(found.theta, frame, spread, found.sigma, series)
    dof = None if spread is None else spread.dof
    origin, intercept_at = _origin(series)
    parameters = line_parameters(geometry, intercept_at, level, dof)
    probability = found.probability
    if probability is None:
        probability = inlier_probability(found.residual, root, max(found.sigma, scale.floor))
    inliers = int(sums[INLIERS])
    r2, rmse = fit_quality(sums)
    runner_up = find_runner_up(data, found, preset, scale, options, seed, frame, intercept_at)
    evidence = Evidence(series, preset, found, inliers, spread, quantisation, scale.floor, rmse, runner_up)
    return Trend(
        model="line",
        parameters=parameters,
        origin=origin,
        points=label_rows(series, found.inlier, probability, found.residual),
        consensus=Consensus(
            method=preset.name,
            n=series.n,
            inliers=inliers,
            inlier_ratio=inliers / series.n,
            threshold=found.threshold,
            threshold_source=found.threshold_source,
            sigma=found.sigma,
            sigma_source=found.sigma_source,
            ledger=found.ledger,
            sampling_probability=found.sampling_probability,
            search=found.search,
            seed=seed,
        ),
        uncertainty=_describe(spread, level),
        p_value=two_sided_p(_statistic(geometry.slope, geometry.slope_stderr), dof),
        r2=r2,
        rmse=rmse,
        runner_up=runner_up,
        notices=collect_notices(evidence),
        axis=series.axis,
        geometry=geometry,
        time=series.input_time,
        values=series.input_values,
    )


def _settle_scale(
    data: LineData,
    preset: Preset,
    threshold: float | None,
    sigma: float | None,
    quantisation: Quantisation,
    options: RobustOptions,
) -> Scale | NoFit:
    """Collect what is known of the noise before the search; a pilot finds what the method needs."""
    floor = max(scale_floor(data.y, quantisation), _LEAST_FLOOR)
    if sigma is not None:
        floor = min(floor, sigma)
    given = Scale(sigma, "given", threshold, "given", floor)
    if threshold is not None or not preset.search.needs_threshold:
        return given
    if sigma is not None:
        return dataclasses.replace(
            given, threshold=options.threshold_sigmas * sigma, threshold_source="sigma"
        )
    pilot = PRESETS["auto"].search.run(data, given, options, 0)
    if isinstance(pilot, NoFit):
        return pilot
    least = max(pilot.sigma, floor)
    return Scale(least, pilot.sigma_source, options.threshold_sigmas * least, "sigma", floor)


def _origin(series: Series) -> tuple[float | np.datetime64, float]:
    """Time at which the intercept is taken: the caller's and the internal one."""
    first = series.axis.origin
    return (first, 0.0) if isinstance(first, np.datetime64) else (0.0, -float(first))


def _statistic(slope: float, stderr: float) -> float:
    """Slope in standard errors; a level line without noise has none to show."""
    if stderr == 0.0:
        return math.copysign(math.inf, slope) if slope else 0.0
    return slope / stderr


def _describe(spread: LineUncertainty | None, level: float) -> Uncertainty:
    if spread is None:
        return Uncertainty("none", level, None, None, None)
    return Uncertainty(spread.method, level, spread.effective_n, spread.lag1, spread.dof)


def _refuse(series: Series) -> NoFit | None:
    """Series through which no line can be drawn."""
    if series.n == 0:
        reason, message = NoFitReason.no_data, "There are no usable points: every row is missing or invalid."
    elif series.n < 2:
        reason, message = NoFitReason.too_few_points, "One usable point; a line needs at least two."
    elif series.t[0] == series.t[-1]:
        reason, message = NoFitReason.constant_time, "All times are equal; a line needs two different times."
    else:
        return None
    return _no_fit(reason, message, series)


def _no_fit(reason: NoFitReason, message: str, series: Series) -> NoFit:
    points, notices = unlabelled_rows(series), input_notices(series)
    return NoFit(reason, message, points, notices, series.input_time, series.input_values)
