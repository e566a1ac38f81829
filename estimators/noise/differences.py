"""Noise scale without a fit: from differences of neighbours in time.

A trend changes little between neighbours, so their differences are noise (times sqrt(2)), while outliers
touch at most two differences each. Serial correlation makes these scales too small, a steep trend over
few points too large: they are pilots, not answers (METHODS.md 13.6).
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import ndtri

from estimators.arrays import FloatArray


def difference_scale(y: FloatArray, weights: FloatArray | None = None, share: float = 0.5) -> float:
    """Scale from the ``share`` quantile of centred first differences.

    With d_i = (y_{i+1} - y_i) / sqrt(1/w_i + 1/w_{i+1}), it is the quantile of |d - median d| over that
    of the standard normal law, Phi^-1((1 + share) / 2). Centring on the median takes out a steady trend
    at even spacing.

    Parameters
    ----------
    y : ndarray of float64, shape (n,)
        In order of time.
    weights : ndarray of float64, shape (n,), optional
        Precisions with mean 1.
    share : float
        Default 0.5, the median: holds while more than half of the differences are clean. 0.25 holds
        until three quarters are not, and is noisier.

    Returns
    -------
    float
        0 for fewer than 3 points.

    Examples
    --------
    >>> import numpy as np
    >>> noise = np.random.default_rng(0).normal(scale=2.0, size=4000)
    >>> round(difference_scale(0.1 * np.arange(4000) + noise), 1)
    2.0
    """
    if y.size < 3:
        return 0.0
    spread: FloatArray | float = (
        math.sqrt(2.0) if weights is None else np.sqrt(1 / weights[1:] + 1 / weights[:-1])
    )
    difference = np.diff(y) / spread
    size = np.abs(difference - np.median(difference))
    # The inverted distribution function: an order statistic, so that ties and two differences need no rule.
    rank = min(max(math.ceil(share * size.size), 1), size.size) - 1
    return float(np.partition(size, rank)[rank]) / float(ndtri(0.5 * (1.0 + share)))


def interquartile_difference_scale(y: FloatArray, weights: FloatArray | None = None) -> float:
    """Scale from the lower quartile of |difference|: 25 % quantile of |dy - median dy| / 0.4506.

    The variant of METHODS_TRENDS ("One threshold-free configuration", 4), which survives outliers in
    almost half of the points wherever they stand.

    Parameters
    ----------
    y : ndarray of float64, shape (n,)
        In order of time.
    weights : ndarray of float64, shape (n,), optional
        Precisions with mean 1.

    Returns
    -------
    float
    """
    return difference_scale(y, weights, share=0.25)
