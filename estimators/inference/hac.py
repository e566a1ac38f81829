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

_MOST_CORRELATION = 0.99
_LEAST_MEAN = 0.05
"""Of the truth; a design that explains nearly all of a column leaves its long-run variance untold."""
_SAME_COLUMN = 1e-9


@dataclass(frozen=True, slots=True)
class LongRun:
    """Long-run covariance of sums of scores, relative to what independent points would have.

    Attributes
    ----------
    ratio : ndarray of float64, shape (k,)
        Ratio of the long-run to the independent variance of each sum.
    correlation : ndarray of float64, shape (k, k)
        Of the sums.
    dof : float
        Degrees of freedom of the estimate of the first.
    """

    ratio: FloatArray
    correlation: FloatArray
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


def long_run(
    t: FloatArray, scores: FloatArray, influences: FloatArray, design: FloatArray, lag1: float,
    root_weight: FloatArray | None = None,
) -> LongRun | None:  # fmt: skip
    """Long-run covariance of the estimates of some combinations of coefficients.

    Parameters
    ----------
    t : ndarray of float64, shape (n,)
        Ascending.
    scores : ndarray of float64, shape (n,)
        From :func:`estimators.inference.scores.point_scores`.
    influences : ndarray of float64, shape (k, n)
        How far a unit score of each point moves each combination, up to a factor.
    design : ndarray of float64, shape (p, n)
        Columns of the fit.
    lag1 : float
        Lag-1 correlation, 0 up to less than 1, by which the scores are prewhitened.
    root_weight : ndarray of float64, shape (n,), or None
        Square roots of the precisions.

    Returns
    -------
    LongRun or None
        None where the scores of a combination are all 0.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> noise, t = rng.normal(size=4001), np.arange(4000.0)
    >>> line = np.array([np.ones(4000), t])
    >>> found = long_run(t, noise[1:] + noise[:-1], np.array([t - 1999.5]), line, 0.0)
    >>> bool(1.5 < found.ratio[0] < 2.5)  # a moving average of two has twice the long-run variance
    True
    """
    k = influences.shape[0]
    each = scores * influences
    independent = np.sum(each * each, axis=1)
    if not np.all(independent > 0.0):
        return None
    weighted = influences if root_weight is None else influences * root_weight
    columns = design if root_weight is None else design * root_weight
    bandwidth = BANDWIDTH * (float(t[-1]) - float(t[0])) * math.sqrt(t.size) / (t.size - 1)
    carried = np.array([_carried(row, lag1) for row in weighted])
    white = [_prewhiten(row, rho) for row, rho in zip(each, carried.tolist(), strict=True)]
    sums = np.empty((k, k))
    for i in range(k):
        for j in range(i, k):
            sums[i, j] = sums[j, i] = bartlett_sum(t, white[i], white[j], bandwidth)
    means, dof = _law(t, weighted, columns, bandwidth)
    variance = np.maximum(np.diag(sums), 0.0)
    ratio = variance / (1.0 - carried) ** 2 / (independent * means)
    bound = np.sqrt(np.outer(variance, variance))
    correlation = np.divide(sums, bound, out=np.zeros_like(sums), where=bound > 0.0)
    np.fill_diagonal(correlation, 0.0)
    strongest = float(np.abs(correlation).max())
    # A convex combination with the identity stays a correlation matrix.
    correlation *= min(1.0, _MOST_CORRELATION / strongest) if strongest > 0.0 else 0.0
    np.fill_diagonal(correlation, 1.0)
    return LongRun(ratio, correlation, dof)


def _carried(column: FloatArray, lag1: float) -> float:
    """Lag-1 correlation of the scores of a column under noise with ``lag1``: a fast column turns it about.

    Prewhitening each score by its own is Andrews and Monahan's (1992) with a diagonal autoregression.
    """
    size = float(np.sum(column[1:] ** 2 + column[:-1] ** 2))
    return lag1 * 2.0 * float(np.sum(column[1:] * column[:-1])) / size if size > 0.0 else 0.0


def _prewhiten(scores: FloatArray, lag1: float) -> FloatArray:
    """Keep what the last score does not foretell; but for the ends, the sum shrinks to 1 - lag1 of it."""
    white = scores.copy()
    white[1:] -= lag1 * scores[:-1]
    # Stationary start: the first score has no predecessor to lose its share to.
    white[0] *= math.sqrt(1.0 - lag1 * lag1)
    return white


def _law(
    t: FloatArray, columns: FloatArray, design: FloatArray, bandwidth: float
) -> tuple[FloatArray, float]:
    """Means of the estimates for independent noise, in the truth's units; degrees of freedom of the first.

    With D the influences on a combination, K the kernel and M the residual maker of the design, the estimate
    is u' M D K D M u = u' Q u with mean tr Q and variance 2 tr Q^2 for unit noise u.
    """
    chosen = np.arange(0, t.size, max(1, -(-t.size // MOST_FOR_LAW)))
    at = t[chosen]
    kernel = np.maximum(1.0 - np.abs(at[:, None] - at[None, :]) / bandwidth, 0.0)
    basis = _orthonormal(design[:, chosen])
    means, dof = np.ones(columns.shape[0]), math.inf
    for index, weight in enumerate(columns[:, chosen]):
        truth = float(np.sum(weight * weight))
        if truth <= 0.0:
            continue
        form = kernel * weight[:, None] * weight[None, :]
        # M Q M for M = I - basis' basis, without a product of large matrices: sums in a fixed order.
        for vector in basis:
            form = form - vector[:, None] * np.sum(vector[:, None] * form, axis=0)[None, :]
            form = form - np.sum(form * vector[None, :], axis=1)[:, None] * vector[None, :]
        mean = float(np.trace(form))
        means[index] = max(mean / truth, _LEAST_MEAN)
        if index == 0:
            dof = max(mean * mean / float(np.sum(form * form)), 1.0)
    return means, dof


def _orthonormal(design: FloatArray) -> list[FloatArray]:
    """Orthonormal rows that span those of a design (Gram-Schmidt, twice for rounding's sake)."""
    basis: list[FloatArray] = []
    for column in design:
        row = column
        for _ in range(2):
            for vector in basis:
                row = row - vector * float(np.sum(vector * row))
        left, size = math.sqrt(float(np.sum(row * row))), math.sqrt(float(np.sum(column * column)))
        if left > _SAME_COLUMN * size:
            basis.append(row / left)
    return basis
