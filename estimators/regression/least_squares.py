"""Weighted least squares, stable and in a fixed order of summation.

The solve is repeated on its own residuals (iterative refinement) until it changes nothing, which brings
the accuracy of an orthogonal factorisation at the cost of sums.
"""

from __future__ import annotations

import numba
import numpy as np

from estimators.arrays import FloatArray
from estimators.kernels import kernel, ro
from estimators.regression.weighted_step import residuals_of, weighted_step

MAX_COLUMNS = 8
_F8 = numba.float64
_REFINEMENTS = 3


@kernel(numba.int64(ro(_F8, 2), ro(_F8), ro(_F8), _F8[::1], _F8[::1]))
def _solve(
    columns: FloatArray, y: FloatArray, weights: FloatArray, theta: FloatArray, residual: FloatArray
) -> int:
    """Write the least-squares coefficients and residuals; return the rank."""
    p = theta.size
    step = np.zeros(p)
    theta[:] = 0.0
    residual[:] = y
    rank = 0
    for round_ in range(_REFINEMENTS):
        found = weighted_step(columns, residual, weights, step)
        if round_ == 0:
            rank = found
        unchanged = True
        for j in range(p):
            refined = theta[j] + step[j]
            unchanged = unchanged and refined == theta[j]
            theta[j] = refined
        residuals_of(columns, y, theta, residual)
        if unchanged:
            break
    return rank


def least_squares(
    columns: FloatArray, y: FloatArray, weights: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, int]:
    """Minimise sum w_i (y_i - theta @ columns[:, i])^2.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
        One row per coefficient, the constant first, p <= 8; scaled to about 1.
    y : ndarray of float64, shape (n,)
    weights : ndarray of float64, shape (n,), optional
        Not negative; default all 1.

    Returns
    -------
    theta : ndarray of float64, shape (p,)
        Coefficients that the points do not determine are 0.
    residual : ndarray of float64, shape (n,)
    rank : int
        Number of coefficients that the points determine.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(-1.0, 1.0, 5)
    >>> theta, residual, rank = least_squares(np.vstack([np.ones(5), t]), 1.0 + 2.0 * t)
    >>> theta.tolist(), rank
    ([1.0, 2.0], 2)
    """
    p, n = columns.shape
    theta = np.empty(p)
    residual = np.empty(n)
    rank = _solve(columns, y, np.ones(n) if weights is None else weights, theta, residual)
    return theta, residual, int(rank)
