"""From an exponential found under additive noise to a :class:`~estimators.trends.trend.Trend`."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from estimators.arrays import LARGEST_VALUE, FloatArray
from estimators.consensus.found import OtherStructure, Scale
from estimators.inference.intervals import two_sided_p
from estimators.inference.probability import inlier_probability
from estimators.inference.sandwich import LineUncertainty
from estimators.noise.resolution import Quantisation, find_quantisation, scale_floor
from estimators.regression.influence import SUPPORT, influence_sums
from estimators.result import NoFit, NoFitReason
from estimators.trends.account import account_of
from estimators.trends.exponential.additive import AdditiveFit, find_additive
from estimators.trends.exponential.curve import ExponentialCurve
from estimators.trends.exponential.multiplicative import fit_multiplicative
from estimators.trends.exponential.uncertainty import NativeFit, infer_native
from estimators.trends.labels import label_rows
from estimators.trends.line.fit import LEAST_FLOOR
from estimators.trends.line.frame import Frame
from estimators.trends.magnitude import in_value_units, value_unit
from estimators.trends.observations import Evidence, collect_notices
from estimators.trends.quality import fit_quality
from estimators.trends.request import Request, no_fit
from estimators.trends.runner_up import LEAST_MARGIN, LEAST_SUPPORT, NOTABLE_SHARE, RIVAL_SHARE
from estimators.trends.trend import RunnerUp, Trend


def fit_native(request: Request, curves: tuple[ExponentialCurve, ...]) -> Trend | NoFit:
    """Fit an exponential under additive noise.

    Parameters
    ----------
    request : Request
        Threshold and sigma are in units of the values.
    curves : tuple of ExponentialCurve
        Where to look first, beside the curves through pairs of readings.
    """
    unit = value_unit(request.series.y)
    if unit == 1.0:
        return _fit(request, curves)
    threshold, sigma = request.threshold, request.sigma
    magnified = dataclasses.replace(
        request,
        series=dataclasses.replace(request.series, y=request.series.y / unit),
        threshold=None if threshold is None else min(threshold / unit, LARGEST_VALUE),
        sigma=None if sigma is None else min(sigma / unit, LARGEST_VALUE),
    )
    trend = _fit(magnified, tuple(curve.in_value_units(1.0 / unit) for curve in curves))
    return trend if isinstance(trend, NoFit) else in_value_units(trend, unit)


def _fit(request: Request, curves: tuple[ExponentialCurve, ...]) -> Trend | NoFit:
    series = request.series
    frame = Frame.of(series.t)
    quantisation = find_quantisation(series.y, series.t)
    native = _find(request, curves, frame, quantisation)
    if isinstance(native, NoFit):
        return native

    def again(values: FloatArray) -> NativeFit | None:
        asked = dataclasses.replace(request, series=dataclasses.replace(series, y=values))
        replicate = _find(asked, start_curves(asked), frame, quantisation)
        return None if isinstance(replicate, NoFit) else replicate

    fit, residual, t = native.fit, native.residual, native.t
    found, unit = fit.found, fit.unit
    own_root = None if series.weights is None else np.sqrt(series.weights)
    sigma, threshold = found.sigma * unit, found.threshold * unit
    floor = _floor(request, quantisation)
    r2, rmse = fit_quality(influence_sums(t, series.y, residual, own_root, sigma, threshold, found.loss))
    inferred = infer_native(request, native, again)
    spread = inferred.spread
    curve = _curve_of(native, frame, spread, (float(series.t[0]), float(series.t[-1])))
    off = np.abs(residual) if own_root is None else np.abs(residual) * own_root
    inlier = off <= threshold
    inliers = int(np.count_nonzero(inlier))
    dof = None if spread is None else spread.dof
    own = dataclasses.replace(found, residual=residual, inlier=inlier, sigma=sigma, threshold=threshold)
    other = _rival(fit.other, frame, inliers, own.sigma, unit)
    probability = inlier_probability(residual, own_root, max(sigma, floor))
    evidence = Evidence(series, request.preset, own, inliers, spread, quantisation, floor, rmse, other)
    return Trend(
        model="exponential",
        parameters=curve.parameters(0.0, request.level, dof),
        origin=series.axis.origin,
        points=label_rows(series, inlier, probability, residual),
        consensus=account_of(request, own, inliers),
        uncertainty=inferred.describe(request.level),
        p_value=two_sided_p(_statistic(curve), dof) if inferred.p_value is None else inferred.p_value,
        r2=r2,
        rmse=rmse,
        runner_up=other,
        notices=collect_notices(evidence),
        axis=series.axis,
        geometry=curve,
        time=series.input_time,
        values=series.input_values,
    )


def start_curves(request: Request) -> tuple[ExponentialCurve, ...]:
    """Find where to look first: the line through the logarithms, to which no scale of the values applies."""
    plain = dataclasses.replace(request, threshold=None, sigma=None, uncertainty="effective-n")
    found = fit_multiplicative(plain)
    return () if isinstance(found, NoFit) else (found[1],)


def _floor(request: Request, quantisation: Quantisation) -> float:
    floor = max(scale_floor(request.series.y, quantisation), LEAST_FLOOR)
    return floor if request.sigma is None else min(floor, request.sigma)


def _find(
    request: Request, curves: tuple[ExponentialCurve, ...], frame: Frame, quantisation: Quantisation
) -> NativeFit | NoFit:
    """Search, and what its uncertainty is made from."""
    series = request.series
    t = frame.apply(series.t)
    scale = Scale(request.sigma, "given", request.threshold, "given", _floor(request, quantisation))
    seeds = np.array([_in_frame(curve, frame) for curve in curves]).reshape(-1, 2)
    largest = max((_largest(curve, request) for curve in curves), default=0.0)
    fit = find_additive(t, series.y, series.weights, scale, request.options, seeds, largest)
    if isinstance(fit, NoFit):
        return no_fit(fit.reason, fit.message, series)
    if fit is None:
        message = "No exponential stands out: no two of the values, of one sign, have others follow them."
        return no_fit(NoFitReason.no_consensus, message, series)
    found, root = fit.found, np.sqrt(np.asarray(fit.data.weights))
    sums = influence_sums(
        fit.data.t, fit.data.y, found.residual, root, found.sigma, found.threshold, found.loss
    )
    residual = series.y - _values(fit, t)
    own_root = None if series.weights is None else np.sqrt(series.weights)
    sigma, threshold = found.sigma * fit.unit, found.threshold * fit.unit
    # The line's precisions are a matter of geometry: by their own, all readings are worth the same.
    sums[SUPPORT] = influence_sums(t, series.y, residual, own_root, sigma, threshold, found.loss)[SUPPORT]
    return NativeFit(fit, t, residual, sums)


def _in_frame(curve: ExponentialCurve, frame: Frame) -> tuple[float, float]:
    """Level at frame time 0 and rate in the frame."""
    at_middle = curve.log_level + curve.rate * (frame.middle - curve.center)
    return curve.sign * math.exp(min(max(at_middle, -700.0), 700.0)), curve.rate * frame.half


def _largest(curve: ExponentialCurve, request: Request) -> float:
    """Size of the largest reading that is near a curve, by its noise scale."""
    y, t = request.series.y, request.series.t
    with np.errstate(over="ignore", under="ignore"):
        near = np.abs(y) <= np.exp(curve.log_value(t) + 5.0 * min(curve.sigma, 1.0))
    return float(np.abs(y[near]).max()) if near.any() else 0.0


def _values(fit: AdditiveFit, t: FloatArray) -> FloatArray:
    """Curve at times in the frame, in units of the values."""
    return np.asarray(float(fit.found.theta[0]) * fit.unit * np.exp(fit.rate * (t - fit.anchor)))


def _curve_of(
    native: NativeFit, frame: Frame, spread: LineUncertainty | None, span: tuple[float, float]
) -> ExponentialCurve:
    fit = native.fit
    amplitude = float(fit.found.theta[0])
    center = fit.anchor if spread is None else spread.center
    nothing = math.nan
    return ExponentialCurve(
        noise="additive",
        sign=math.copysign(1.0, amplitude),
        center=frame.middle + frame.half * center,
        log_level=math.log(abs(amplitude) * fit.unit) + fit.rate * (center - fit.anchor),
        rate=fit.rate / frame.half,
        level_stderr=nothing if spread is None else math.sqrt(spread.level_variance),
        rate_stderr=nothing if spread is None else math.sqrt(spread.slope_variance) / frame.half,
        sigma=fit.found.sigma * fit.unit,
        span=span,
    )


def _rival(
    other: OtherStructure | None, frame: Frame, own: int, sigma: float, unit: float
) -> RunnerUp | None:
    if other is None or other.inliers < max(LEAST_SUPPORT, NOTABLE_SHARE * own):
        return None
    level, rate = float(other.theta[0]), float(other.theta[1])
    log_level = math.log(abs(level) * unit) - rate * frame.middle / frame.half if level else -math.inf
    if not abs(log_level) < 700.0:
        return None
    same_scatter = 0.5 * sigma <= other.sigma * unit <= 2.0 * sigma
    return RunnerUp(
        parameters={"rate": rate / frame.half, "level": math.copysign(math.exp(log_level), level)},
        inliers=other.inliers,
        sigma=other.sigma * unit,
        equally_good=other.margin < LEAST_MARGIN or (same_scatter and other.inliers >= RIVAL_SHARE * own),
    )


def _statistic(curve: ExponentialCurve) -> float:
    if curve.rate_stderr == 0.0:
        return math.copysign(math.inf, curve.rate) if curve.rate else 0.0
    return curve.rate / curve.rate_stderr
