"""Huber's M-estimate of regression with the scale estimated alongside (Huber 1964; Huber & Ronchetti 2009).

Outliers in y pull with bounded force. Outliers at the ends of a time axis pull with their leverage all the
same, so this is a method for comparison and for light contamination.
"""

from __future__ import annotations

from estimators.arrays import FloatArray
from estimators.regression.least_squares import least_squares
from estimators.regression.loss import Loss, LossKind
from estimators.regression.reweighting import Reweighted, reweight

HUBER = Loss(LossKind.huber, 1.345)
"""95 % efficient at the normal law (METHODS.md 9)."""

_NEARLY_ABSOLUTE = Loss(LossKind.huber, 0.1)
_START_ROUNDS = 20
_RESCALED_ROUNDS = 60
_ROUNDS = 400


def huber(
    columns: FloatArray,
    y: FloatArray,
    weights: FloatArray | None = None,
    *,
    sigma: float | None = None,
    floor: float,
) -> Reweighted:
    """Huber estimate, tuning constant 1.345, to 1e-10 noise scales.

    It starts from nearly least absolute residuals (Huber's loss with constant 0.1, itself from least
    squares), because the scale of the first residuals decides which points are held back.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
    y : ndarray of float64, shape (n,)
    weights : ndarray of float64, shape (n,), optional
        Precisions with mean 1.
    sigma : float, optional
        Noise scale if known; default 1.4826 MAD of the residuals, estimated anew in each round.
    floor : float
        Least scale.

    Returns
    -------
    Reweighted

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(-1.0, 1.0, 9)
    >>> y = 1.0 + 2.0 * t
    >>> y[4] = 50.0
    >>> huber(np.vstack([np.ones(9), t]), y, floor=1e-12).theta.round(6).tolist()
    [1.0, 2.0]
    """
    start, _, _ = least_squares(columns, y, weights)
    rescaled = 1 if sigma is None else 0
    near = reweight(
        columns,
        y,
        weights,
        start=start,
        loss=_NEARLY_ABSOLUTE,
        sigma=sigma,
        floor=floor,
        rounds=_START_ROUNDS,
        rescaled_rounds=_START_ROUNDS * rescaled,
    )
    return reweight(
        columns,
        y,
        weights,
        start=near.theta,
        loss=HUBER,
        sigma=sigma,
        floor=floor,
        rounds=_ROUNDS,
        rescaled_rounds=_RESCALED_ROUNDS * rescaled,
    )
