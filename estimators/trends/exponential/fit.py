"""The exponential, fitted: in the domain of the noise that was asked for, or that the data speak for."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from estimators.arrays import InputError
from estimators.consensus.search.structure import StructureSearch
from estimators.notices import Notice, NoticeCode, notice
from estimators.result import NoFit, NoFitReason
from estimators.series import Series
from estimators.trends.exponential.curve import ExponentialCurve
from estimators.trends.exponential.derived import derived_estimates, is_open
from estimators.trends.exponential.domain import Noise
from estimators.trends.exponential.multiplicative import fit_multiplicative
from estimators.trends.exponential.native import fit_native, start_curves
from estimators.trends.exponential.selection import (
    UNDETERMINED,
    additive_evidence,
    background,
    multiplicative_evidence,
)
from estimators.trends.observations import input_notices
from estimators.trends.presentation.units import PLAIN, natural_unit
from estimators.trends.request import Request, no_fit
from estimators.trends.trend import RunnerUp, Trend

_LEAST_POINTS = 4
"""Readings from which the noise can be told at all: two of them fix the curve."""
_NEGLIGIBLE = 1e-60
_WEIGHED = 2000
"""Readings, spread over the series, by which the noise is told."""

_ABOUT_INPUT = frozenset(
    {
        NoticeCode.missing_values,
        NoticeCode.invalid_values,
        NoticeCode.unsorted_times,
        NoticeCode.duplicate_times,
        NoticeCode.float_nanoseconds,
    }
)
_EXACT = frozenset({NoticeCode.zero_noise, NoticeCode.constant_values})


def fit_exponential(request: Request) -> Trend | NoFit:
    """Fit exponential growth or decay.

    Parameters
    ----------
    request : Request

    Returns
    -------
    Trend or NoFit

    Raises
    ------
    InputError
        If the arguments contradict one another.
    """
    _check(request)
    request = _without_negligible(request)
    refused = _refuse(request.series)
    if refused is not None:
        return refused
    logs_only = not isinstance(request.preset.search, StructureSearch)
    if request.uncertainty != "effective-n" and request.noise == "auto" and not logs_only:
        # Which noise it is, the plain fits tell; how sure the answer is, is then asked in that domain.
        told = fit_exponential(dataclasses.replace(request, uncertainty="effective-n"))
        return told if isinstance(told, NoFit) else _inferred(request, told)
    relative = None if request.noise == "additive" else _multiplicative(request)
    if relative is not None and (request.noise == "multiplicative" or logs_only):
        if isinstance(relative, NoFit):
            return relative
        given = request.noise == "multiplicative"
        return _finish(relative, Noise("multiplicative", "given" if given else "method"))
    if relative is None:
        curves = start_curves(request)
    else:
        curves = () if isinstance(relative, NoFit) else (_curve(relative),)
    absolute = fit_native(request, curves)
    if request.noise == "additive":
        return absolute if isinstance(absolute, NoFit) else _finish(absolute, Noise("additive", "given"))
    if isinstance(absolute, NoFit) or relative is None:
        return absolute if relative is None or isinstance(relative, NoFit) else _alone(relative)
    return _alone(absolute) if isinstance(relative, NoFit) else _choose(request, relative, absolute)


def _check(request: Request) -> None:
    structure = isinstance(request.preset.search, StructureSearch)
    if request.noise == "additive" and not structure:
        raise InputError(
            "method",
            f"{request.preset.name} fits exponentials through their logarithms only; use auto, or "
            "noise='multiplicative'",
        )
    if request.noise == "auto":
        for field in ("threshold", "sigma"):
            if getattr(request, field) is not None:
                raise InputError(
                    field,
                    "say what noise it belongs to: noise='additive' (in units of the values) or "
                    "noise='multiplicative' (of ln(value))",
                )


def _without_negligible(request: Request) -> Request:
    """Take for zero what is nothing beside the largest value: divisions by it would overflow."""
    y = request.series.y
    negligible = np.abs(y) < _NEGLIGIBLE * np.abs(y).max(initial=0.0)
    if not np.any(negligible & (y != 0.0)):
        return request
    series = dataclasses.replace(request.series, y=np.where(negligible, 0.0, y))
    return dataclasses.replace(request, series=series)


def _refuse(series: Series) -> NoFit | None:
    """Series through which no exponential can be drawn."""
    if series.n < 2:
        reason, message = NoFitReason.too_few_points, "One usable point; an exponential needs at least two."
    elif series.t[0] == series.t[-1]:
        reason = NoFitReason.constant_time
        message = "All times are equal; an exponential needs two different times."
    elif not series.y.any():
        reason, message = (
            NoFitReason.no_consensus,
            "All values are 0; an exponential through them has no rate.",
        )
    else:
        return None
    return no_fit(reason, message, series)


def _inferred(request: Request, told: Trend) -> Trend:
    """Answer, and its alternative, with the uncertainty that was asked for."""
    again = fit_exponential(dataclasses.replace(request, noise=_curve(told).noise))
    if isinstance(again, NoFit):
        return told
    alternative = None if told.alternative is None else _inferred(request, told.alternative)
    about_noise = [item for item in told.notices if item.code is NoticeCode.undetermined_noise]
    return dataclasses.replace(
        again, noise=told.noise, alternative=alternative, notices=(*again.notices, *about_noise)
    )


def _multiplicative(request: Request) -> Trend | NoFit:
    """Line of the logarithms as an exponential."""
    found = fit_multiplicative(request)
    own = input_notices(request.series)
    if isinstance(found, NoFit):
        return dataclasses.replace(found, notices=(*own, *_left_out(request.series)))
    line, curve, left_out = found
    told = [item for item in line.notices if item.code not in _ABOUT_INPUT]
    rival = None if line.runner_up is None else _relative_rival(line, curve)
    if line.runner_up is not None:
        detail = {} if rival is None else dict(rival.parameters)
        told = [
            dataclasses.replace(item, detail=detail) if item.code is NoticeCode.ambiguous_structure else item
            for item in told
        ]
    return dataclasses.replace(
        line,
        model="exponential",
        parameters=curve.parameters(0.0, request.level, line.uncertainty.dof),
        origin=request.series.axis.origin,
        runner_up=rival,
        notices=(*own, *(_left_out(request.series) if left_out else ()), *told),
        geometry=curve,
    )


def _left_out(series: Series) -> tuple[Notice, ...]:
    positive, negative = (int(np.count_nonzero(side)) for side in (series.y > 0.0, series.y < 0.0))
    return (notice(NoticeCode.nonpositive_values, rows=series.n - max(positive, negative)),)


def _relative_rival(line: Trend, curve: ExponentialCurve) -> RunnerUp | None:
    """Runner-up of the logarithms' line, at the first time."""
    other = line.runner_up
    if other is None:
        return None
    # The line's intercept is the caller's 0 for plain numbers, the first time for points in time.
    since = 0.0 if isinstance(line.origin, np.datetime64) else float(line.axis.origin)
    log_level = other.parameters["intercept"] + other.parameters["slope"] * since
    if not abs(log_level) < 700.0:
        return None
    parameters = {"rate": other.parameters["slope"], "level": curve.sign * math.exp(log_level)}
    return dataclasses.replace(other, parameters=parameters)


