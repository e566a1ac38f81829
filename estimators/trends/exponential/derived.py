"""What people read off a rate: growth in per cent, doubling or halving time; and the mean over the median."""

from __future__ import annotations

import math

from scipy.special import chdtri

from estimators.result import Estimate
from estimators.trends.exponential.curve import ExponentialCurve
from estimators.trends.presentation.units import TimeUnit

_MOST_EXPONENT = 700.0
_LEAST_EFFECTIVE = 3.0
"""Independent inliers from which a variance has an interval: one more than the coefficients."""


def derived_estimates(
    curve: ExponentialCurve, rate: Estimate, unit: TimeUnit, level: float, effective_n: float | None
) -> dict[str, Estimate]:
    """Estimates that follow from the rate and the noise scale, intervals transformed along.

    Parameters
    ----------
    curve : ExponentialCurve
    rate : Estimate
        Per unit of the internal time.
    unit : TimeUnit
        In which growth is stated.
    level : float
        Confidence level.
    effective_n : float or None
        Independent inliers, from which the noise scale is known.

    Returns
    -------
    dict of str to Estimate
        ``growth_percent_per_<unit>``, left out where 64-bit floats cannot hold it; ``doubling_time`` or
        ``halving_time`` in the unit of time of the rate, with None for a limit that lies at infinity, left
        out where the rate is 0; ``mean_factor`` under multiplicative noise: exp(sigma^2 / 2), by which the
        mean exceeds the median (METHODS.md 11.3).
    """
    found: dict[str, Estimate] = {}
    if rate.value * unit.seconds <= _MOST_EXPONENT:
        found[f"growth_percent_per_{unit.name or 'unit'}"] = _growth(rate, unit.seconds)
    if rate.value != 0.0:
        found["doubling_time" if rate.value > 0.0 else "halving_time"] = _twofold_time(rate)
    if curve.noise == "multiplicative":
        found["mean_factor"] = _mean_factor(curve.sigma, level, effective_n)
    return found


def is_open(rate: Estimate) -> bool:
    """Whether the interval of a rate holds 0, so that a doubling or halving time has no upper limit."""
    return rate.low is not None and rate.high is not None and rate.low <= 0.0 <= rate.high


def _growth(rate: Estimate, length: float) -> Estimate:
    def percent(value: float | None) -> float | None:
        if value is None or value * length > _MOST_EXPONENT:
            return None
        return 100.0 * math.expm1(value * length)

    growth = 100.0 * math.expm1(rate.value * length)
    stderr = None if rate.stderr is None else 100.0 * math.exp(rate.value * length) * rate.stderr * length
    if stderr is not None and not math.isfinite(stderr):
        stderr = None
    return Estimate(growth, stderr, percent(rate.low), percent(rate.high))


def _twofold_time(rate: Estimate) -> Estimate:
    size = abs(rate.value)
    time = math.log(2.0) / size
    if rate.low is None or rate.high is None or rate.stderr is None:
        return Estimate(time, None, None, None)
    least, most = sorted(
        (math.copysign(1.0, rate.value) * rate.low, math.copysign(1.0, rate.value) * rate.high)
    )
    low = math.log(2.0) / most if most > 0.0 else None
    high = math.log(2.0) / least if least > 0.0 else None
    return Estimate(time, time * (rate.stderr / size), low, high)


def _mean_factor(sigma: float, level: float, effective_n: float | None) -> Estimate:
    factor = math.exp(min(0.5 * sigma * sigma, _MOST_EXPONENT))
    if effective_n is None or effective_n < _LEAST_EFFECTIVE:
        return Estimate(factor, None, None, None)
    # The chi-square law of a variance from so many independent readings, less two coefficients.
    dof = effective_n - 2.0
    tail = 0.5 * (1.0 - level)
    low, high = (
        math.exp(min(0.5 * sigma * sigma * dof / float(chdtri(dof, p)), _MOST_EXPONENT))
        for p in (tail, 1.0 - tail)
    )
    return Estimate(factor, factor * sigma * sigma / math.sqrt(2.0 * dof), low, high)
