"""Uncertainty of any estimator of a trend from groups of its points, where no formula is known.

The points are dealt to groups in turn, so that every group spans the whole time axis. The delete-a-group
jackknife refits without each group in turn; interpenetrating groups (Mahalanobis 1946) refit each group
alone, which costs less where the fit is not linear in the number of points. Both take the points for
independent: widen for serial correlation afterwards.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray

GROUPS = 20

_ALONE = 50  # points from which a group's own fit varies as 1 / n

Fit = Callable[[FloatArray, FloatArray], FloatArray]
"""Coefficients, shape (p,), from times and values."""


@dataclass(frozen=True, slots=True)
class GroupUncertainty:
    """Covariance of coefficients from groups of points.

    Attributes
    ----------
    covariance : ndarray of float64, shape (p, p)
    dof : float
        Degrees of freedom for Student's t: the number of groups less one.
    """

    covariance: FloatArray
    dof: float

    @property
    def stderr(self) -> FloatArray:
        """Standard errors, shape (p,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)), dtype=np.float64)


def delete_group_jackknife(
    fit: Fit, t: FloatArray, y: FloatArray, groups: int = GROUPS
) -> GroupUncertainty | None:
    """Delete-a-group jackknife (Wolter 2007, chapter 4): (g - 1) / g sum (theta_k - mean theta)^2.

    Parameters
    ----------
    fit : callable
        ``fit(t, y) -> theta``.
    t : ndarray of float64, shape (n,)
        Ascending.
    y : ndarray of float64, shape (n,)
    groups : int
        Number of groups (default 20); fewer points than that are left out one by one.

    Returns
    -------
    GroupUncertainty or None
        None where leaving out a group leaves fewer than 3 points or no two different times.

    Examples
    --------
    >>> import numpy as np
    >>> y = np.random.default_rng(0).normal(size=400)
    >>> mean = delete_group_jackknife(lambda t, y: np.array([y.mean()]), np.arange(400.0), y)
    >>> bool(0.03 < mean.stderr[0] < 0.08), mean.dof
    (True, 19.0)
    """
    n = t.size
    count = min(groups, n)
    dealt = np.arange(n) % count
    kept = [dealt != group for group in range(count)]
    return _spread(fit, t, y, kept, lambda g: (g - 1.0) / g)


def interpenetrating_groups(
    fit: Fit, t: FloatArray, y: FloatArray, groups: int = GROUPS
) -> GroupUncertainty | None:
    """Variance between the fits of separate groups: sum (theta_k - mean theta)^2 / (g (g - 1)).

    It holds for estimators whose variance falls as 1 / n, from groups large enough for that.

    Parameters
    ----------
    fit : callable
        ``fit(t, y) -> theta``.
    t : ndarray of float64, shape (n,)
        Ascending.
    y : ndarray of float64, shape (n,)
    groups : int
        Number of groups (default 20).

    Returns
    -------
    GroupUncertainty or None
        None where a group has fewer than 3 points or no two different times.
    """
    dealt = np.arange(t.size) % groups
    kept = [dealt == group for group in range(groups)]
    return _spread(fit, t, y, kept, lambda g: 1.0 / (g * (g - 1.0)))


def group_uncertainty(
    fit: Fit, t: FloatArray, y: FloatArray, groups: int = GROUPS
) -> GroupUncertainty | None:
    """Interpenetrating groups where each holds 50 points or more, else the delete-a-group jackknife.

    Parameters
    ----------
    fit : callable
        ``fit(t, y) -> theta``.
    t : ndarray of float64, shape (n,)
        Ascending.
    y : ndarray of float64, shape (n,)
    groups : int
        Number of groups (default 20).

    Returns
    -------
    GroupUncertainty or None
    """
    if t.size >= _ALONE * groups:
        return interpenetrating_groups(fit, t, y, groups)
    return delete_group_jackknife(fit, t, y, groups)


def _spread(
    fit: Fit,
    t: FloatArray,
    y: FloatArray,
    subsets: list[np.ndarray[tuple[int], np.dtype[np.bool_]]],
    factor: Callable[[float], float],
) -> GroupUncertainty | None:
    estimates = []
    for subset in subsets:
        times = t[subset]
        if times.size < 3 or times[0] == times[-1]:
            return None
        estimates.append(fit(times, y[subset]))
    theta = np.array(estimates)
    count = float(theta.shape[0])
    deviation = theta - theta.mean(axis=0)
    # A plain sum of outer products: the order of summation is that of the groups.
    covariance = factor(count) * (deviation[:, :, None] * deviation[:, None, :]).sum(axis=0)
    return GroupUncertainty(np.asarray(covariance, dtype=np.float64), count - 1.0)
