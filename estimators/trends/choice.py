"""``model="auto"``: shapes weighed against each other on the same values, and the evidence for each.

Every candidate is fitted as if it had been asked for. What it leaves unexplained is then weighed in the same
way for all: the likelihood of the values under noise, correlated or not, uniform outliers and excursions,
less half a ln n per coefficient (Schwarz 1978), less what chance finds. Among n points there are some n^p
curves of p coefficients to look through, and the fewer points a curve has to hold, the better the best of
them looks; and a slope, then a bend has to be twenty times as likely as none. Noise that grows with the level
is weighed in the units of the values too: the density of ln(value) times 1 / value.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.bases.likelihood import noise_evidence, value_range
from estimators.result import NoFit
from estimators.series import Series
from estimators.trends.bases.curve import BasisCurve
from estimators.trends.bases.design import Design, frame_of
from estimators.trends.bases.fit import fit_constant, fit_linear, fit_straight
from estimators.trends.bases.periods import find_periods
from estimators.trends.evidence import Evidence
from estimators.trends.exponential.fit import fit_exponential
from estimators.trends.request import Request
from estimators.trends.trend import Trend

_DEGREE = 2
_FINEST = 1e-9
"""Least noise scale in units of the range of the values: finer ones are all called exact."""
_LEAST_RATIO = np.finfo(np.float64).tiny
_LEAST_READING = 1e-150
"""In the scale of the data; below, a reading is as good as zero, which has no logarithm."""
_IMPOSSIBLE = 1e6
_CHANCE = 2.0
"""Price of a coefficient in ln n, times the share of the points that do not follow the curve."""
_TWENTY_TIMES = math.log(20.0)
"""Price of each step away from a level: to a slope, to a bend."""


def fit_auto(request: Request) -> Trend | NoFit:
    """Fit a level, a line, a parabola and an exponential, and answer with the one the values speak for.

    Parameters
    ----------
    request : Request
        Seasons, where asked for, are part of every shape; an exponential has none and is then left out.

    Returns
    -------
    Trend or NoFit
        With the evidence for every shape that could be fitted; ``NoFit`` of the level if none could.
    """
    uncertainty = request.uncertainty
    request = _with_periods(dataclasses.replace(request, uncertainty="effective-n"))
    parabola = dataclasses.replace(request, basis=dataclasses.replace(request.basis, degree=_DEGREE))
    candidates: list[tuple[Request, Callable[[Request], Trend | NoFit]]] = [
        (request, fit_constant),
        (request, fit_straight),
        (parabola, fit_linear),
    ]
    if request.basis.is_plain and (request.threshold is None and request.sigma is None):
        candidates.append((request, fit_exponential))
    elif request.basis.is_plain and request.preset.name == "auto":
        # A scale that was given is one of the values, whose noise is then the same at every level.
        candidates.append((dataclasses.replace(request, noise="additive"), fit_exponential))
    fits = [fit(asked) for asked, fit in candidates]
    trends = [
        (trend, candidate)
        for trend, candidate in zip(fits, candidates, strict=True)
        if isinstance(trend, Trend)
    ]
    if not trends:
        return next(failed for failed in fits if isinstance(failed, NoFit))
    weighed = [(_log_evidence(trend, request.series), trend, candidate) for trend, candidate in trends]
    # The first of equals is the simplest.
    weighed.sort(key=lambda triple: -triple[0])
    best, chosen, (asked, fit) = weighed[0]
    evidence = tuple(_row(trend, value, best - value, trend is chosen) for value, trend, _ in weighed)
    # A level has no trend whose p-value could be counted: its interval is the formula's.
    if uncertainty != "effective-n" and not (uncertainty == "permutation" and chosen.model == "constant"):
        inferred = fit(dataclasses.replace(asked, uncertainty=uncertainty))
        chosen = inferred if isinstance(inferred, Trend) else chosen
    return dataclasses.replace(chosen, evidence=evidence)


def _with_periods(request: Request) -> Request:
    """Find the periods once, about a parabola, so that all shapes are given the same ones."""
    if request.basis.seasonal != "auto":
        return request
    series = request.series
    periods: tuple[float, ...] = ()
    if series.t[-1] > series.t[0]:
        periods = find_periods(Design(frame_of(series.t), _DEGREE), series, {})
    basis = dataclasses.replace(request.basis, seasonal=periods or None, found=True)
    return dataclasses.replace(request, basis=basis)


def _log_evidence(trend: Trend, series: Series) -> float:
    """Log-likelihood of the values less the price of the coefficients, of the search and of a trend."""
    y = series.y
    unit = value_range(y)
    fitted = trend.geometry.value(series.t)
    root = np.ones(y.size) if series.weights is None else np.sqrt(series.weights)
    if trend.noise is not None and trend.noise.domain == "multiplicative":
        residual, scale = _of_logarithms(y / unit, fitted / unit)
        root = root * scale
        sigma, floor = trend.consensus.sigma, _FINEST
    else:
        with np.errstate(over="ignore", invalid="ignore"):
            residual = np.nan_to_num(
                (y - fitted) / unit, nan=_IMPOSSIBLE, posinf=_IMPOSSIBLE, neginf=-_IMPOSSIBLE
            )
        sigma, floor = trend.consensus.sigma / unit, _FINEST
    likelihood = noise_evidence(np.ascontiguousarray(residual), np.ascontiguousarray(root), sigma, floor)
    price = 0.5 + _CHANCE * (1.0 - trend.consensus.inlier_ratio)
    likelihood -= price * _coefficients(trend) * math.log(series.n)
    return likelihood - _bends(trend) * _TWENTY_TIMES


def _of_logarithms(y: FloatArray, fitted: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Residuals of ln(value), each times its value, and the 1 / value that turns them back.

    A density of residuals times the second is one of values. Values that have no logarithm are impossible
    under this noise: outliers.
    """
    possible = (np.minimum(y * np.sign(fitted), np.abs(fitted)) > _LEAST_READING) & np.isfinite(fitted)
    size = np.where(possible, np.abs(y), 1.0)
    # A reading of 1e-93 where 1e231 was fitted has a quotient below the least number.
    ratio = np.maximum(np.where(possible, y / np.where(possible, fitted, 1.0), 1.0), _LEAST_RATIO)
    residual = np.where(possible, size * np.log(ratio), _IMPOSSIBLE)
    return residual, 1.0 / size


def _bends(trend: Trend) -> int:
    curve = trend.geometry
    return curve.design.degree if isinstance(curve, BasisCurve) else 1


def _coefficients(trend: Trend) -> int:
    curve = trend.geometry
    return curve.design.size if isinstance(curve, BasisCurve) else 2


def _row(trend: Trend, value: float, margin: float, chosen: bool) -> Evidence:
    curve = trend.geometry
    return Evidence(
        model=trend.model,
        degree=curve.design.degree if isinstance(curve, BasisCurve) and trend.model == "linear" else None,
        coefficients=_coefficients(trend),
        log_evidence=value,
        margin=margin,
        sigma=trend.consensus.sigma,
        inliers=trend.consensus.inliers,
        chosen=chosen,
    )
