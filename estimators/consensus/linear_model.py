"""The linear model y = theta . x as a :class:`~estimators.consensus.protocols.Model`.

Its kernels are entries to the functions that the compiled path runs, so that the readable engine computes
the same bytes.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.found import LinearData
from estimators.consensus.protocols import Solved
from estimators.consensus.scan import Rows, fill_residuals, residual_at
from estimators.consensus.solve import fit_members, solve_exactly
from estimators.kernels import device, kernel, ro

# Only the data are read-only: with the types of the compiled path, compiled code is shared.
_COLUMNS, _VALUES = ro(types.float64, 2), ro(types.float64)
_MODEL, _MODELS = types.float64[::1], types.float64[:, ::1]
_POINTS, _SAMPLES = types.int64[::1], types.int64[:, ::1]


@device
def smallest_threshold(y: FloatArray) -> float:
    """Residual that rounding alone can leave: a few units in the last place of the values, never 0."""
    largest = 0.0
    for i in range(y.size):
        largest = max(largest, abs(y[i]))
    return max(8.0 * 2.0**-52 * largest, 1e-150)


@device
def is_finite(theta: FloatArray) -> bool:
    """Model check after solving."""
    j = 0
    while j < theta.size and math.isfinite(theta[j]):
        j += 1
    return j == theta.size


@kernel(types.float64(_VALUES))
def find_smallest_threshold(y: FloatArray) -> float:
    """Entry to :func:`smallest_threshold`."""
    return smallest_threshold(y)


@kernel(types.void(_COLUMNS, _VALUES, _SAMPLES, _MODELS, types.boolean[::1]))
def solve_samples(
    columns: FloatArray, y: FloatArray, samples: IntArray, theta: FloatArray, usable: BoolArray
) -> None:
    """Entry to :func:`solve_exactly`; ``usable`` is False for degenerate samples."""
    p = columns.shape[0]
    rows = Rows(columns, 0, y)
    system = np.empty((p, p + 1))
    for k in range(samples.shape[0]):
        usable[k] = solve_exactly(rows, samples[k], system, theta[k])


@kernel(types.void(_COLUMNS, _VALUES, _MODELS, types.int64, _MODELS))
def fill_residual_rows(
    columns: FloatArray, y: FloatArray, theta: FloatArray, start: int, out: FloatArray
) -> None:
    """Entry to :func:`fill_residuals` for several models."""
    rows = Rows(columns, 0, y)
    for k in range(theta.shape[0]):
        fill_residuals(rows, theta[k], start, out.shape[1], out[k])


@kernel(types.void(_COLUMNS, _VALUES, _MODEL, _POINTS, types.float64[::1]))
def fill_residuals_at(
    columns: FloatArray, y: FloatArray, theta: FloatArray, points: IntArray, out: FloatArray
) -> None:
    """Entry to :func:`residual_at` for several points."""
    rows = Rows(columns, 0, y)
    for k in range(points.size):
        out[k] = residual_at(rows, theta, points[k])


@kernel(types.boolean(_COLUMNS, _VALUES, _POINTS, _MODEL, _MODEL))
def fit_points(
    columns: FloatArray, y: FloatArray, members: IntArray, start: FloatArray, theta: FloatArray
) -> bool:
    """Entry to :func:`fit_members`."""
    p = columns.shape[0]
    return fit_members(Rows(columns, 0, y), members, members.size, start, np.empty((p, p + 1)), theta)


def whiten(data: LinearData) -> tuple[FloatArray, FloatArray]:
    """Columns and values times the square roots of the precisions; the data themselves without weights."""
    if data.weights is None:
        return data.columns, data.y
    root = np.sqrt(data.weights)
    return np.ascontiguousarray(data.columns * root), data.y * root


class LinearModel:
    """Linear model of one data set.

    Parameters
    ----------
    data : LinearData
        With weights, residuals are multiplied by the square root of the precision.

    Examples
    --------
    >>> t = np.array([-1.0, 0.0, 1.0])
    >>> model = LinearModel(LinearData(np.array([np.ones(3), t]), 2.0 * t, t, None))
    >>> model.solve(np.array([[0, 2]])).theta
    array([[0., 2.]])
    """

    def __init__(self, data: LinearData) -> None:
        self._data = data
        self._columns, self._y = whiten(data)

    @property
    def n(self) -> int:
        """Number of points."""
        return self._data.n

    @property
    def p(self) -> int:
        """Number of coefficients."""
        return self._data.p

    @property
    def sample_size(self) -> int:
        """As many points as coefficients."""
        return self._data.p

    @property
    def resolution(self) -> float:
        """A few units in the last place of the values."""
        return find_smallest_threshold(self._y)

    def solve(self, samples: IntArray) -> Solved:
        """Models through p points each; samples with dependent rows are degenerate."""
        theta = np.empty((samples.shape[0], self.p))
        usable = np.empty(samples.shape[0], dtype=np.bool_)
        solve_samples(self._data.columns, self._data.y, samples, theta, usable)
        finite = usable & np.isfinite(theta).all(axis=1)
        owner = np.flatnonzero(finite).astype(np.int64)
        degenerate = int(np.count_nonzero(~usable))
        return Solved(theta[owner], owner, degenerate, samples.shape[0] - degenerate - owner.size)

    def residuals(self, theta: FloatArray, start: int, stop: int) -> FloatArray:
        """Whitened residuals of several models at a stretch of points."""
        out = np.empty((theta.shape[0], stop - start))
        fill_residual_rows(self._columns, self._y, theta, start, out)
        return out

    def residuals_at(self, theta: FloatArray, points: IntArray) -> FloatArray:
        """Whitened residuals of one model at chosen points."""
        out = np.empty(points.size)
        fill_residuals_at(self._columns, self._y, theta, points, out)
        return out

    def fit(self, members: IntArray, theta: FloatArray) -> FloatArray | None:
        """Weighted least squares through the members."""
        out = np.empty(self.p)
        return out if fit_points(self._columns, self._y, members, theta, out) else None

    def raw_residuals(self, theta: FloatArray) -> FloatArray:
        """Residuals before weighting, shape (n,)."""
        out = np.empty((1, self.n))
        fill_residual_rows(self._data.columns, self._data.y, theta[None, :], 0, out)
        return out.ravel()
