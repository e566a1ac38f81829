"""The verb :func:`fit_trend`: from a time series to a :class:`~estimators.trends.trend.Trend`.

It reads as the work is done: check, frame, settle the scale, search, infer, label, and say what was seen.
"""

from __future__ import annotations

import dataclasses
import difflib
import math

import numpy as np

from estimators.arrays import ArrayLike, FloatArray, InputError
from estimators.consensus.found import Found, LineData, Scale
from estimators.consensus.presets import PRESETS, Preset
from estimators.inference.intervals import two_sided_p
from estimators.inference.probability import inlier_probability
from estimators.inference.sandwich import LineUncertainty, line_uncertainty
from estimators.noise.resolution import Quantisation, find_quantisation, scale_floor
from estimators.options import RobustOptions
from estimators.result import Consensus, NoFit, NoFitReason, Uncertainty
from estimators.series import Series, as_series
from estimators.trends.labels import label_rows, unlabelled_rows
from estimators.trends.line import Frame, line_geometry, line_parameters
from estimators.trends.models import MODELS
from estimators.trends.observations import Evidence, collect_notices, input_notices
from estimators.trends.quality import fit_quality
from estimators.trends.runner_up import find_runner_up
from estimators.trends.trend import Trend
from estimators.trends.unpack import unpack_series

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
        Times: numbers, datetime64, ``datetime``; any order, repeats allowed. A pandas Series may be given
        alone: its index is the time.
    y : array_like, shape (n,)
        Values; NaN and None are missing.
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
    >>> y = 5.0 + 0.5 * t + 0.1 * np.sin(9.0 * t)
    >>> y[[3, 11, 12, 25]] += [9.0, -7.0, 12.0, 30.0]
    >>> trend = fit_trend(t, y)
    >>> round(trend.parameters["slope"].value, 2), np.flatnonzero(~trend.points.inlier).tolist()
    (0.5, [3, 11, 12, 25])
    """
    preset = _preset(method)
    if model not in MODELS:
        raise InputError("model", f"unknown model {model!r}; {_suggest(model, MODELS)}")
    _check_positive("threshold", threshold)
    _check_positive("sigma", sigma)
    if not 0 < level < 1:
        raise InputError("level", "must lie between 0 and 1, both excluded")
    if isinstance(seed, bool) or not 0 <= int(seed) < 2**63:
        raise InputError("seed", "must be an integer from 0 to 2**63 - 1")
    settings = _DEFAULTS if options is None else options
    times, values = unpack_series(t, y)
    series = as_series(times, values, weights)
    refused = _refuse(series)
    if refused is not None:
        return refused
    trend = _fit(series, preset, threshold, sigma, level, int(seed), settings)
    if predict is not None and trend:
        trend = dataclasses.replace(trend, prediction=trend.predict(predict, level))
    return trend


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
        return dataclasses.replace(scale, points=unlabelled_rows(series), notices=input_notices(series))
    found = preset.search.run(data, scale, options, seed)
    if isinstance(found, NoFit):
        return dataclasses.replace(found, points=unlabelled_rows(series), notices=input_notices(series))
    root = None if series.weights is None else np.sqrt(series.weights)
    spread = _uncertainty(data, found, root, options)
    geometry = line_geometry(found.theta, frame, spread, found.sigma, series)
    dof = None if spread is None else spread.dof
    is_time = series.axis.kind == "datetime"
    origin = np.datetime64(series.axis.origin) if is_time else 0.0
    intercept_at = 0.0 if is_time else -float(series.axis.origin)
    parameters = line_parameters(geometry, intercept_at, level, dof)
    probability = found.probability
    if probability is None:
        probability = inlier_probability(found.residual, root, max(found.sigma, scale.floor))
    inliers = int(np.count_nonzero(found.inlier))
    r2, rmse = fit_quality(series.y, found.residual, found.inlier)
    runner_up = find_runner_up(data, found, preset, scale, options, seed, frame, intercept_at)
    evidence = Evidence(series, preset, found, inliers, spread, quantisation, scale.floor, runner_up)
    stderr = parameters["slope"].stderr
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
        uncertainty=_describe(spread, level, options),
        p_value=two_sided_p(geometry.slope / stderr if stderr else math.inf, dof),
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
    """What is known of the noise before the search; a pilot finds it for methods that need a threshold."""
    floor = scale_floor(data.y, quantisation)
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


def _uncertainty(
    data: LineData, found: Found, root: FloatArray | None, options: RobustOptions
) -> LineUncertainty | None:
    return line_uncertainty(
        data.t,
        found.residual,
        root,
        found.sigma,
        found.threshold,
        found.loss,
        correct_serial_correlation=options.correct_serial_correlation,
    )


def _describe(spread: LineUncertainty | None, level: float, options: RobustOptions) -> Uncertainty:
    if spread is None:
        return Uncertainty("none", level, None, None, None)
    name = "effective-n" if options.correct_serial_correlation else "sandwich"
    return Uncertainty(name, level, spread.effective_n, spread.lag1, spread.dof)


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
    return NoFit(reason, message, unlabelled_rows(series), input_notices(series))


def _preset(method: str) -> Preset:
    preset = PRESETS.get(method)
    if preset is None:
        raise InputError("method", f"unknown method {method!r}; {_suggest(method, PRESETS)}")
    return preset


def _suggest(name: str, known: object) -> str:
    names = list(known)  # type: ignore[call-overload]
    close = difflib.get_close_matches(str(name), names, n=1)
    hint = f"did you mean {close[0]!r}? " if close else ""
    return f"{hint}known: {', '.join(names)}"


def _check_positive(field: str, value: float | None) -> None:
    if value is None:
        return
    if isinstance(value, bool) or not math.isfinite(value) or value <= 0:
        raise InputError(field, "must be a positive finite number")
