"""The fitted exponential behind an answer: its values, its bands, its parameters."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.inference.intervals import student_quantile
from estimators.result import Estimate
from estimators.trends.curve import Bands
from estimators.trends.exponential.domain import NoiseDomain


@dataclass(frozen=True, slots=True)
class ExponentialCurve:
    """``sign * exp(log_level + rate * (t - center))`` with the standard errors of its logarithm.

    Attributes
    ----------
    noise : {"multiplicative", "additive"}
    sign : float
        1 or -1.
    center : float
        Time, since ``axis.origin``, at which log level and rate are uncorrelated.
    log_level, rate : float
        Of the curve's size at the center; change of its logarithm per unit of time.
    level_stderr, rate_stderr : float
        Standard errors of ``log_level`` and ``rate``; NaN where unknown.
    sigma : float
        Noise scale: of ln(value) under multiplicative noise, of values under additive noise.
    span : tuple of float
        First and last time of the data, since ``axis.origin``.
    """

    noise: NoiseDomain
    sign: float
    center: float
    log_level: float
    rate: float
    level_stderr: float
    rate_stderr: float
    sigma: float
    span: tuple[float, float]

    def log_value(self, at: FloatArray) -> FloatArray:
        """Logarithm of the curve's size at times."""
        return np.asarray(self.log_level + self.rate * (at - self.center), dtype=np.float64)

    def log_stderr(self, at: FloatArray) -> FloatArray:
        """Compute the standard error of :meth:`log_value`: the curve's over its value (delta method)."""
        return np.asarray(np.hypot(self.level_stderr, self.rate_stderr * (at - self.center)))

    def value(self, at: FloatArray) -> FloatArray:
        """Value of the curve at times; infinite beyond what 64-bit floats hold."""
        return _signed_exp(self.sign, self.log_value(at))

    def bands(self, at: FloatArray, quantile: float) -> Bands:
        """Value and bands: on the logarithm's scale under multiplicative noise, else by the delta method.

        Under multiplicative noise the value is the conditional *median*.
        """
        log_value, stderr = self.log_value(at), self.log_stderr(at)
        value = _signed_exp(self.sign, log_value)
        if self.noise == "additive":
            with np.errstate(over="ignore", invalid="ignore"):
                errors = np.abs(value) * stderr
                half = quantile * errors
                wide = quantile * np.hypot(errors, self.sigma)
                return Bands(value, value - half, value + half, value - wide, value + wide)
        half = quantile * stderr
        wide = quantile * np.hypot(stderr, self.sigma)
        limits = [_signed_exp(self.sign, log_value + self.sign * off) for off in (-half, half, -wide, wide)]
        return Bands(value, *limits)

    def in_value_units(self, unit: float) -> ExponentialCurve:
        """Multiply all that is in units of the values."""
        sigma = self.sigma * unit if self.noise == "additive" else self.sigma
        return dataclasses.replace(self, log_level=self.log_level + math.log(unit), sigma=sigma)

    def parameters(self, at: float, level: float, dof: float | None) -> dict[str, Estimate]:
        """Rate, and level at a time, with intervals.

        Parameters
        ----------
        at : float
            Internal time at which the level is taken.
        level : float
            Confidence level.
        dof : float or None
            None leaves the uncertainty out.
        """
        there = np.array([at])
        quantile = student_quantile(level, dof)
        bands = self.bands(there, quantile)
        value = float(bands.value[0])
        if dof is None:
            return {"rate": Estimate(self.rate, None, None, None), "level": Estimate(value, None, None, None)}
        half = quantile * self.rate_stderr
        stderr = abs(value) * float(self.log_stderr(there)[0])
        low, high = float(bands.confidence_low[0]), float(bands.confidence_high[0])
        return {
            "rate": Estimate(self.rate, self.rate_stderr, self.rate - half, self.rate + half),
            "level": Estimate(value, *(x if math.isfinite(x) else None for x in (stderr, low, high))),
        }


def _signed_exp(sign: float, exponent: FloatArray) -> FloatArray:
    with np.errstate(over="ignore", under="ignore"):
        return np.asarray(sign * np.exp(exponent), dtype=np.float64)
