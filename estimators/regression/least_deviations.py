"""Least absolute deviations by reweighted least squares (Schlossmacher 1973).

Vertical outliers hardly move it, whatever the design: a start for estimates of high breakdown where minimal
samples fail, as they do on columns that are zero at most points.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray
from estimators.noise.mad import mad_scale
from estimators.regression.least_squares import least_squares

_ROUNDS = 30
_CONVERGED = 1e-6
"""Change of the sum of deviations, relative to it, at which the rounds end."""
_SMALLEST = 1e-3
"""Deviations are not taken for smaller than this share of their median, so that no point pins the fit."""


def least_deviations(columns: FloatArray, y: FloatArray, weights: FloatArray | None = None) -> FloatArray:
    """Minimise sum |r_i| sqrt(w_i), approximately: at most 30 rounds.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
        The constant first; scaled to about 1.
    y : ndarray of float64, shape (n,)
    weights : ndarray of float64, shape (n,), optional
        Precisions with mean 1.

    Returns
    -------
    ndarray of float64, shape (p,)
        Coefficients that the points do not determine are 0.

    Examples
    --------
    >>> import numpy as np
    >>> x = np.linspace(-1.0, 1.0, 11)
    >>> y = 1.0 + 2.0 * x
    >>> y[[1, 4, 8]] += 50.0
    >>> least_deviations(np.vstack([np.ones(11), x]), y).round(2).tolist()
    [1.0, 2.0]
    """
    precision = np.ones(y.size) if weights is None else weights
    root = np.sqrt(precision)
    theta, residual, _ = least_squares(columns, y, weights)
    total = float(np.sum(np.abs(residual) * root))
    for _ in range(_ROUNDS):
        least = _SMALLEST * mad_scale(residual, weights)
        if not least > 0.0:
            break
        # In units of the least deviation, which keeps weights near 1 for data of any size.
        pull = precision / np.maximum(np.abs(residual) * root / least, 1.0)
        theta, residual, _ = least_squares(columns, y, pull)
        before, total = total, float(np.sum(np.abs(residual) * root))
        if abs(before - total) <= _CONVERGED * total:
            break
    return theta
