"""Regression quantiles, roughly: curves with a given share of the points below (Koenker & Bassett 1978).

Where outliers err to one side, the middle of the points that do not err is no median of all points: with a
share e of errors above, it is their quantile (1 - e) / 2. A few such curves are starts that need no luck,
where minimal samples of many points are hardly ever clean.
"""

from __future__ import annotations

import numba
import numpy as np

from estimators.arrays import FloatArray
from estimators.kernels import kernel, ro
from estimators.noise.mad import MAD_FACTOR
from estimators.regression.reweighting import median_size
from estimators.regression.weighted_step import residuals_of, weighted_step

_ROUNDS = 12
_NEAREST = 0.05
"""Residuals below this share of their median count as this large: their weights stay finite."""
_CORE = 0.2
"""Share of the points, the nearest ones, that the scale about a curve is measured on."""
_F8 = numba.float64


def quantile_fits(
    columns: FloatArray,
    y: FloatArray,
    weights: FloatArray | None,
    *,
    shares: FloatArray,
    start: FloatArray,
    floor: float,
) -> tuple[FloatArray, FloatArray]:
    """Curves below which given shares of the points lie, by iteratively reweighted least squares.

    Twelve rounds: good starts for a search, no exact solutions of the linear programme.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
    y : ndarray of float64, shape (n,)
    weights : ndarray of float64, shape (n,), optional
        Precisions with mean 1.
    shares : ndarray of float64, shape (k,)
        Between 0 and 1.
    start : ndarray of float64, shape (p,)
        Coefficients to begin with.
    floor : float
        Least scale.

    Returns
    -------
    theta : ndarray of float64, shape (k, p)
    scale : ndarray of float64, shape (k,)
        Of the fifth of the points that is nearest to each curve, as if they were the half: the noise scale
        where two points in five follow it.

    Examples
    --------
    >>> t = np.linspace(-1.0, 1.0, 101)
    >>> y = np.where(np.arange(101) % 5 < 3, 9.0 + t, 1.0 + t)  # 60 % of the points are 8 too high
    >>> theta, _ = quantile_fits(
    ...     np.vstack([np.ones(101), t]), y, None, shares=np.array([0.2]), start=np.zeros(2), floor=1e-12
    ... )
    >>> theta.round(6).tolist()
    [[1.0, 1.0]]
    """
    root = np.ones(y.size) if weights is None else np.sqrt(weights)
    theta = np.empty((shares.size, start.size))
    scale = np.empty(shares.size)
    _reweight_quantiles(columns, y, root, shares, start, floor, theta, scale)
    return theta, scale


@kernel(numba.void(ro(_F8, 2), ro(_F8), ro(_F8), ro(_F8), ro(_F8), _F8, _F8[:, ::1], _F8[::1]))
def _reweight_quantiles(
    columns: FloatArray,
    y: FloatArray,
    root: FloatArray,
    shares: FloatArray,
    start: FloatArray,
    floor: float,
    theta: FloatArray,
    scale: FloatArray,
) -> None:
    p, n = columns.shape
    residual = np.empty(n)
    work = np.empty(n)
    step = np.empty(p)
    core = int(_CORE * n)
    for k in range(shares.size):
        theta[k] = start
        residuals_of(columns, y, theta[k], residual)
        for _ in range(_ROUNDS):
            nearest = max(_NEAREST * median_size(residual, root, work), floor)
            for i in range(n):
                pull = shares[k] if residual[i] > 0.0 else 1.0 - shares[k]
                work[i] = pull * root[i] * root[i] / max(abs(residual[i]) * root[i], nearest)
            weighted_step(columns, residual, work, step)
            for j in range(p):
                theta[k, j] += step[j]
            residuals_of(columns, y, theta[k], residual)
        for i in range(n):
            work[i] = abs(residual[i]) * root[i]
        work.sort()
        scale[k] = max(MAD_FACTOR * work[core], floor)
