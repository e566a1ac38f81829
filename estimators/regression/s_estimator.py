"""S-estimate of regression by fast-S (Rousseeuw & Yohai 1984; Salibian-Barrera & Yohai 2006).

The fit with the smallest M-scale of its residuals. From each start one I-step is taken; of those whose
scale can beat the best two, the scale is solved; the best two are iterated to convergence. Where there are
many points the starts are first compared on an evenly spread part of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import device, kernel, ro
from estimators.noise.mad import MAD_FACTOR
from estimators.regression.reweighting import TOLERANCE, median_size
from estimators.regression.scale_equation import S_BREAKDOWN, S_TUNING, rho_sum, solve_scale
from estimators.regression.weighted_step import largest_value, residuals_of, weighted_step

KEPT = 2
"""Candidates iterated to convergence (METHODS.md 9)."""

SCREENED_POINTS = 2000
"""Points on which starts are compared; more are thinned to this many (the size robustbase uses)."""

_ROUNDS = 200
_GOLDEN_SECTION = 0.6180339887498949
_EPS = 2.220446049250313e-16
_F8 = numba.float64


@dataclass(frozen=True, slots=True)
class SEstimate:
    """An S-estimate.

    Attributes
    ----------
    theta : ndarray of float64, shape (p,)
    residual : ndarray of float64, shape (n,)
    sigma : float
        M-scale of the residuals; the floor where at least (n + p) / 2 points fit exactly.
    is_exact : bool
        Whether the scale stands at the floor.
    evaluations : int
        Residuals computed while comparing starts.
    """

    theta: FloatArray
    residual: FloatArray
    sigma: float
    is_exact: bool
    evaluations: int


@device
def _improve(
    columns: FloatArray,
    y: FloatArray,
    precision: FloatArray,
    root: FloatArray,
    scale: float,
    theta: FloatArray,
    residual: FloatArray,
    weights: FloatArray,
    step: FloatArray,
) -> None:
    """Refit with the bisquare weights of the present residuals (the regression half of an I-step)."""
    for i in range(y.size):
        v = residual[i] * root[i] / (S_TUNING * scale)
        v = 1.0 - v * v
        weights[i] = precision[i] * v * v if v > 0.0 else 0.0
    weighted_step(columns, residual, weights, step)
    for j in range(theta.size):
        theta[j] += step[j]
    residuals_of(columns, y, theta, residual)


@kernel(
    numba.int64(ro(_F8, 2), ro(_F8), ro(_F8), ro(_F8, 2), _F8, numba.int64, _F8[:, ::1], _F8[::1], _F8[::1])
)
def _fast_s(
    columns: FloatArray,
    y: FloatArray,
    precision: FloatArray,
    starts: FloatArray,
    floor: float,
    rounds: int,
    kept: FloatArray,
    kept_scale: FloatArray,
    kept_loss: FloatArray,
) -> int:
    """Write the best fits, best first, with their scales and their loss at the scale; return how many."""
    p, n = columns.shape
    target = S_BREAKDOWN * (n - p)
    root = np.sqrt(precision)
    residual = np.empty(n)
    work = np.empty(n)
    theta = np.empty(p)
    step = np.zeros(p)
    count = 0
    for s in range(starts.shape[0]):
        theta[:] = starts[s]
        residuals_of(columns, y, theta, residual)
        scale = max(MAD_FACTOR * median_size(residual, root, work), floor)
        if target > 0.0:
            scale = max(scale * np.sqrt(rho_sum(residual, root, scale) / target), floor)
        _improve(columns, y, precision, root, scale, theta, residual, work, step)
        count = _keep(residual, root, target, scale, floor, theta, kept, kept_scale, kept_loss, count)

    for k in range(count):
        theta[:] = kept[k]
        scale = kept_scale[k]
        residuals_of(columns, y, theta, residual)
        for _ in range(rounds):
            _improve(columns, y, precision, root, scale, theta, residual, work, step)
            if target > 0.0:
                scale = max(scale * np.sqrt(rho_sum(residual, root, scale) / target), floor)
            if largest_value(columns, step) <= max(TOLERANCE * scale, _EPS * largest_value(columns, theta)):
                break
        solved = solve_scale(residual, root, target, scale, floor)
        if solved <= kept_scale[k]:
            kept[k] = theta
            kept_scale[k] = solved
            kept_loss[k] = rho_sum(residual, root, solved)
    for k in range(1, count):
        if _precedes(kept_scale[k], kept_loss[k], kept_scale[0], kept_loss[0]):
            for j in range(p):
                held = kept[0, j]
                kept[0, j] = kept[k, j]
                kept[k, j] = held
            held = kept_scale[0]
            kept_scale[0] = kept_scale[k]
            kept_scale[k] = held
            held = kept_loss[0]
            kept_loss[0] = kept_loss[k]
            kept_loss[k] = held
    return count


@device
def _precedes(scale: float, loss: float, other_scale: float, other_loss: float) -> bool:
    """Smaller scale; among equal ones, which is common at the floor, the smaller loss there."""
    return scale < other_scale or (scale == other_scale and loss < other_loss)


@device
def _keep(
    residual: FloatArray,
    root: FloatArray,
    target: float,
    scale: float,
    floor: float,
    theta: FloatArray,
    kept: FloatArray,
    kept_scale: FloatArray,
    kept_loss: FloatArray,
    count: int,
) -> int:
    """Enter a candidate among the kept ones if its scale is small enough; return how many are kept."""
    last: int = kept.shape[0] - 1
    if count > last:
        # One pass tells whether the scale can be smaller than the worst kept one.
        loss = rho_sum(residual, root, kept_scale[last])
        at_floor = kept_scale[last] <= floor
        if (at_floor and not loss < kept_loss[last]) or (not at_floor and not loss < target):
            return count
    solved = solve_scale(residual, root, target, scale, floor)
    loss = rho_sum(residual, root, solved)
    place = min(count, last)
    if count > last and not _precedes(solved, loss, kept_scale[last], kept_loss[last]):
        return count
    while place > 0 and _precedes(solved, loss, kept_scale[place - 1], kept_loss[place - 1]):
        kept[place] = kept[place - 1]
        kept_scale[place] = kept_scale[place - 1]
        kept_loss[place] = kept_loss[place - 1]
        place -= 1
    kept[place] = theta
    kept_scale[place] = solved
    kept_loss[place] = loss
    return min(count + 1, last + 1)


def s_estimate(
    columns: FloatArray,
    y: FloatArray,
    weights: FloatArray | None = None,
    *,
    starts: FloatArray,
    floor: float,
) -> SEstimate:
    """S-estimate, breakdown 50 %, from given starts.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
    y : ndarray of float64, shape (n,)
    weights : ndarray of float64, shape (n,), optional
        Precisions with mean 1.
    starts : ndarray of float64, shape (m, p)
        m >= 1 candidate coefficients, as of
        :func:`~estimators.regression.minimal_fits.solve_samples`.
    floor : float
        Least scale, positive.

    Returns
    -------
    SEstimate

    Examples
    --------
    >>> import numpy as np
    >>> from estimators.regression.minimal_fits import solve_samples
    >>> t = np.linspace(-1.0, 1.0, 9)
    >>> y = 1.0 + 2.0 * t
    >>> y[6:] = 50.0
    >>> columns = np.vstack([np.ones(9), t])
    >>> starts = solve_samples(columns, y, np.array([[0, 1], [3, 8]]))
    >>> fit = s_estimate(columns, y, starts=starts, floor=1e-12)
    >>> fit.theta.round(9).tolist(), fit.is_exact
    ([1.0, 2.0], True)
    """
    p, n = columns.shape
    precision = np.ones(n) if weights is None else weights
    kept, scale, loss = np.empty((KEPT, p)), np.empty(KEPT), np.empty(KEPT)
    starts = np.ascontiguousarray(starts)
    evaluations = 0
    if n > 2 * SCREENED_POINTS:
        part = _spread_points(n, SCREENED_POINTS)
        found = _fast_s(
            np.ascontiguousarray(columns[:, part]),
            y[part],
            precision[part],
            starts,
            floor,
            _ROUNDS,
            kept,
            scale,
            loss,
        )
        evaluations += 2 * SCREENED_POINTS * starts.shape[0]
        starts = kept[:found].copy()
    _fast_s(columns, y, precision, starts, floor, _ROUNDS, kept, scale, loss)
    evaluations += 2 * n * starts.shape[0]
    sigma = float(scale[0])
    residual = y - _fitted(columns, kept[0])
    return SEstimate(kept[0].copy(), residual, sigma, sigma <= floor, evaluations)


def _spread_points(n: int, wanted: int) -> IntArray:
    """Pick one point from each of ``wanted`` equal shares, at places that no period of the data follows."""
    share = np.arange(wanted)
    within = share * _GOLDEN_SECTION % 1.0
    return np.minimum(((share + within) * (n / wanted)).astype(np.int64), n - 1)


def _fitted(columns: FloatArray, theta: FloatArray) -> FloatArray:
    fitted = theta[0] * columns[0]
    for j in range(1, theta.size):
        fitted += theta[j] * columns[j]
    return np.asarray(fitted, dtype=np.float64)
