"""Variance of a robust line, true after outliers were rejected and under serial correlation.

Least squares on selected inliers understates its own variance, because the selection is part of the
estimate (METHODS.md 12: a naive 95 % interval covers 85 to 94 %). Seen as an M-estimate with influence
psi, its variance is the sandwich s^2 A^-1 B A^-1, A = sum psi'(u) x x', B = sum psi(u)^2 x x' (Huber 1981).
Neighbouring residuals that are correlated are worth fewer independent ones (Santer et al. 2000):
f = 1 + 2 w rho / (1 - rho), with rho the bias-corrected lag-1 correlation of psi on the original grid and
w the share of inliers, since a removed neighbour carries no correlation along.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.inference.spread import covariance_from_axes
from estimators.regression.group_uncertainty import GroupUncertainty
from estimators.regression.influence import (
    A0,
    A1,
    A2,
    B0,
    B1,
    B2,
    INLIERS,
    LAGGED,
    PAIRS,
    PSI_SQUARE,
    SUPPORT,
    W0,
    W1,
    W2,
)

LEAST_PAIRS = 5
"""Neighbouring inliers from which a correlation is estimated."""

MOST_CORRELATION = 0.98
_FITTED = 4.0
"""Readings that two coefficients, a scale and the choice of inliers use up."""
_DOF_SHARE = 0.4
"""Degrees of freedom that an effective inlier adds."""
LEAST_DOF = 3.0
"""However correlated, inliers that were told from outliers are more than two readings."""


@dataclass(frozen=True, slots=True)
class LineUncertainty:
    """Uncertainty of a line, in the time of the residuals it was made from.

    Attributes
    ----------
    method : {"effective-n", "sandwich", "jackknife", "hac", "bootstrap", "permutation"}
    center : float
        Time at which level and slope are uncorrelated.
    level_variance, slope_variance : float
        At ``center``; serial correlation included.
    effective_n : float
        Independent inliers that the correlated ones are worth.
    lag1 : float
        Bias-corrected lag-1 correlation, 0 if negative or not asked for.
    dof : float
        Degrees of freedom of Student's t.
    """

    method: str
    center: float
    level_variance: float
    slope_variance: float
    effective_n: float
    lag1: float
    dof: float

    @property
    def axes(self) -> FloatArray:
        """Slope, and level at the center, as combinations of (level at time 0, slope), shape (2, 2)."""
        return np.array([[0.0, 1.0], [1.0, self.center]])

    def stderr(self, directions: FloatArray) -> FloatArray:
        """Compute standard errors of linear combinations of (level at time 0, slope).

        Parameters
        ----------
        directions : ndarray of float64, shape (k, 2)

        Returns
        -------
        ndarray of float64, shape (k,)

        Examples
        --------
        >>> line = LineUncertainty("sandwich", 1.0, 4.0, 9.0, 20.0, 0.0, 18.0)
        >>> line.stderr(np.array([[0.0, 1.0], [1.0, 1.0]]))
        array([3., 2.])
        """
        levels, slopes = directions[:, 0], directions[:, 1]
        away = slopes - levels * self.center
        return np.sqrt(self.level_variance * levels**2 + self.slope_variance * away**2)

    def named(self, method: str) -> LineUncertainty:
        """Say that it goes by another method's name."""
        return dataclasses.replace(self, method=method)

    def along(
        self, axes: FloatArray, covariance: FloatArray, method: str, effective_n: float, dof: float
    ) -> LineUncertainty:
        """Exchange the covariance for one given along axes.

        Parameters
        ----------
        axes, covariance : ndarray of float64, shape (2, 2)
            One axis per row.
        method : str
        effective_n, dof : float
        """
        (v00, v01), (_, v11) = covariance_from_axes(axes, covariance).tolist()
        center = -v01 / v11
        level = max(v00 + center * v01, 0.0)
        return LineUncertainty(method, center, level, v11, effective_n, self.lag1, dof)


