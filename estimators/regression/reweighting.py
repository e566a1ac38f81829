"""Iteratively reweighted least squares: the loop behind Huber's, the bisquare and the MM-estimate.

Each round fits by least squares with weights w psi(u) / u of the present standardised residuals u; for the
losses here that never raises the objective at a fixed scale (Huber & Ronchetti 2009, section 7.8).
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from estimators.arrays import FloatArray
from estimators.kernels import device, kernel, ro
from estimators.noise.mad import MAD_FACTOR
from estimators.noise.selection import median_of
from estimators.regression.loss import Loss, LossKind
from estimators.regression.weighted_step import largest_value, residuals_of, weighted_step

TOLERANCE = 1e-10  # largest change of a fitted value, in noise scales, at which the loop ends
_F8 = numba.float64
_EPS = 2.220446049250313e-16
_HUBER = int(LossKind.huber)
_BISQUARE = int(LossKind.bisquare)


@dataclass(frozen=True, slots=True)
class Reweighted:
    """Where a reweighting ended.

    Attributes
    ----------
    theta : ndarray of float64, shape (p,)
    residual : ndarray of float64, shape (n,)
    sigma : float
        Scale of the last round.
    rounds : int
    converged : bool
    """

    theta: FloatArray
    residual: FloatArray
    sigma: float
    rounds: int
    converged: bool


@device
def robust_weight(kind: int, tuning: float, u: float) -> float:
    """psi(u) / u of the Huber or the bisquare loss."""
    size = abs(u)
    if kind == _HUBER:
        return 1.0 if size <= tuning else tuning / size
    if size >= tuning:
        return 0.0
    v = u / tuning
    return (1.0 - v * v) * (1.0 - v * v)


@device
def median_size(residual: FloatArray, root: FloatArray, work: FloatArray) -> float:
    """Median |r sqrt(w)|."""
    for i in range(residual.size):
        work[i] = abs(residual[i]) * root[i]
    return median_of(work, residual.size)


@kernel(
    numba.int64(
        ro(_F8, 2),
        ro(_F8),
        ro(_F8),
        numba.int64,
        _F8,
        _F8,
        numba.int64,
        numba.int64,
        _F8[::1],
        _F8[::1],
        _F8[::1],
    )
)
def _reweight(
    columns: FloatArray,
    y: FloatArray,
    precision: FloatArray,
    kind: int,
    tuning: float,
    floor: float,
    rescaled_rounds: int,
    rounds: int,
    scale: FloatArray,
    theta: FloatArray,
    residual: FloatArray,
) -> int:
    """Iterate on ``theta`` and ``scale[0]``; return the rounds taken, negative if not converged."""
    n = y.size
    root = np.sqrt(precision)
    work = np.empty(n)
    weights = np.empty(n)
    step = np.zeros(theta.size)
    sigma = max(scale[0], floor)
    residuals_of(columns, y, theta, residual)
    for done in range(rounds):
        before = sigma
        if done < rescaled_rounds:
            sigma = max(MAD_FACTOR * median_size(residual, root, work), floor)
            scale[0] = sigma
        for i in range(n):
            weights[i] = precision[i] * robust_weight(kind, tuning, residual[i] * root[i] / sigma)
        weighted_step(columns, residual, weights, step)
        for j in range(theta.size):
            theta[j] += step[j]
        residuals_of(columns, y, theta, residual)
        # Steps below the resolution of the fit are rounding, however small the noise.
        small = max(TOLERANCE * sigma, _EPS * largest_value(columns, theta))
        scale_stands = abs(sigma - before) <= small or done >= rescaled_rounds
        if scale_stands and largest_value(columns, step) <= small:
            return done + 1
    return -rounds


def reweight(
    columns: FloatArray,
    y: FloatArray,
    weights: FloatArray | None,
    *,
    start: FloatArray,
    loss: Loss,
    sigma: float | None,
    floor: float,
    rounds: int,
    rescaled_rounds: int = 0,
) -> Reweighted:
    """Minimise sum rho(r_i sqrt(w_i) / sigma) from a start.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
    y : ndarray of float64, shape (n,)
    weights : ndarray of float64, shape (n,), or None
        Precisions with mean 1.
    start : ndarray of float64, shape (p,)
    loss : Loss
        Of kind ``huber`` or ``bisquare``.
    sigma : float or None
        Noise scale; None to begin with that of the start's residuals (``rescaled_rounds`` >= 1).
    floor : float
        Least scale.
    rounds : int
        Most rounds.
    rescaled_rounds : int
        In this many first rounds the scale is 1.4826 MAD of the present residuals; then it stands, so that
        a convex loss is sure to converge.

    Returns
    -------
    Reweighted
    """
    if loss.kind not in (LossKind.huber, LossKind.bisquare):
        raise ValueError(f"no weights for a loss of kind {loss.kind.name}")
    theta = start.copy()
    residual = np.empty(y.size)
    scale = np.array([floor if sigma is None else max(sigma, floor)])
    precision = np.ones(y.size) if weights is None else weights
    taken = _reweight(
        columns,
        y,
        precision,
        int(loss.kind),
        loss.tuning,
        floor,
        rescaled_rounds,
        rounds,
        scale,
        theta,
        residual,
    )
    return Reweighted(theta, residual, float(scale[0]), abs(taken), taken > 0)
