"""What an uncertainty of coefficients can be asked, whatever their number: :class:`Spread`.

The methods of :mod:`estimators.inference.hac` and :mod:`estimators.inference.resampled` speak about *axes*,
combinations of coefficients whose errors are uncorrelated by the formula: of a line its slope and its level
at the center. Each axis has a variance of its own, so that each can be widened by itself.
"""

from __future__ import annotations

import math
from typing import Protocol, Self

import numpy as np

from estimators.arrays import FloatArray

_SHARE = 1e-12
"""Of a variance; less is left by rounding where an axis is a combination of earlier ones."""


class Spread(Protocol):
    """Uncertainty of coefficients."""

    @property
    def method(self) -> str:
        """How it was found."""
        ...

    @property
    def effective_n(self) -> float:
        """Independent inliers that the correlated ones are worth."""
        ...

    @property
    def lag1(self) -> float:
        """Lag-1 correlation, 0 if negative or not asked for."""
        ...

    @property
    def dof(self) -> float:
        """Degrees of freedom of Student's t."""
        ...

    def stderr(self, directions: FloatArray) -> FloatArray:
        """Compute standard errors, shape (k,), of combinations of the coefficients, shape (k, p)."""
        ...

    def named(self, method: str) -> Self:
        """Say that it goes by another method's name."""
        ...

    def along(
        self, axes: FloatArray, covariance: FloatArray, method: str, effective_n: float, dof: float
    ) -> Self:
        """Exchange the covariance for one given along axes, shape (p, p), one axis per row."""
        ...


def uncorrelated_axes(covariance: FloatArray, first: FloatArray) -> FloatArray:
    """Find combinations of coefficients that are uncorrelated, one of them given.

    Parameters
    ----------
    covariance : ndarray of float64, shape (p, p)
        Positive definite.
    first : ndarray of float64, shape (p,)
        Not 0.

    Returns
    -------
    ndarray of float64, shape (p, p)
        Rows: ``first``, then the coefficients from the last to the first, less what the rows before explain
        of each (Gram-Schmidt in the metric of the covariance). The last is thus the constant of a trend,
        taken where it is known best.

    Examples
    --------
    >>> covariance = np.array([[2.0, -1.0], [-1.0, 1.0]])
    >>> axes = uncorrelated_axes(covariance, np.array([0.0, 1.0]))
    >>> axes
    array([[0., 1.],
           [1., 1.]])
    >>> axes @ covariance @ axes.T
    array([[1., 0.],
           [0., 1.]])
    """
    p = first.size
    rows, variances = [first], [_product(first, covariance, first)]
    sizes = np.abs(first) * np.sqrt(np.diag(covariance))
    left_out = int(np.argmax(sizes))
    for k in range(p - 1, -1, -1):
        if k == left_out:
            continue
        row = np.zeros(p)
        row[k] = 1.0
        for _ in range(2):  # a second pass takes away what rounding left
            for axis, variance in zip(rows, variances, strict=True):
                row = row - axis * (_product(row, covariance, axis) / variance)
        variance = _product(row, covariance, row)
        rows.append(row)
        variances.append(max(variance, _SHARE * float(covariance[k, k])))
    return np.array(rows)


def covariance_from_axes(axes: FloatArray, covariance: FloatArray) -> FloatArray:
    """Turn a covariance along axes into that of the coefficients.

    Examples
    --------
    >>> covariance_from_axes(np.array([[0.0, 1.0], [1.0, 1.0]]), np.eye(2))
    array([[ 2., -1.],
           [-1.,  1.]])
    """
    inverse = np.linalg.inv(axes)
    return np.asarray(inverse @ covariance @ inverse.T, dtype=np.float64)


def _product(one: FloatArray, matrix: FloatArray, other: FloatArray) -> float:
    """Compute one' M other in a fixed order of summation."""
    return math.fsum((one * np.sum(matrix * other[np.newaxis, :], axis=1)).tolist())
