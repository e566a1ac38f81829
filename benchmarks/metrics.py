"""What is measured on a draw: failure, line error over the oracle's, flag F1 and interval coverage.

The *oracle* is least squares on the true inliers: what nobody without the truth can beat. Everything
takes one row per draw. The error of a line is linear in time, so its values at the first and last time
say all there is to say about it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.bed import Draw
from estimators.arrays import BoolArray, FloatArray

FAIL_SIGMAS = 1.0
"""A line is a failure when it is farther than this from the truth somewhere in the range ..."""
FAIL_ORACLE_ERRORS = 5.0
"""... and farther than this many standard errors of the oracle."""


@dataclass(frozen=True, slots=True)
class Oracle:
    """Least squares on the true inliers.

    Attributes
    ----------
    errors : ndarray of float64, shape (2,)
        Oracle minus truth at the first and last time.
    stderr : ndarray of float64, shape (2,)
        The oracle's standard errors there, as least squares reports them.
    inliers : int
    """

    errors: FloatArray
    stderr: FloatArray
    inliers: int


def line_errors(slope: float, intercept: float, draw: Draw) -> FloatArray:
    """Line minus truth at the first and last time, shape (2,); NaN if there is no line."""
    ends = draw.t[[0, -1]]
    return np.asarray((intercept - draw.truth_intercept) + (slope - draw.truth_slope) * ends)


def oracle(draw: Draw) -> Oracle:
    """Least squares on the true inliers of a draw (at least 3 of them).

    Examples
    --------
    >>> from benchmarks.bed import draw_rng, make_series
    >>> oracle(make_series("uniform", 50, 0.4, draw_rng(1, "uniform", 50, 0.4, 0))).inliers
    30
    """
    t, y = draw.t[draw.inlier_mask], draw.y[draw.inlier_mask]
    center = t.mean()
    spread = float(np.sum((t - center) ** 2))
    slope = float(np.sum((t - center) * y) / spread)
    residual = y - y.mean() - slope * (t - center)
    noise = np.sqrt(np.sum(residual**2) / (t.size - 2))
    away = draw.t[[0, -1]] - center
    stderr = noise * np.sqrt(1.0 / t.size + away**2 / spread)
    errors = line_errors(slope, float(y.mean() - slope * center), draw)
    return Oracle(errors, np.asarray(stderr), int(t.size))


def failed(errors: FloatArray, stderr: FloatArray, sigma: float = 1.0) -> BoolArray:
    """Whether lines miss the truth by more than max(1 sigma, 5 oracle standard errors) within the range.

    Parameters
    ----------
    errors : ndarray of float64, shape (draws, 2)
        From :func:`line_errors`; NaN counts as a failure.
    stderr : ndarray of float64, shape (draws, 2)
        From :func:`oracle`.
    sigma : float
        Scale of an inlier's noise.

    Returns
    -------
    ndarray of bool, shape (draws,)
    """
    allowed = np.maximum(FAIL_SIGMAS * sigma, FAIL_ORACLE_ERRORS * stderr)
    return np.asarray(~np.all(np.abs(errors) <= allowed, axis=-1))


def mean_square(errors: FloatArray) -> FloatArray:
    """Mean over the range of a line's squared error, shape (draws,): (e0^2 + e0 e1 + e1^2) / 3."""
    first, last = errors[..., 0], errors[..., 1]
    return np.asarray((first * first + first * last + last * last) / 3.0)


def rms_over_oracle(errors: FloatArray, oracle_errors: FloatArray, inliers: FloatArray) -> float:
    """Root mean square line error over that of the oracle on the same draws; NaN without draws.

    Parameters
    ----------
    errors, oracle_errors : ndarray of float64, shape (draws, 2)
    inliers : ndarray of float64, shape (draws,)
        True inliers; squared errors fall with their inverse, so weighting by them lets series of all
        sizes count alike.
    """
    if errors.shape[0] == 0:
        return float("nan")
    return float(
        np.sqrt(np.sum(inliers * mean_square(errors)) / np.sum(inliers * mean_square(oracle_errors)))
    )


def flag_f1(flagged: BoolArray, inlier_mask: BoolArray) -> float:
    """F1 of outlier flags against the truth, 2 TP / (2 TP + FP + FN); NaN where nothing was contaminated."""
    truth = ~inlier_mask
    if not truth.any():
        return float("nan")
    return float(
        2.0 * np.count_nonzero(flagged & truth) / (np.count_nonzero(flagged) + np.count_nonzero(truth))
    )


def covers(low: FloatArray | float, high: FloatArray | float, truth: FloatArray | float) -> BoolArray:
    """Whether intervals hold the truth, shape (draws,); an interval that is not given (NaN) does not."""
    return np.asarray(np.less_equal(low, truth) & np.less_equal(truth, high))


def mean_or_nan(values: FloatArray | BoolArray) -> float:
    """Mean of what is known; NaN if nothing is."""
    known = np.asarray(values, dtype=np.float64)
    known = known[~np.isnan(known)]
    return float(known.mean()) if known.size else float("nan")
