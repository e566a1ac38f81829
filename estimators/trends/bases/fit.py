"""A trend of columns, fitted: make the design, settle the scale, search, infer, label, say what was seen."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping

import numpy as np

from estimators.arrays import FloatArray, InputError
from estimators.consensus.bases.likelihood import noise_evidence, value_range
from estimators.consensus.found import Found, LinearData, LineData, Scale
from estimators.inference.columns import ColumnUncertainty
from estimators.inference.intervals import two_sided_p
from estimators.inference.probability import inlier_probability
from estimators.noise.resolution import Quantisation, find_quantisation
from estimators.regression.influence import INLIERS
from estimators.regression.least_squares import least_squares
from estimators.result import Estimate, NoFit, NoFitReason
from estimators.trends.account import account_of
from estimators.trends.bases.curve import BasisCurve
from estimators.trends.bases.design import Design, OwnColumn, frame_of
from estimators.trends.bases.harmonics import first_seasons, more_harmonics, sharpest
from estimators.trends.bases.parameters import parameters_of, polynomial_directions
from estimators.trends.bases.periods import find_periods
from estimators.trends.bases.settings import periods_of
from estimators.trends.bases.uncertainty import FittedColumns, check_uncertainty, infer_columns
from estimators.trends.labels import label_rows
from estimators.trends.line.fit import fit_line, origin_of, settle_scale
from estimators.trends.observations import Evidence, collect_notices
from estimators.trends.quality import fit_quality
from estimators.trends.request import Request, no_fit
from estimators.trends.resampling import Inferred
from estimators.trends.runner_up import LEAST_MARGIN, LEAST_SUPPORT, NOTABLE_SHARE, RIVAL_SHARE
from estimators.trends.trend import RunnerUp, Trend

_FINEST = 1e-9
"""Least noise scale, in units of the range of the values, that is told from a finer one."""


def fit_constant(request: Request) -> Trend | NoFit:
    """Fit a level, with seasons where they are asked for."""
    return _fit(request, "constant", 0)


def fit_straight(request: Request) -> Trend | NoFit:
    """Fit a straight line, with seasons where they are asked for."""
    return fit_line(request) if request.basis.is_plain else _fit(request, "line", 1)


def fit_linear(request: Request) -> Trend | NoFit:
    """Fit a polynomial, with seasons and the caller's own columns where they are asked for."""
    degree = request.basis.degree
    return _fit(request, "linear", 1 if degree is None else degree)


def _fit(request: Request, model: str, degree: int) -> Trend | NoFit:
    series = request.series
    check_uncertainty(request, model, degree)
    if degree > 0 and series.t[0] == series.t[-1]:
        message = "All times are equal; a trend needs two different times."
        return no_fit(NoFitReason.constant_time, message, series)
    own = _own_columns(request)
    design = Design(
        frame_of(series.t), degree, own=tuple(OwnColumn.of(name, values) for name, values in own.items())
    )
    design = _with_seasons(design, request, own)
    quantisation = find_quantisation(series.y, series.t)
    fitted = _search(design, request, own, quantisation)
    if isinstance(fitted, NoFit):
        return fitted
    if design.seasons and request.basis.harmonics is None:
        # A sharp season looks like outliers to a smooth one: the sharpest is tried as well, and compared.
        for longer in (_longer(design, request, own, fitted), sharpest(design, series.t)):
            refitted = fitted if longer == design else _search(longer, request, own, quantisation)
            if not isinstance(refitted, NoFit) and _evidence(*refitted) > _evidence(*fitted):
                design, fitted = longer, refitted
    supported = _supported(design, request, fitted)
    if supported != design:
        refitted = _search(supported, request, own, quantisation)
        if not isinstance(refitted, NoFit):
            design, fitted = supported, refitted

    def again(values: FloatArray) -> FittedColumns | None:
        asked = dataclasses.replace(request, series=dataclasses.replace(request.series, y=values))
        refitted = _search(design, asked, own, quantisation)
        return None if isinstance(refitted, NoFit) else FittedColumns.of(refitted[0], refitted[2])

    data, scale, found = fitted
    columns = FittedColumns.of(data, found)
    inferred = infer_columns(request, design, columns, again)
    return _answer(design, request, model, quantisation, scale, columns, inferred)


