"""Tukey's bisquare M-estimate at a fixed scale: the efficient finish of a robust fit.

The loss redescends: points beyond 4.685 noise scales have no say at all. It has many local minima, so what
it returns is only as robust as its start and its scale (METHODS.md 9).
"""

from __future__ import annotations

from estimators.arrays import FloatArray
from estimators.regression.loss import Loss, LossKind
from estimators.regression.reweighting import Reweighted, reweight

BISQUARE = Loss(LossKind.bisquare, 4.685)
"""95 % efficient at the normal law (METHODS.md 9)."""

ROUNDS = 50


def bisquare(
    columns: FloatArray,
    y: FloatArray,
    weights: FloatArray | None = None,
    *,
    start: FloatArray,
    sigma: float,
    rounds: int = ROUNDS,
) -> Reweighted:
    """Bisquare estimate at scale ``sigma``, the local minimum that belongs to ``start``.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
    y : ndarray of float64, shape (n,)
    weights : ndarray of float64, shape (n,), optional
        Precisions with mean 1.
    start : ndarray of float64, shape (p,)
        A robust fit.
    sigma : float
        Its noise scale, positive.
    rounds : int
        Most rounds (default 50), to 1e-10 noise scales.

    Returns
    -------
    Reweighted

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(-1.0, 1.0, 9)
    >>> y = 1.0 + 2.0 * t
    >>> y[8] = 50.0
    >>> fit = bisquare(np.vstack([np.ones(9), t]), y, start=np.array([1.0, 1.9]), sigma=0.1)
    >>> fit.theta.round(9).tolist()
    [1.0, 2.0]
    """
    return reweight(columns, y, weights, start=start, loss=BISQUARE, sigma=sigma, floor=sigma, rounds=rounds)
