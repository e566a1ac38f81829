"""Whether chance alone would have shown as good a line: the p-value of having searched.

A search finds the best of very many lines, and among scattered points the best of them has followers too;
a test that takes the inliers as given is then worthless (METHODS.md 12: it rejects pure noise up to 77 % of
the time). The expected number of lines through two points that as many others would follow by chance
(Moisan & Stival 2004; METHODS.md 3.5) bounds the probability that there is one.
"""

from __future__ import annotations

import numpy as np
from scipy.special import betainc

from estimators.arrays import FloatArray, IntArray

NEARLY_ALL = 0.8
"""Share of inliers from which no finer line was chosen among the points."""

_CENTRAL = 0.9  # of the values: their range is taken from these, so that a gross error does not dilute it


def chance_of_line(values: FloatArray, inliers: int, threshold: float) -> float:
    """Bound the probability that chance alone shows a line with as many followers.

    Parameters
    ----------
    values : ndarray of float64, shape (n,)
        The series: without a trend, its own range is what the points are scattered over.
    inliers : int
    threshold : float
        Largest |residual| of an inlier.

    Returns
    -------
    float
        0 where nearly all points are inliers, since no choice among them was made.

    Notes
    -----
    Pairs of points times the binomial tail of a band of the threshold in the range of the values.

    Examples
    --------
    >>> scattered = np.linspace(-10.0, 10.0, 50)
    >>> chance_of_line(scattered, 10, 2.0)
    1.0
    >>> chance_of_line(np.concatenate((np.zeros(30), scattered)), 32, 0.5) < 1e-12
    True
    """
    n = values.size
    if inliers >= NEARLY_ALL * n or inliers < 3:
        return 0.0 if inliers >= 3 else 1.0
    low, high = n // 20, (19 * n) // 20
    ordered = np.partition(values, (low, high))
    middle = float(ordered[high] - ordered[low])
    band = min(1.0, 2.0 * threshold * _CENTRAL / middle) if middle > 0.0 else 1.0
    others = inliers - 2
    return min(1.0, 0.5 * n * (n - 1) * float(betainc(others, n - 2 - others + 1, band)))


def central_range(values: FloatArray) -> float:
    """Range of the values that :func:`chance_of_line` takes, of their central nine tenths."""
    low, high = values.size // 20, (19 * values.size) // 20
    ordered = np.partition(values, (low, high))
    return float(ordered[high] - ordered[low])


def chances_of_lines(
    n: IntArray, inliers: IntArray, threshold: FloatArray, central: FloatArray
) -> FloatArray:
    """Compute :func:`chance_of_line` of many series, the same to the bit.

    Parameters
    ----------
    n, inliers : ndarray of int64, shape (m,)
    threshold : ndarray of float64, shape (m,)
    central : ndarray of float64, shape (m,)
        From :func:`central_range`.

    Returns
    -------
    ndarray of float64, shape (m,)
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        band = np.where(central > 0.0, np.minimum(1.0, 2.0 * threshold * _CENTRAL / central), 1.0)
    others = np.maximum(inliers - 2, 1)
    tail = betainc(others, n - 2 - others + 1, band)
    chance = np.minimum(1.0, 0.5 * n * (n - 1) * tail)
    return np.where(inliers < 3, 1.0, np.where(inliers >= NEARLY_ALL * n, 0.0, chance))
