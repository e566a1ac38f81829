"""The straight line, fitted: frame, settle the scale, search, infer, label, and say what was seen."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from estimators.arrays import LARGEST_VALUE, FloatArray
from estimators.consensus.found import Found, LinearData, LineData, Scale
from estimators.consensus.presets import PRESETS, Preset
from estimators.inference.chance import chance_of_line
from estimators.inference.intervals import two_sided_p
from estimators.inference.probability import inlier_probability
from estimators.inference.sandwich import LineUncertainty, line_uncertainty
from estimators.inference.scores import point_scores
from estimators.noise.resolution import Quantisation, find_quantisation, scale_floor
from estimators.options import RobustOptions
from estimators.regression.influence import INLIERS, influence_sums
from estimators.result import NoFit, NoFitReason
from estimators.series import Series
from estimators.trends.account import account_of
from estimators.trends.labels import label_rows
from estimators.trends.line.frame import Frame, line_geometry, line_parameters
from estimators.trends.observations import Evidence, collect_notices
from estimators.trends.quality import fit_quality
from estimators.trends.request import Request, no_fit
from estimators.trends.resampling import Fitted, Inferred, Refit, Scored, infer
from estimators.trends.runner_up import find_runner_up
from estimators.trends.trend import Trend

LEAST_FLOOR = float(np.finfo(np.float64).eps) / LARGEST_VALUE
"""Resolution of the smallest values that are fitted as they are; reached where all values are 0."""

_ENDS = np.array([[1.0, -1.0], [1.0, 1.0]])


def fit_line(request: Request) -> Trend | NoFit:
    """Fit a straight line.

    Parameters
    ----------
    request : Request

    Returns
    -------
    Trend or NoFit
    """
    series, preset, options, seed = request.series, request.preset, request.options, request.seed
    refused = _refuse(series)
    if refused is not None:
        return refused
    frame = Frame.of(series.t)
    data = LineData(frame.apply(series.t), series.y, series.weights)
    quantisation = find_quantisation(series.y, series.t)
    scale = settle_scale(data, preset, request.threshold, request.sigma, quantisation, options)
    if isinstance(scale, NoFit):
        return no_fit(scale.reason, scale.message, series)
    found = preset.search.run(data, scale, options, seed)
    if isinstance(found, NoFit):
        return no_fit(found.reason, found.message, series)
    root = None if series.weights is None else np.sqrt(series.weights)
    sums = found.sums
    if sums is None:
        sums = influence_sums(data.t, data.y, found.residual, root, found.sigma, found.threshold, found.loss)
    inferred = _infer(request, data, found, sums, quantisation)
    spread = inferred.spread
    geometry = line_geometry(found.theta, frame, spread, found.sigma, series)
    dof = None if spread is None else spread.dof
    origin, intercept_at = origin_of(series)
    parameters = line_parameters(geometry, intercept_at, request.level, dof)
    probability = found.probability
    if probability is None:
        probability = inlier_probability(found.residual, root, max(found.sigma, scale.floor))
    inliers = int(sums[INLIERS])
    r2, rmse = fit_quality(sums)
    p_value = inferred.p_value
    if p_value is None:
        p_value = two_sided_p(_statistic(geometry.slope, geometry.slope_stderr), dof)
        if p_value is not None and found.search != "closed":
            p_value = max(p_value, chance_of_line(series.y, inliers, found.threshold))
    runner_up = find_runner_up(data, found, preset, scale, options, seed, frame, intercept_at)
    evidence = Evidence(series, preset, found, inliers, spread, quantisation, scale.floor, rmse, runner_up)
    return Trend(
        model="line",
        parameters=parameters,
        origin=origin,
        points=label_rows(series, found.inlier, probability, found.residual),
        consensus=account_of(request, found, inliers),
        uncertainty=inferred.describe(request.level),
        p_value=p_value,
        r2=r2,
        rmse=rmse,
        runner_up=runner_up,
        notices=collect_notices(evidence),
        axis=series.axis,
        geometry=geometry,
        time=series.input_time,
        values=series.input_values,
    )


def settle_scale(
    data: LinearData,
    preset: Preset,
    threshold: float | None,
    sigma: float | None,
    quantisation: Quantisation,
    options: RobustOptions,
) -> Scale | NoFit:
    """Collect what is known of the noise before the search; a pilot finds what the method needs.

    Parameters
    ----------
    data : LinearData
    preset : Preset
    threshold, sigma : float or None
        As given, in units of ``data.y``.
    quantisation : Quantisation
        Of the values; the scale does not fall below what it allows.
    options : RobustOptions

    Returns
    -------
    Scale or NoFit
        ``NoFit`` where the pilot, ``auto``, finds none.
    """
    floor = max(scale_floor(data.y, quantisation), LEAST_FLOOR)
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


def origin_of(series: Series) -> tuple[float | np.datetime64, float]:
    """Time at which the intercept is taken.

    Parameters
    ----------
    series : Series

    Returns
    -------
    origin : float or numpy.datetime64
        In the caller's times: the first of points in time, 0 of plain numbers.
    internal : float
        The same, since ``series.axis.origin``.
    """
    first = series.axis.origin
    return (first, 0.0) if isinstance(first, np.datetime64) else (0.0, -float(first))


def _statistic(slope: float, stderr: float) -> float:
    """Slope in standard errors; a level line without noise has none to show."""
    if stderr == 0.0:
        return math.copysign(math.inf, slope) if slope else 0.0
    return slope / stderr


def _infer(
    request: Request, data: LineData, found: Found, sums: FloatArray, quantisation: Quantisation
) -> Inferred[LineUncertainty]:
    """Uncertainty by the method asked for."""
    options = request.options
    spread = _spread_of(found, sums, data.n, correct=options.correct_serial_correlation)
    if spread is None or request.uncertainty == "effective-n":
        return Inferred(spread)
    root = None if data.weights is None else np.sqrt(data.weights)
    # Of weighted values the noise is permuted, not the level.
    level = 0.0 if root is None else float(found.theta[0] + found.theta[1] * spread.center)
    fitted = Fitted(
        y=data.y,
        residual=found.residual,
        beside=np.full(data.n, level),
        root=root,
        fit=Refit(found.theta, spread, _at_ends(found.theta), found.sigma),
        axes=spread.axes,
        stderr=spread.stderr(_ENDS),
        has_trend=True,
        independent=lambda: _spread_of(found, sums, data.n, correct=False),
        scored=lambda: Scored(
            data.t, point_scores(found.residual, root, found.sigma, found.loss), data.columns, root
        ),
        again=lambda values: _refit(request, data, values, quantisation),
    )
    return infer(fitted, request.uncertainty, request.level, options.resamples, request.seed)


def _at_ends(theta: FloatArray) -> FloatArray:
    """Values of a line at the ends of the frame, between which nothing of it lies farther off."""
    return np.asarray(theta[0] + _ENDS[:, 1] * theta[1], dtype=np.float64)


def _spread_of(found: Found, sums: FloatArray, n: int, *, correct: bool) -> LineUncertainty | None:
    return line_uncertainty(sums, n, found.sigma, found.spread, correct_serial_correlation=correct)


def _refit(
    request: Request, data: LineData, values: FloatArray, quantisation: Quantisation
) -> Refit[LineUncertainty] | None:
    """Run the whole procedure on other values at the same times."""
    again = LineData(data.t, values, data.weights)
    options = request.options
    scale = settle_scale(again, request.preset, request.threshold, request.sigma, quantisation, options)
    if isinstance(scale, NoFit):
        return None
    found = request.preset.search.run(again, scale, options, request.seed)
    if isinstance(found, NoFit):
        return None
    sums = found.sums
    if sums is None:
        root = None if data.weights is None else np.sqrt(data.weights)
        sums = influence_sums(data.t, values, found.residual, root, found.sigma, found.threshold, found.loss)
    spread = _spread_of(found, sums, data.n, correct=options.correct_serial_correlation)
    return None if spread is None else Refit(found.theta, spread, _at_ends(found.theta), found.sigma)


def _refuse(series: Series) -> NoFit | None:
    """Series through which no line can be drawn."""
    if series.n < 2:
        reason, message = NoFitReason.too_few_points, "One usable point; a line needs at least two."
    elif series.t[0] == series.t[-1]:
        reason, message = NoFitReason.constant_time, "All times are equal; a line needs two different times."
    else:
        return None
    return no_fit(reason, message, series)
