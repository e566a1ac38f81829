"""The fitted curve of a trend of columns."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from estimators.arrays import FloatArray
from estimators.inference.columns import ColumnUncertainty
from estimators.trends.bases.design import Design
from estimators.trends.curve import Bands


@dataclass(frozen=True, slots=True)
class BasisCurve:
    """A trend that is linear in its coefficients.

    Attributes
    ----------
    design : Design
    theta : ndarray of float64, shape (p,)
    uncertainty : ColumnUncertainty or None
        In units of the values.
    sigma : float
    span : tuple of float
        First and last time of the data, since ``axis.origin``.
    unit : float
        What standard errors are still to be multiplied by, so that their squares do not underflow.
    rows : mapping of str to ndarray of float64, shape (n,)
        The caller's own columns, one entry per input row; at other times than those of the rows, unless they
        are given, they stand at their means.
    """

    design: Design
    theta: FloatArray
    uncertainty: ColumnUncertainty | None
    sigma: float
    span: tuple[float, float]
    unit: float = 1.0
    rows: Mapping[str, FloatArray] = field(default_factory=dict, repr=False)

    def value(self, at: FloatArray) -> FloatArray:
        """Trend at times; of the caller's own columns at their means."""
        return self.value_with(at, None)

    def value_with(self, at: FloatArray, own: Mapping[str, FloatArray] | None) -> FloatArray:
        """Trend at times, with the caller's own columns at these times."""
        return weighted_sum(self.design.columns(at, own), self.theta)

    def bands(self, at: FloatArray, quantile: float) -> Bands:
        """Trend with bands; of the caller's own columns at their means."""
        return self.bands_with(at, quantile, None)

    def bands_with(self, at: FloatArray, quantile: float, own: Mapping[str, FloatArray] | None) -> Bands:
        """Trend with bands, with the caller's own columns at these times."""
        columns = self.design.columns(at, own)
        value = weighted_sum(columns, self.theta)
        if self.uncertainty is None:
            stderr = np.full(at.size, np.nan)
        else:
            stderr = self.uncertainty.stderr(columns.T) * self.unit
        half = quantile * stderr
        # hypot: standard errors of tiny values have squares that underflow.
        wide = quantile * np.hypot(stderr, self.sigma)
        return Bands(value, value - half, value + half, value - wide, value + wide)

    def in_value_units(self, unit: float) -> BasisCurve:
        """Multiply all that is in units of the values."""
        return dataclasses.replace(
            self, theta=self.theta * unit, sigma=self.sigma * unit, unit=self.unit * unit
        )


def weighted_sum(columns: FloatArray, theta: FloatArray) -> FloatArray:
    """``theta @ columns`` in a fixed order of summation."""
    fitted = theta[0] * columns[0]
    for j in range(1, theta.size):
        fitted += theta[j] * columns[j]
    return np.asarray(fitted, dtype=np.float64)
