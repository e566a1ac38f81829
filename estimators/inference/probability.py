"""Posterior probability that a point follows the model, from its residual.

The mixture of MLESAC (Torr & Zisserman 2000; METHODS.md 3.2): inliers N(0, sigma^2) with share g, outliers
uniform over the window v that the residuals span; z_i = g N_i / (g N_i + (1 - g) / v), g by EM.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import FloatArray
from estimators.kernels import kernel, ro

_STEPS = 12
_ROOT_2PI = math.sqrt(2.0 * math.pi)


@kernel(
    types.void(
        ro(types.float64), ro(types.float64), types.float64, types.Array(types.float64, 1, "C")
    )
)  # fmt: skip
def fill_posterior(
    residual: FloatArray, root_weight: FloatArray, sigma: float, posterior: FloatArray
) -> None:
    """EM over the share of inliers; ``posterior`` receives z_i."""
    n = residual.size
    weighted = root_weight.size > 0
    low = np.inf
    high = -np.inf
    for i in range(n):
        r = residual[i] * root_weight[i] if weighted else residual[i]
        low = min(low, r)
        high = max(high, r)
        u = r / sigma
        posterior[i] = math.exp(-0.5 * u * u) if abs(u) < 38.0 else 0.0
    window = max(high - low, 6.0 * sigma)
    height = window / (_ROOT_2PI * sigma)
    share = 0.5
    for _ in range(_STEPS):
        total = 0.0
        for i in range(n):
            joint = share * height * posterior[i]
            total += joint / (joint + 1.0 - share)
        share = min(max(total / n, 0.5 / n), 1.0 - 0.5 / n)
    for i in range(n):
        joint = share * height * posterior[i]
        posterior[i] = joint / (joint + 1.0 - share)


def inlier_probability(residual: FloatArray, root_weight: FloatArray | None, sigma: float) -> FloatArray:
    """Posterior inlier probabilities.

    Parameters
    ----------
    residual : ndarray of float64, shape (n,)
    root_weight : ndarray of float64, shape (n,), or None
        Square roots of the precisions.
    sigma : float
        Noise scale of an inlier of mean weight.

    Returns
    -------
    ndarray of float64, shape (n,)
        Between 0 and 1.

    Examples
    --------
    >>> z = inlier_probability(np.array([0.1, -0.2, 0.0, 0.3, 25.0]), None, 0.2)
    >>> bool(z[:4].min() > 0.8), bool(z[4] < 1e-6)
    (True, True)
    """
    posterior = np.empty(residual.size)
    fill_posterior(residual, np.empty(0) if root_weight is None else root_weight, sigma, posterior)
    return posterior
