"""MM-estimate of regression (Yohai 1987): an S-estimate's robustness with the bisquare's efficiency."""

from __future__ import annotations

from dataclasses import dataclass

from estimators.arrays import FloatArray
from estimators.regression.bisquare import bisquare
from estimators.regression.s_estimator import SEstimate, s_estimate


@dataclass(frozen=True, slots=True)
class MMEstimate:
    """An MM-estimate.

    Attributes
    ----------
    theta : ndarray of float64, shape (p,)
    residual : ndarray of float64, shape (n,)
    sigma : float
        Scale at which the bisquare was taken.
    initial : SEstimate
    converged : bool
    """

    theta: FloatArray
    residual: FloatArray
    sigma: float
    initial: SEstimate
    converged: bool


def mm_estimate(
    columns: FloatArray,
    y: FloatArray,
    weights: FloatArray | None = None,
    *,
    starts: FloatArray,
    floor: float,
    sigma: float | None = None,
) -> MMEstimate:
    """S-estimate, then the bisquare (4.685, at most 50 rounds, 1e-10) from it at its scale.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
    y : ndarray of float64, shape (n,)
    weights : ndarray of float64, shape (n,), optional
        Precisions with mean 1.
    starts : ndarray of float64, shape (m, p)
        Candidate coefficients for the S-estimate, m >= 1.
    floor : float
        Least scale, positive.
    sigma : float, optional
        Noise scale if known; default the scale of the S-estimate.

    Returns
    -------
    MMEstimate

    Examples
    --------
    >>> import numpy as np
    >>> from estimators.regression.minimal_fits import solve_samples
    >>> t = np.linspace(-1.0, 1.0, 9)
    >>> y = 1.0 + 2.0 * t
    >>> y[5:] = 50.0
    >>> columns = np.vstack([np.ones(9), t])
    >>> fit = mm_estimate(columns, y, starts=solve_samples(columns, y, np.array([[0, 1]])), floor=1e-12)
    >>> fit.theta.round(9).tolist()
    [1.0, 2.0]
    """
    initial = s_estimate(columns, y, weights, starts=starts, floor=floor)
    scale = initial.sigma if sigma is None else max(sigma, floor)
    final = bisquare(columns, y, weights, start=initial.theta, sigma=scale)
    return MMEstimate(final.theta, final.residual, scale, initial, final.converged)