def _own_columns(request: Request) -> dict[str, FloatArray]:
    """Take the caller's columns at the usable points."""
    series = request.series
    rows = slice(None) if series.rows is None else series.rows
    found = {}
    for name, values in request.basis.columns.items():
        if values.size != series.n_input:
            raise InputError(
                "columns", f"{name}: {values.size} entries for {series.n_input} rows; give one each"
            )
        found[name] = np.ascontiguousarray(values[rows])
        if not np.all(np.isfinite(found[name])):
            raise InputError("columns", f"{name}: an entry is missing or infinite; leave its row out")
        if OwnColumn.of(name, found[name]).size == 0.0:
            raise InputError("columns", f"{name}: all entries are equal; leave the column out")
    return found


def _with_seasons(design: Design, request: Request, own: Mapping[str, FloatArray]) -> Design:
    series, seasonal = request.series, request.basis.seasonal
    span = float(series.t[-1] - series.t[0])
    if not seasonal or span == 0.0:
        return design
    if seasonal == "auto":
        periods = find_periods(design, series, own)
        seasons = first_seasons(series.t, periods, request.basis.harmonics, True)
    else:
        periods = periods_of(seasonal, series.axis)
        if periods[0] > span:
            raise InputError(
                "seasonal",
                f"a period of {periods[0]:.6g} is longer than the series, which spans {span:.6g}; "
                "its season cannot be told from the trend",
            )
        seasons = first_seasons(series.t, periods, request.basis.harmonics, request.basis.found)
    return design.with_seasons(seasons)


def _search(
    design: Design, request: Request, own: Mapping[str, FloatArray], quantisation: Quantisation
) -> tuple[LinearData, Scale, Found] | NoFit:
    series, options = request.series, request.options
    u = design.frame.apply(series.t)
    data: LinearData
    if design.size == 2 and design.degree == 1:
        data = LineData(u, series.y, series.weights)
    else:
        data = LinearData(design.columns(series.t, own or None), series.y, u, series.weights)
    if data.n < data.p:
        message = f"{data.n} usable points; the model has {data.p} coefficients and needs as many."
        return no_fit(NoFitReason.too_few_points, message, series)
    if least_squares(data.columns, series.y, series.weights)[2] < data.p:
        message = (
            "The times do not determine all coefficients: take fewer harmonics, a lower degree or longer "
            "periods, or leave out columns that follow from others."
        )
        return no_fit(NoFitReason.too_few_points, message, series)
    scale = settle_scale(data, request.preset, request.threshold, request.sigma, quantisation, options)
    if isinstance(scale, NoFit):
        return no_fit(scale.reason, scale.message, series)
    found = request.preset.search.run(data, scale, options, request.seed)
    if isinstance(found, NoFit):
        return no_fit(found.reason, found.message, series)
    return data, scale, found


def _longer(
    design: Design, request: Request, own: Mapping[str, FloatArray], fitted: tuple[LinearData, Scale, Found]
) -> Design:
    """Design with as many harmonics as the inliers support."""
    data, _, found = fitted
    spread = FittedColumns.of(data, found).spread(correct=request.options.correct_serial_correlation)
    if spread is None or own:
        return design
    precision = np.ones(data.n) if data.weights is None else data.weights
    weights = np.where(found.inlier, precision, 0.0)
    return more_harmonics(design, request.series.t, data.columns, data.y, weights, spread.effective_n)


def _evidence(data: LinearData, scale: Scale, found: Found) -> float:
    """Log-likelihood of the values, outliers included, less the price of the coefficients (Schwarz 1978)."""
    unit = value_range(data.y)
    root = np.ones(data.n) if data.weights is None else np.sqrt(data.weights)
    floor = max(scale.floor / unit, _FINEST)
    value = noise_evidence(found.residual / unit, root, found.sigma / unit, floor)
    return value - 0.5 * data.p * math.log(data.n)


