"""How likely residuals are under noise, outliers and excursions: the mixture alone, its model given."""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import FloatArray
from estimators.consensus.bases.filter import filter_step, start_mixture
from estimators.consensus.structure.criterion import CORRELATION_PRICE
from estimators.consensus.structure.mixture import (
    ABOVE,
    BELOW,
    CORRELATION,
    INLIERS,
    LIKELIHOOD,
    SIGMA,
    SIZE,
    UNIFORM,
)
from estimators.kernels import kernel, ro

_STEPS = 20
_LEAST_REACH = 1e-9  # of the values: less is their rounding
_f8 = types.float64


@kernel(_f8(ro(_f8), ro(_f8), _f8, _f8))
def _fit_noise(residual: FloatArray, root_weight: FloatArray, sigma: float, floor: float) -> float:
    params = np.empty(SIZE)
    start_mixture(max(sigma, floor), 0.1, 0.5, params)
    params[UNIFORM] = 1.0
    params[ABOVE] = params[BELOW] = 0.0
    weight = np.empty(residual.size)
    for _ in range(_STEPS):
        if not filter_step(residual, root_weight, 0, floor, True, False, params, weight):
            break
        square = 0.0
        for i in range(residual.size):
            square += weight[i] * residual[i] * residual[i]
        params[SIGMA] = max(floor, math.sqrt(square / params[INLIERS]))
    filter_step(residual, root_weight, 0, floor, False, True, params, weight)
    value: float = params[LIKELIHOOD]
    return value - CORRELATION_PRICE if params[CORRELATION] > 0.0 else value


def value_range(y: FloatArray) -> float:
    """Choose the unit in which residuals are weighed: twice the reach of the values about their median.

    Examples
    --------
    >>> value_range(np.array([1.0, 2.0, 7.0])), value_range(np.zeros(3))
    (10.0, 1.0)
    """
    middle = float(np.median(y))
    reach = 2.0 * max(float(np.max(np.abs(y - middle))), _LEAST_REACH * abs(middle))
    return reach if reach > 0.0 else 1.0


def noise_evidence(residual: FloatArray, root_weight: FloatArray, sigma: float, floor: float) -> float:
    """Log-likelihood of residuals in the order of time, their noise and contamination fitted to them.

    Parameters
    ----------
    residual : ndarray of float64, shape (n,)
        In units of the range of the values, over which outliers are uniform.
    root_weight : ndarray of float64, shape (n,)
        What turns a residual into one of the scale ``sigma``; densities are those of the values.
    sigma : float
        Noise scale to start from, in units of whitened residuals.
    floor : float
        Least noise scale, positive.

    Returns
    -------
    float
        Less the price of correlated neighbours, where they are.

    Examples
    --------
    >>> r = np.random.default_rng(0).normal(scale=0.01, size=100)
    >>> fine = noise_evidence(r, np.ones(100), 0.01, 1e-6)
    >>> r[::5] += np.random.default_rng(1).uniform(-0.4, 0.4, 20)
    >>> bool(fine > noise_evidence(r, np.ones(100), 0.01, 1e-6) > 200.0)
    True
    """
    return _fit_noise(residual, root_weight, sigma, floor)