def _curve(trend: Trend) -> ExponentialCurve:
    curve = trend.geometry
    if not isinstance(curve, ExponentialCurve):
        raise TypeError("an exponential has an exponential's curve")
    return curve


def _alone(trend: Trend) -> Trend:
    """Answer in the one domain that has one."""
    return _finish(trend, Noise(_curve(trend).noise, "selected"))


def _choose(request: Request, relative: Trend, absolute: Trend) -> Trend:
    """Answer in the domain that the data prefer, with the other one where they hardly do."""
    margin = _margin(request.series, _curve(relative), _curve(absolute))
    exact = all(_EXACT & {item.code for item in trend.notices} for trend in (relative, absolute))
    if exact or request.series.n < _LEAST_POINTS:
        margin = 0.0
    best, other = (relative, absolute) if margin >= 0.0 else (absolute, relative)
    if abs(margin) >= UNDETERMINED:
        return _finish(best, Noise(_curve(best).noise, "selected", abs(margin)))
    alternative = _finish(other, Noise(_curve(other).noise, "undetermined", -abs(margin)))
    answer = _finish(best, Noise(_curve(best).noise, "undetermined", abs(margin)))
    told = notice(NoticeCode.undetermined_noise, log_evidence=abs(margin), domain=_curve(best).noise)
    return dataclasses.replace(answer, alternative=alternative, notices=(*answer.notices, told))


def _margin(series: Series, relative: ExponentialCurve, absolute: ExponentialCurve) -> float:
    """Log evidence for multiplicative against additive noise."""
    part = np.arange(series.n)
    if series.n > _WEIGHED:
        part = (part[:_WEIGHED] * series.n) // _WEIGHED
    t, y = series.t[part], series.y[part]
    root = np.ones(part.size) if series.weights is None else np.sqrt(series.weights[part])
    size = float(np.abs(y).max())
    if size == 0.0:
        return 0.0
    # In units of the largest value: densities of very small or large values leave the range of floats.
    scaled = y / size
    density = background(scaled, relative.sign)
    own = absolute.in_value_units(1.0 / size)
    additive = additive_evidence(t, scaled - own.value(t), root, density, own.sigma)
    log_value = relative.in_value_units(1.0 / size).log_value(t)
    multiplicative = multiplicative_evidence(
        t, scaled, log_value, relative.sign, root, density, relative.sigma
    )
    return multiplicative - additive


def _finish(trend: Trend, noise: Noise) -> Trend:
    """Add what follows from the rate, and the noise."""
    first, last = trend.geometry.span
    unit = natural_unit(last - first) if trend.axis.kind == "datetime" else PLAIN
    rate = trend.parameters["rate"]
    level = trend.uncertainty.level
    derived = derived_estimates(_curve(trend), rate, unit, level, trend.uncertainty.effective_n)
    told: tuple[Notice, ...] = ()
    if is_open(rate):
        told = (notice(NoticeCode.rate_near_zero, low=rate.low, high=rate.high),)
    return dataclasses.replace(trend, noise=noise, derived=derived, notices=(*trend.notices, *told))