def line_uncertainty(
    sums: FloatArray,
    n: int,
    sigma: float,
    own: GroupUncertainty | None = None,
    *,
    correct_serial_correlation: bool = True,
) -> LineUncertainty | None:
    """Sandwich variance of a line with few-point and serial-correlation corrections.

    Parameters
    ----------
    sums : ndarray of float64
        From :func:`estimators.regression.influence.influence_sums`.
    n : int
        Points of the series.
    sigma : float
        Noise scale.
    own : GroupUncertainty, optional
        Covariance of (level at time 0, slope) for independent points that takes the sandwich's place.
    correct_serial_correlation : bool
        Whether to widen by the effective sample size (default True).

    Returns
    -------
    LineUncertainty or None
        None where fewer than 3 inliers leave nothing to estimate it from.

    Notes
    -----
    The variance is the larger of the sandwich and s^2 A^-1 (METHODS_TRENDS: "Interval"). With S effective
    inliers it is multiplied by (S / (S - 4))^2, for the leverage that two coefficients, a scale and the
    choice of inliers have on their own residuals, and Student's t takes 0.4 S / f - 1 degrees of
    freedom: the scale of few points, told from outliers by the same points, is itself uncertain. Both were
    chosen by the coverage of 20 to 50 inliers (``benchmarks``).
    """
    found, center, level, slope, effective, lag1, dof, widen = sandwich(
        sums[: PSI_SQUARE + 1].tolist(), n, sigma, correct_serial_correlation
    )
    if own is not None:
        (v00, v01), (_, v11) = own.covariance.tolist()
        center = -v01 / v11 if v11 > 0.0 else 0.0
        level = max(v00 + center * v01, 0.0)
        support = float(sums[SUPPORT])
        return LineUncertainty(
            "jackknife", center, level * widen, v11 * widen, max(support / widen, 1.0), lag1, own.dof
        )
    if not found:
        return None
    method = "effective-n" if correct_serial_correlation else "sandwich"
    return LineUncertainty(method, center, level, slope, effective, lag1, dof)


def sandwich(
    sums: Sequence[float] | FloatArray, n: int, sigma: float, correct: bool
) -> tuple[bool, float, float, float, float, float, float, float]:
    """Compute :func:`line_uncertainty` in plain arithmetic, which compiled code runs to the same bits.

    Parameters
    ----------
    sums : sequence of float
        Slots of :mod:`estimators.regression.influence` up to ``PSI_SQUARE``.
    n : int
    sigma : float
    correct : bool
        Whether to widen by the effective sample size.

    Returns
    -------
    tuple
        Whether there is an uncertainty; center, variances of level and slope, effective number, lag-1
        correlation, degrees of freedom; the factor that serial correlation widens variances by.
    """
    a0, a1, a2 = sums[A0], sums[A1], sums[A2]
    b0, b1, b2 = sums[B0], sums[B1], sums[B2]
    w0, w1, w2 = sums[W0], sums[W1], sums[W2]
    inliers, pairs, square = sums[INLIERS], sums[PAIRS], sums[PSI_SQUARE]
    widen, lag1 = 1.0, 0.0
    if correct and pairs >= LEAST_PAIRS and square > 0.0:
        r1 = (sums[LAGGED] / pairs) / (square / inliers)
        # Corrected for its bias, (1 + 4 r) / n (METHODS.md 12).
        r1 += (1.0 + 4.0 * r1) / pairs
        if r1 > 2.0 / math.sqrt(pairs):
            # One that is clearly there is raised by half its standard error: the widening 1 / (1 - rho) is
            # convex, so that its expectation lies above its value at the expected rho.
            r1 += 0.5 * math.sqrt(max(1.0 - r1 * r1, 0.0) / pairs)
        lag1 = min(max(r1, 0.0), MOST_CORRELATION)
        widen = 1.0 + 2.0 * (inliers / n) * lag1 / (1.0 - lag1)
    det = a0 * a2 - a1 * a1
    plain = w0 * w2 - w1 * w1
    if inliers < 3 or plain <= 1e-14 * w0 * max(w2, 1e-300):
        return False, 0.0, 0.0, 0.0, 0.0, lag1, 0.0, widen
    if a0 < 0.2 * w0 or a2 < 0.2 * w2 or det < 0.05 * plain:
        # Few points and a steep descent of psi: the weights themselves are the safer curvature.
        a0, a1, a2, det = w0, w1, w2, plain
    # A^-1 in closed form, then V = A^-1 B A^-1.
    i00, i01, i11 = a2 / det, -a1 / det, a0 / det
    c0, c1 = b0 * i00 + b1 * i01, b0 * i01 + b1 * i11
    d0, d1 = b1 * i00 + b2 * i01, b1 * i01 + b2 * i11
    v00, v01, v11 = i00 * c0 + i01 * d0, i00 * c1 + i01 * d1, i01 * c1 + i11 * d1
    v11 = max(v11, i11)
    center = -v01 / v11
    # Of the level at the center, where it is least and independent of the slope.
    level = max(v00 + 2.0 * center * v01 + center * center * v11, i00 - i01 * i01 / i11)
    effective = max(sums[SUPPORT], _FITTED)
    few = effective / max(effective - _FITTED, 1.0)
    factor = sigma * sigma * widen * (few * few)
    dof = max(_DOF_SHARE * effective / widen - 1.0, LEAST_DOF)
    return True, center, level * factor, v11 * factor, max(effective / widen, 1.0), lag1, dof, widen
