"""Long-run variance of scores under serial correlation of unknown form (HAC), on the time axis.

Newey & West (1987): the covariance of a sum is the sum of the covariances at all lags, tapered by the
Bartlett kernel. Lags are distances in time, so that gaps and irregular sampling need no grid. The bandwidth,
1.3 sqrt(n) mean spacings (Lazarus, Lewis, Stock & Watson 2018), is a fixed share b of the span: the estimate
stays random however long the series, and its law at fixed b (Kiefer & Vogelsang 2005) is approximated by a
chi-square whose mean and degrees of freedom are those of the quadratic form on the times at hand
(Satterthwaite 1946). Scores are prewhitened by their lag-1 correlation first (Andrews & Monahan 1992): the
kernel alone would miss the slow end of a strong correlation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray

BANDWIDTH = 1.3
"""Bandwidth in mean spacings, as a multiple of sqrt(n) (METHODS.md 12)."""

MOST_FOR_LAW = 400
"""Points on which the law of the variance estimate is worked out; it depends on the share b alone."""


@dataclass(frozen=True, slots=True)
class LongRun:
    """Long-run covariance of the scores of a line, relative to what independent points would have.

    Attributes
    ----------
    level, slope : float
        Ratio of the long-run to the independent variance of either sum of scores.
    correlation : float
        Correlation of the two sums.
    dof : float
        Degrees of freedom of the estimate of ``slope``.
    """

    level: float
    slope: float
    correlation: float
    dof: float


def bartlett_sum(t: FloatArray, a: FloatArray, b: FloatArray, bandwidth: float) -> float:
    """Sum of a_i b_j (1 - |t_i - t_j| / h) over all pairs nearer than h, i = j included.

    Parameters
    ----------
    t : ndarray of float64, shape (n,)
        Ascending.
    a, b : ndarray of float64, shape (n,)
    bandwidth : float
        h > 0.

    Returns
    -------
    float

    Notes
    -----
    Prefix sums of b and t b make it linear in n, however many points fall within the bandwidth.

    Examples
    --------
    >>> t, a = np.array([0.0, 1.0, 3.0]), np.array([1.0, 1.0, 1.0])
    >>> bartlett_sum(t, a, a, 2.0)
    4.0
    """
    plain = np.concatenate(([0.0], np.cumsum(b)))
    moment = np.concatenate(([0.0], np.cumsum(t * b)))
    here = np.arange(t.size)
    first = np.searchsorted(t, t - bandwidth, side="right")
    last = np.searchsorted(t, t + bandwidth, side="left")
    before, moment_before = plain[here] - plain[first], moment[here] - moment[first]
    after, moment_after = plain[last] - plain[here], moment[last] - moment[here]
    near = before * (1.0 - t / bandwidth) + moment_before / bandwidth
    near += after * (1.0 + t / bandwidth) - moment_after / bandwidth
    return float(np.sum(a * near))


def long_run(t: FloatArray, scores: FloatArray, center: float, lag1: float) -> LongRun | None:
    """Long-run covariance of the scores of level and slope.

    Parameters
    ----------
    t : ndarray of float64, shape (n,)
        Ascending.
    scores : ndarray of float64, shape (n,)
        From :func:`estimators.inference.scores.point_scores`.
    center : float
        Time at which independent points leave level and slope uncorrelated.
    lag1 : float
        Lag-1 correlation, 0 up to less than 1, by which the scores are prewhitened.

    Returns
    -------
    LongRun or None
        None where the scores are all 0.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> noise = rng.normal(size=4001)
    >>> found = long_run(np.arange(4000.0), noise[1:] + noise[:-1], 1999.5, 0.0)
    >>> bool(1.5 < found.slope < 2.5)  # a moving average of two has twice the long-run variance
    True
    """
    away = t - center
    level, slope = scores, scores * away
    independent = float(np.sum(level * level)), float(np.sum(slope * slope))
    if min(independent) <= 0.0:
        return None
    bandwidth = BANDWIDTH * (float(t[-1]) - float(t[0])) * math.sqrt(t.size) / (t.size - 1)
    white = [_prewhiten(column, lag1) for column in (level, slope)]
    sums = [bartlett_sum(t, white[i], white[j], bandwidth) for i, j in ((0, 0), (0, 1), (1, 1))]
    mean_level, _ = _law(t, np.ones(t.size), center, bandwidth)
    mean_slope, dof = _law(t, away, center, bandwidth)
    recolour = 1.0 / (1.0 - lag1) ** 2
    level_ratio = max(sums[0], 0.0) * recolour / (independent[0] * mean_level)
    slope_ratio = max(sums[2], 0.0) * recolour / (independent[1] * mean_slope)
    bound = math.sqrt(max(sums[0], 0.0) * max(sums[2], 0.0))
    correlation = sums[1] / bound if bound > 0.0 else 0.0
    return LongRun(level_ratio, slope_ratio, min(max(correlation, -0.99), 0.99), dof)


def _prewhiten(scores: FloatArray, lag1: float) -> FloatArray:
    """Keep what the last score does not foretell; but for the ends, the sum shrinks to 1 - lag1 of it."""
    white = scores.copy()
    white[1:] -= lag1 * scores[:-1]
    # Stationary start: the first score has no predecessor to lose its share to.
    white[0] *= math.sqrt(1.0 - lag1 * lag1)
    return white


def _law(t: FloatArray, column: FloatArray, center: float, bandwidth: float) -> tuple[float, float]:
    """Mean, relative to the truth, and degrees of freedom of the estimate for independent noise.

    With D the column of a coefficient, K the kernel and M the residual maker of the line, the estimate is
    u' M D K D M u = u' Q u with mean tr Q and variance 2 tr Q^2 for unit noise u.
    """
    n = t.size
    chosen = np.arange(0, n, max(1, -(-n // MOST_FOR_LAW)))
    at, weight = t[chosen], column[chosen]
    kernel = np.maximum(1.0 - np.abs(at[:, None] - at[None, :]) / bandwidth, 0.0)
    form = kernel * weight[:, None] * weight[None, :]
    away = at - center
    away = away - away.mean()
    basis = np.array([np.full(at.size, 1.0 / math.sqrt(at.size)), away / math.sqrt(float(np.sum(away**2)))])
    # M Q M for M = I - basis' basis, without a product of large matrices: sums in a fixed order.
    for vector in basis:
        form = form - vector[:, None] * np.sum(vector[:, None] * form, axis=0)[None, :]
        form = form - np.sum(form * vector[None, :], axis=1)[:, None] * vector[None, :]
    mean = float(np.trace(form))
    square = float(np.sum(form * form))
    return mean / float(np.sum(weight * weight)), mean * mean / square
