"""The fitted curve behind an answer: what a shape of trend knows how to compute at any time.

Every shape brings its own curve; prediction, pictures, tables and changes of unit ask for nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np

from estimators.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Bands:
    """A curve and its two bands at given times; NaN where the data leave no way to tell.

    Attributes
    ----------
    value : ndarray of float64, shape (k,)
    confidence_low, confidence_high : ndarray of float64, shape (k,)
        Where the *trend* lies.
    prediction_low, prediction_high : ndarray of float64, shape (k,)
        Where a *new inlier* of mean weight will lie.
    """

    value: FloatArray
    confidence_low: FloatArray
    confidence_high: FloatArray
    prediction_low: FloatArray
    prediction_high: FloatArray


class Curve(Protocol):
    """A fitted curve. Times are internal ones: float64 since ``Trend.axis.origin``."""

    @property
    def span(self) -> tuple[float, float]:
        """First and last time of the data."""
        ...

    def value(self, at: FloatArray) -> FloatArray:
        """Trend at times, shape (k,)."""
        ...

    def bands(self, at: FloatArray, quantile: float) -> Bands:
        """Trend with bands that reach ``quantile`` standard errors to either side."""
        ...

    def in_value_units(self, unit: float) -> Self:
        """Turn the curve of ``y / unit`` into that of ``y``."""
        ...


@dataclass(frozen=True, slots=True)
class LineGeometry:
    """The fitted line in centred form, from which bands are computed without loss of digits.

    Attributes
    ----------
    center : float
        Time, since ``axis.origin``, at which level and slope are uncorrelated.
    level, slope : float
        Value at the center; change per unit of time.
    level_stderr, slope_stderr : float
        Standard errors; NaN where unknown.
    sigma : float
    span : tuple of float
        First and last time of the data, since ``axis.origin``.
    """

    center: float
    level: float
    slope: float
    level_stderr: float
    slope_stderr: float
    sigma: float
    span: tuple[float, float]

    def value(self, at: FloatArray) -> FloatArray:
        """Value of the line at times."""
        return np.asarray(self.level + self.slope * (at - self.center), dtype=np.float64)

    def bands(self, at: FloatArray, quantile: float) -> Bands:
        """Value and bands of the line at times."""
        value = self.value(at)
        # hypot: standard errors of tiny values have squares that underflow.
        stderr = np.hypot(self.level_stderr, self.slope_stderr * (at - self.center))
        half = quantile * stderr
        wide = quantile * np.hypot(stderr, self.sigma)
        return Bands(value, value - half, value + half, value - wide, value + wide)

    def in_value_units(self, unit: float) -> LineGeometry:
        """Multiply all that is in units of the values."""
        return LineGeometry(
            center=self.center,
            level=self.level * unit,
            slope=self.slope * unit,
            level_stderr=self.level_stderr * unit,
            slope_stderr=self.slope_stderr * unit,
            sigma=self.sigma * unit,
            span=self.span,
        )
