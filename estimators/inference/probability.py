"""Posterior probability that a point follows the model, from its residual; calibrated on the series.

The mixture is in :mod:`estimators.consensus.labelling.posterior`, which the search of ``auto`` shares.
"""

from __future__ import annotations

import numpy as np
from numba import types

from estimators.arrays import FloatArray
from estimators.consensus.labelling.posterior import posterior_of
from estimators.kernels import kernel, ro


@kernel(
    types.void(
        ro(types.float64), ro(types.float64), types.float64, types.Array(types.float64, 1, "C")
    )
)  # fmt: skip
def fill_posterior(
    residual: FloatArray, root_weight: FloatArray, sigma: float, posterior: FloatArray
) -> None:
    """Entry to :func:`posterior_of`."""
    posterior_of(residual, root_weight, sigma, posterior)


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
    >>> bool(z[:4].min() > 0.8), bool(z[4] < 1e-3)
    (True, True)
    """
    posterior = np.empty(residual.size)
    fill_posterior(residual, np.empty(0) if root_weight is None else root_weight, sigma, posterior)
    return posterior


__all__ = ["fill_posterior", "inlier_probability", "posterior_of"]
