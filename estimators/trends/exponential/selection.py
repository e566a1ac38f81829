"""Which noise the data speak for: the likelihood of the values under both fitted curves.

Under multiplicative noise ln|y| is normal about the curve, so that the density of a *value* carries the
Jacobian 1/|y|; under additive noise the value itself is. Contaminated readings have the same background in
both, uniform in the values and in their logarithms by halves, and the same sticky labels. Every density is
divided by that background, which cancels in the comparison.
"""

from __future__ import annotations

import numpy as np
from numba import types

from estimators.arrays import FloatArray
from estimators.consensus.structure.em import em_step
from estimators.consensus.structure.mixture import LEVEL, LIKELIHOOD, SIZE, SLOPE, start
from estimators.kernels import kernel, ro

UNDETERMINED = 3.0
"""Log evidence below which neither noise is preferred: 20 to 1, as for structures."""

_STEPS = 8
_START_WIDTH = 2.5
_LEAST_READING = 1e-300
"""Smaller readings have a density that no number holds."""
_LEAST_SCALE = 0.2
"""Least noise scale of the comparison, in that of the fit: it settles the domain, not the scale."""
_APART = 1e6
_BOTH_SIDES = 3.0
"""Price of errors to one side or both, in ln n, as for lines: clean tails must not buy them."""


@kernel(types.float64(ro(types.float64), ro(types.float64), ro(types.float64), types.float64))
def mixture_likelihood(t: FloatArray, raw: FloatArray, root: FloatArray, sigma: float) -> float:
    """Log-likelihood of readings ``raw`` about 0, whose noise is ``sigma / root``, over the background."""
    params = np.zeros(SIZE)
    best = -np.inf
    for sides in (0, 2):
        price = _BOTH_SIDES * np.log(t.size) if sides == 2 else 0.0
        start(t, raw, root, 0.0, 0.0, _START_WIDTH * sigma, _LEAST_SCALE * sigma, 0.0, params)
        for _ in range(_STEPS):
            params[LEVEL] = 0.0
            params[SLOPE] = 0.0
            em_step(t, raw, root, sides, _LEAST_SCALE * sigma, 0.0, False, params)
            best = max(best, params[LIKELIHOOD] - price)
    return best


def background(y: FloatArray, sign: float) -> FloatArray:
    """Density of contaminated readings: uniform over the values' range, and over that of their logarithms.

    Parameters
    ----------
    y : ndarray of float64, shape (n,)
    sign : float
        Of the curve; readings of the other sign, and 0, have no logarithm.
    """
    spread = max(float(y.max()) - float(y.min()), float(np.abs(y).max()))
    density = np.full(y.size, 0.5 / spread)
    own = y * sign > 0.0
    if own.any():
        size = np.maximum(np.abs(y[own]), _LEAST_READING)
        logs = np.log(size)
        density[own] += 0.5 / (size * max(float(logs.max() - logs.min()), 1.0))
    return density


def additive_evidence(
    t: FloatArray, residual: FloatArray, root_weight: FloatArray, density: FloatArray, sigma: float
) -> float:
    """Log evidence of a curve under additive noise.

    Parameters
    ----------
    t, residual : ndarray of float64, shape (n,)
        Frame time; value less curve.
    root_weight : ndarray of float64, shape (n,)
    density : ndarray of float64, shape (n,)
        From :func:`background`.
    sigma : float
    """
    root = root_weight / density
    return mixture_likelihood(t, residual * density, root, sigma)


def multiplicative_evidence(
    t: FloatArray,
    y: FloatArray,
    log_value: FloatArray,
    sign: float,
    root_weight: FloatArray,
    density: FloatArray,
    sigma: float,
) -> float:
    """Log evidence of a curve under multiplicative noise; values it cannot make count as contaminated.

    Parameters
    ----------
    t, y : ndarray of float64, shape (n,)
    log_value : ndarray of float64, shape (n,)
        Logarithm of the curve's size.
    sign : float
    root_weight, density : ndarray of float64, shape (n,)
    sigma : float
        Of ln|y|.
    """
    own = y * sign > 0.0
    size = np.abs(y, where=own, out=np.ones_like(y))
    root = root_weight / (density * size)
    # Each impossible value stands alone: together they would pass for an excursion with a level of its own.
    alone = _APART * sigma * (1.0 + np.arange(y.size)) * np.where(np.arange(y.size) % 2, 1.0, -1.0)
    raw = np.where(own, (np.log(size) - log_value) * root_weight, alone) / root
    return mixture_likelihood(t, raw, root, sigma)
