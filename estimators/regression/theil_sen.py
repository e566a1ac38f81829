"""Theil-Sen line: the median of the slopes of all pairs of points (Theil 1950; Sen 1968), exactly.

Breakdown 29.3 %, no threshold, no scale. Exact for any number of points: the median is selected without
forming the pairs (:mod:`estimators.regression.slope_selection`). The confidence limits of the slope are
order statistics of the same slopes, from the null distribution of Kendall's tau (Sen 1968).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from estimators.arrays import FloatArray
from estimators.regression.slope_selection import PairSlopes


@dataclass(frozen=True, slots=True)
class MedianLine:
    """A line made of medians.

    Attributes
    ----------
    slope : float
    intercept : float
        median(y - slope * t): the line halves the points.
    """

    slope: float
    intercept: float


@dataclass(frozen=True, slots=True)
class SlopeInterval:
    """Distribution-free confidence interval of a Theil-Sen slope.

    Attributes
    ----------
    low, high : float
        Order statistics of the pairwise slopes.
    stderr : float
        Half the length of the interval over the normal quantile of its level.
    """

    low: float
    high: float
    stderr: float


def theil_sen(t: FloatArray, y: FloatArray) -> MedianLine:
    """Median of the pairwise slopes over different times, O(n log n) time and O(n) memory.

    An even number of slopes averages the two middle ones. The intercept is median(y - slope t), the
    ``joint`` choice of :func:`scipy.stats.theilslopes`, whose default is median(y) - slope median(t).

    Parameters
    ----------
    t : ndarray of float64, shape (n,)
        Not all equal; any order, ties allowed (pairs of equal times have no slope and are left out).
    y : ndarray of float64, shape (n,)

    Returns
    -------
    MedianLine

    Raises
    ------
    ValueError
        If no two times differ.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(6.0)
    >>> y = 1.0 + 2.0 * t
    >>> y[5] = 1e6
    >>> theil_sen(t, y)
    MedianLine(slope=2.0, intercept=1.0)
    """
    slopes = PairSlopes(t, y)
    if slopes.count == 0:
        raise ValueError("no two times differ: there is no slope")
    slope = slopes.median() + 0.0  # no negative zeros
    return MedianLine(slope, float(np.median(y - slope * t)))


def theil_sen_interval(
    t: FloatArray, y: FloatArray, level: float = 0.95, *, inflation: float = 1.0
) -> SlopeInterval | None:
    """Confidence interval of the Theil-Sen slope by Sen (1968), equation 2.6.

    Under a slope b, Kendall's S of y - b t has mean 0 and variance
    [n(n-1)(2n+5) - sum u(u-1)(2u+5)] / 18 over groups of u equal times; the slopes of ranks
    (N ± z sqrt(variance)) / 2 of N bound the values of b that this does not refute. Ties in *y* do not
    enter, because they are no ties of y - b t.

    Parameters
    ----------
    t : ndarray of float64, shape (n,)
    y : ndarray of float64, shape (n,)
    level : float
        Confidence level (default 0.95).
    inflation : float
        Factor on the variance of S (default 1), such as n / n_eff for serially correlated points.

    Returns
    -------
    SlopeInterval or None
        None where N slopes are too few for the level: the limits would lie beyond the extreme slopes.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(40.0)
    >>> y = 2.0 * t + np.random.default_rng(0).normal(size=40)
    >>> interval = theil_sen_interval(t, y)
    >>> interval.low < 2.0 < interval.high
    True
    """
    slopes = PairSlopes(t, y)
    n = float(t.size)
    _, groups = np.unique(slopes.t, return_counts=True)
    u = groups.astype(np.float64)
    variance = (n * (n - 1) * (2 * n + 5) - float(np.sum(u * (u - 1) * (2 * u + 5)))) / 18.0 * inflation
    z = float(ndtri(0.5 * (1.0 + level)))
    reach = z * math.sqrt(variance)
    low_rank = round((slopes.count - reach) / 2.0) - 1
    high_rank = round((slopes.count + reach) / 2.0)
    if low_rank < 0 or high_rank >= slopes.count:
        return None
    low, high = slopes.ranked([low_rank, high_rank])
    return SlopeInterval(low, high, (high - low) / (2.0 * z))
