"""Noise scale of residuals: the median absolute residual, made consistent with the normal law.

Residuals of a robust pilot fit, never the values themselves: the spread of values that follow a trend is
no noise (METHODS.md 13.6).
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray

MAD_FACTOR = 1.482602218505602
"""1 / Phi^-1(3/4): the median absolute normal deviate times this is its standard deviation."""


def mad_scale(residual: FloatArray, weights: FloatArray | None = None) -> float:
    """Consistent scale 1.4826 * median |r_i sqrt(w_i)|, about zero.

    Parameters
    ----------
    residual : ndarray of float64, shape (n,)
        n >= 1.
    weights : ndarray of float64, shape (n,), optional
        Precisions with mean 1.

    Returns
    -------
    float
        0 where at least half of the residuals are 0.

    Examples
    --------
    >>> import numpy as np
    >>> round(mad_scale(np.array([-1.0, 0.5, 2.0, 100.0, -1.5])), 4)
    2.2239
    """
    size = np.abs(residual if weights is None else residual * np.sqrt(weights))
    return MAD_FACTOR * float(np.median(size))


def residual_scale(residual: FloatArray, parameters: int, weights: FloatArray | None = None) -> float:
    """Scale of the noise from the residuals of a robust fit: :func:`mad_scale` times n / (n - p).

    A fit draws its residuals towards zero, a fit through medians most where they are smallest, so that
    their median falls short by about p / n: on normal noise the Theil-Sen line's MAD averages 0.83, 0.92,
    0.97 and 0.98 sigma at n = 10, 20, 50 and 100.

    Parameters
    ----------
    residual : ndarray of float64, shape (n,)
    parameters : int
        Number p of fitted parameters.
    weights : ndarray of float64, shape (n,), optional
        Precisions with mean 1.

    Returns
    -------
    float
        0 where n <= p: residuals of an exact fit say nothing about the noise.

    Examples
    --------
    >>> import numpy as np
    >>> residual_scale(np.array([0.0, 0.0]), parameters=2)
    0.0
    """
    n = residual.size
    if n <= parameters:
        return 0.0
    return mad_scale(residual, weights) * n / (n - parameters)