def _supported(design: Design, request: Request, fitted: tuple[LinearData, Scale, Found]) -> Design:
    """Design without those seasons found in the data that its inliers do not support after all."""
    if not any(season.chosen for season in design.seasons):
        return design
    data, _, found = fitted
    spread = FittedColumns.of(data, found).spread(correct=request.options.correct_serial_correlation)
    if spread is None:
        return design
    kept = []
    for index, season in enumerate(design.seasons):
        part = design.season(index)
        theta, covariance = found.theta[part], spread.plain[part, part]
        gain = float(np.sum(theta * np.linalg.solve(covariance, theta)))
        # Schwarz (1978): each coefficient has to pay ln n in twice the log-likelihood.
        if gain > 2.0 * season.harmonics * math.log(max(spread.effective_n, math.e)):
            kept.append(season)
    return design.with_seasons(tuple(kept))


def _answer(
    design: Design,
    request: Request,
    model: str,
    quantisation: Quantisation,
    scale: Scale,
    fit: FittedColumns,
    inferred: Inferred[ColumnUncertainty],
) -> Trend:
    series, preset = request.series, request.preset
    found, sums, spread = fit.found, fit.sums, inferred.spread
    origin, intercept_at = origin_of(series)
    constant = "level" if model == "constant" else "intercept"
    parameters = parameters_of(design, found.theta, spread, intercept_at, constant, request.level)
    probability = found.probability
    if probability is None:
        root = None if series.weights is None else np.sqrt(series.weights)
        probability = inlier_probability(found.residual, root, max(found.sigma, scale.floor))
    inliers = int(sums[INLIERS])
    r2, rmse = fit_quality(sums)
    runner_up = _runner_up(design, found, inliers, intercept_at, constant)
    evidence = Evidence(series, preset, found, inliers, spread, quantisation, scale.floor, rmse, runner_up)
    return Trend(
        model=model,
        parameters=parameters,
        origin=origin,
        points=label_rows(series, found.inlier, probability, found.residual),
        consensus=account_of(request, found, inliers),
        uncertainty=inferred.describe(request.level),
        p_value=_p_value(parameters.get("slope"), spread) if inferred.p_value is None else inferred.p_value,
        r2=r2,
        rmse=rmse,
        runner_up=runner_up,
        notices=collect_notices(evidence),
        axis=series.axis,
        geometry=BasisCurve(
            design=design,
            theta=found.theta,
            uncertainty=spread,
            sigma=found.sigma,
            span=(float(series.t[0]), float(series.t[-1])),
            rows=request.basis.columns,
        ),
        time=series.input_time,
        values=series.input_values,
        seasons=design.seasons,
    )


def _runner_up(
    design: Design, found: Found, inliers: int, intercept_at: float, constant: str
) -> RunnerUp | None:
    """Report the search's own second structure, where it has enough points of its own."""
    other = found.runner_up
    if other is None or other.inliers < max(LEAST_SUPPORT, design.size + 1, NOTABLE_SHARE * inliers):
        return None
    same_scatter = 0.5 * found.sigma <= other.sigma <= 2.0 * found.sigma
    directions = polynomial_directions(design, intercept_at, constant)
    return RunnerUp(
        parameters={name: float(np.sum(other.theta * row)) for name, row in directions.items()},
        inliers=other.inliers,
        sigma=other.sigma,
        equally_good=other.margin < LEAST_MARGIN or (same_scatter and other.inliers >= RIVAL_SHARE * inliers),
    )


def _p_value(slope: Estimate | None, spread: ColumnUncertainty | None) -> float | None:
    """Of "there is no change over the span"; a trend without a slope has none to test."""
    if slope is None or slope.stderr is None or spread is None:
        return None
    if slope.stderr == 0.0:
        return two_sided_p(math.copysign(math.inf, slope.value) if slope.value else 0.0, spread.dof)
    return two_sided_p(slope.value / slope.stderr, spread.dof)
