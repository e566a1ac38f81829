"""Honest spread of joint solutions: errors that last count once, and tails that bound a risk.

Errors of satellites, of the atmosphere and of reflections last longer than the time between epochs. The mean
of T residuals of lag-one correlation r has the variance of independent ones times

    k = (1 + r) / (1 - r) - 2 r (1 - r^T) / (T (1 - r)^2)

(Bartlett 1935, for an autoregression of order one), between 1 and T.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray, IntArray

_MOST_CORRELATED = 0.9999
_LEAST_PAIRS = 20


def lag_one(whitened: FloatArray, weight: FloatArray, previous: IntArray) -> float:
    """Correlation of a satellite's residuals from one epoch to the next, over all satellites.

    Parameters
    ----------
    whitened, weight : ndarray, shape (rows,)
        Residuals in units of their noise; what each counts.
    previous : ndarray of int64, shape (rows,)
        Row of the same satellite in the epoch before; negative where there is none.

    Returns
    -------
    float
        Between 0 and 1; 0 where there are too few pairs to tell.
    """
    later = np.flatnonzero(previous >= 0)
    if later.size < _LEAST_PAIRS:
        return 0.0
    a, b = whitened[later], whitened[previous[later]]
    # A pair counts as far as both count: a fault in one epoch says nothing of the noise.
    both = weight[later] * weight[previous[later]]
    size = float(np.sqrt((both * a) @ a * ((both * b) @ b)))
    if not size > 0.0:
        return 0.0
    return min(max(float((both * a) @ b) / size, 0.0), _MOST_CORRELATED)


def widening(correlation: float, length: float) -> float:
    """How many times the variance of a mean of so many correlated residuals is that of independent ones.

    Parameters
    ----------
    correlation : float
        Of lag one.
    length : float
        Number of residuals in a row.

    Examples
    --------
    >>> widening(0.0, 20.0), round(widening(0.5, 1e6), 3), round(widening(0.9999, 20.0), 1)
    (1.0, 3.0, 20.0)
    """
    if correlation <= 0.0 or length <= 1.0:
        return 1.0
    left = 1.0 - correlation
    value = (1.0 + correlation) / left - 2.0 * correlation * (1.0 - correlation**length) / (length * left**2)
    return float(min(max(value, 1.0), length))


def larger_axis(covariance_enu: FloatArray) -> FloatArray:
    """Variance along the larger semi-axis of the horizontal error ellipse.

    Parameters
    ----------
    covariance_enu : ndarray, shape (..., 3, 3)
    """
    east, north = covariance_enu[..., 0, 0], covariance_enu[..., 1, 1]
    half = 0.5 * (east - north)
    return np.asarray(0.5 * (east + north) + np.sqrt(half**2 + covariance_enu[..., 0, 1] ** 2))


def tail(
    radius: FloatArray, distance: FloatArray, variance: FloatArray, nu: float, weight: FloatArray
) -> FloatArray:
    """Bound of the probability that the truth lies farther than a radius from the answer.

    Parameters
    ----------
    radius : ndarray, shape (n,)
    distance, variance : ndarray, shape (n, modes)
        Of each competing position; the variance along its larger axis.
    nu : float
        Degrees of freedom of the Student tails.
    weight : ndarray, shape (n, modes)
        Probabilities.

    Notes
    -----
    The tails of :mod:`estimators.gnss.snapshot.tails`.
    """
    beyond = np.maximum(radius[:, None] - distance, 0.0)
    return np.asarray((weight * np.exp(-0.5 * nu * np.log1p(beyond**2 / (nu * variance)))).sum(axis=1))


def protection(
    risk: float, distance: FloatArray, variance: FloatArray, nu: float, weight: FloatArray
) -> FloatArray:
    """Radius beyond which the truth lies with at most the risk, by bisection.

    Parameters
    ----------
    risk : float
    distance, variance, nu, weight
        As in :func:`tail`.
    """
    log_tail = -2.0 / nu * math.log(risk)
    # One mode alone reaches the risk here; no mode needs more.
    high = (distance + np.sqrt(nu * variance * np.expm1(log_tail))).max(axis=1)
    if distance.shape[1] == 1:
        return np.asarray(high)
    low = np.zeros_like(high)
    for _ in range(60):
        middle = 0.5 * (low + high)
        above = tail(middle, distance, variance, nu, weight) > risk
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return np.asarray(high)
