"""From replicates of a whole procedure to intervals and p-values.

A replicate is the same procedure, selection of the inliers included, on a resampled series. What is
compared is always the studentised estimate, whose law hardly depends on the unknown truth (Hall 1992,
chapter 3): intervals and tests are then right to a higher order than from the estimates themselves.
"""

from __future__ import annotations

import math

from scipy.special import stdtrit

from estimators.arrays import FloatArray


def symmetric_quantile(statistics: FloatArray, level: float) -> float:
    """Bound that a share ``level`` of replicates keeps: the (R + 1) level-th smallest of |t*| (Hall 1988).

    Parameters
    ----------
    statistics : ndarray of float64, shape (R,)
        Studentised deviations of replicates from what they were resampled from.
    level : float

    Returns
    -------
    float
        The largest where there are too few replicates for the level.

    Examples
    --------
    >>> import numpy as np
    >>> symmetric_quantile(np.arange(-99.0, 0.0), 0.95)
    95.0
    """
    ordered = sorted(abs(value) for value in statistics.tolist())
    # The tolerance keeps 0.95 * 400 from being rounded up to the 381st.
    place = math.ceil((len(ordered) + 1) * level - 1e-9)
    return float(ordered[min(place, len(ordered)) - 1])


def widening(statistics: FloatArray, level: float, dof: float) -> float:
    """Factor by which standard errors are multiplied so that Student's t meets the replicates' quantile.

    Parameters
    ----------
    statistics : ndarray of float64, shape (R,)
    level : float
        Level at which they meet.
    dof : float
        Degrees of freedom of the interval that is widened (or narrowed).

    Returns
    -------
    float
    """
    return symmetric_quantile(statistics, level) / float(stdtrit(dof, 0.5 * (1.0 + level)))


def permutation_p(statistic: float, statistics: FloatArray) -> float:
    """Share of permuted series whose |t*| reaches the observed one, which counts among them.

    Parameters
    ----------
    statistic : float
    statistics : ndarray of float64, shape (R,)
        Of series permuted under the null hypothesis.

    Returns
    -------
    float
        (1 + count) / (1 + R): never 0, and valid at any R (Davison & Hinkley 1997, section 4.2).

    Examples
    --------
    >>> import numpy as np
    >>> permutation_p(2.5, np.array([0.1, -3.0, 1.0]))
    0.5
    """
    reached = sum(1 for value in statistics.tolist() if abs(value) >= abs(statistic))
    return (1.0 + reached) / (1.0 + statistics.size)
