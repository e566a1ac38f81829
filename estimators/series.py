"""The one door: a time series checked for shape, finiteness and order.

Whatever enters Plumbline passes :func:`as_series`; behind it every array is float64, finite, sorted by time
and contiguous, and a row index leads back to the caller's order. A series that is in order already, the
usual case, is read once and not copied.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import types

from estimators.arrays import (
    LARGEST_VALUE,
    ArrayLike,
    BoolArray,
    CodeArray,
    FloatArray,
    InputError,
    IntArray,
    Reason,
    as_vector,
)
from estimators.kernels import kernel, ro
from estimators.time_axis import TimeAxis, as_times

EPOCH_NANOSECONDS = 1e17
"""Plain float times beyond this (1973 in nanoseconds) are nanoseconds, and 16 ns or more apart."""


@dataclass(frozen=True, slots=True)
class Series:
    """A checked time series: finite, sorted by time, contiguous.

    Attributes
    ----------
    t : ndarray of float64, shape (m,)
        Time since ``axis.origin``, ascending.
    y : ndarray of float64, shape (m,)
    weights : ndarray of float64, shape (m,), or None
        Precisions (1/variance up to scale), positive, mean 1.
    rows : ndarray of int64, shape (m,), or None
        The caller's row of each kept point; None where point and row are the same.
    reasons : ndarray of uint8, shape (n,)
        A :class:`Reason` per input row; rows that were kept are ``ok`` or ``duplicate``.
    axis : TimeAxis
    was_sorted : bool
    duplicate_times : int
        Number of kept points that share the time of an earlier one.
    float_nanoseconds : bool
        Whether the times are epoch nanoseconds that came as floats.
    input_time, input_values : ndarray, shape (n,)
        The caller's columns as numbers or datetime64[ns], in input order.
    """

    t: FloatArray
    y: FloatArray
    weights: FloatArray | None
    rows: IntArray | None
    reasons: CodeArray
    axis: TimeAxis
    was_sorted: bool
    duplicate_times: int
    float_nanoseconds: bool
    input_time: np.ndarray[Any, Any]
    input_values: FloatArray

    @property
    def n_input(self) -> int:
        """Number of input rows."""
        return int(self.reasons.size)

    @property
    def n(self) -> int:
        """Number of usable points."""
        return int(self.t.size)


@kernel(types.boolean(ro(types.float64), ro(types.float64)))
def is_orderly(t: FloatArray, y: FloatArray) -> bool:
    """Whether all times are finite and strictly ascend, and no value is missing or beyond LARGEST_VALUE."""
    last = -np.inf
    for i in range(t.size):
        if not (t[i] > last and t[i] < np.inf and abs(y[i]) <= LARGEST_VALUE):
            return False
        last = t[i]
    return True


def as_series(t: ArrayLike, y: ArrayLike, weights: ArrayLike | None = None) -> Series:
    """Check a time series and bring it into the form all estimators take.

    Parameters
    ----------
    t : array_like, shape (n,)
        float64, integers, datetime64 or ``datetime``; any order; NaN, NaT and None are missing.
    y : array_like, shape (n,)
        Numbers; NaN and None are missing, infinities are invalid, other values at most LARGEST_VALUE.
    weights : array_like, shape (n,), optional
        Precisions (1/variance up to scale); 0 leaves a row out.

    Returns
    -------
    Series

    Raises
    ------
    InputError
        On unequal lengths, wrong types, magnitudes whose squares overflow, negative or non-finite weights.

    Examples
    --------
    >>> s = as_series([2, 0, 1], [5.0, 1.0, None])
    >>> s.t, s.y, s.rows
    (array([0., 2.]), array([1., 5.]), array([1, 0]))
    """
    internal, axis, input_time = as_times(t)
    values = as_vector(y, "y")
    if internal.size != values.size:
        raise InputError("y", f"{values.size} values for {internal.size} times; give one value per time")
    reasons = np.zeros(values.size, dtype=np.uint8)
    precision = _as_precision(weights, values.size)
    was_sorted = True
    duplicate_times = 0
    rows: IntArray | None = None
    t_kept, y_kept = internal, values
    if not is_orderly(internal, values) or (precision is not None and not precision.all()):
        _refuse_huge(values)
        _mark_unusable(reasons, internal, values, precision)
        rows, was_sorted = _ordered_rows(reasons, internal, values)
        t_kept, y_kept = internal[rows], values[rows]
        same_time = t_kept[1:] == t_kept[:-1]
        duplicate_times = int(np.count_nonzero(same_time))
        repeated = np.flatnonzero(same_time & (y_kept[1:] == y_kept[:-1])) + 1
        reasons[rows[repeated]] = Reason.duplicate
    if precision is not None and t_kept.size:
        precision = precision if rows is None else precision[rows]
        precision = precision / precision.mean()
    return Series(
        t=t_kept,
        y=y_kept,
        weights=precision,
        rows=rows,
        reasons=reasons,
        axis=axis,
        was_sorted=was_sorted,
        duplicate_times=duplicate_times,
        float_nanoseconds=isinstance(axis.origin, float) and axis.origin > EPOCH_NANOSECONDS,
        input_time=input_time,
        input_values=values,
    )


def _as_precision(weights: ArrayLike | None, n: int) -> FloatArray | None:
    if weights is None:
        return None
    precision = as_vector(weights, "weights")
    if precision.size != n:
        raise InputError("weights", f"{precision.size} weights for {n} values; give one weight per value")
    if not np.all(np.isfinite(precision)) or np.any(precision < 0):
        raise InputError("weights", "weights are precisions: finite and not negative")
    # The mean below must neither overflow nor underflow; only the ratios of weights count.
    largest = float(precision.max()) if n else 0.0
    return precision / largest if largest > 0 else precision


def _refuse_huge(values: FloatArray) -> None:
    # NaN compares as False and infinities are invalid rows: only finite values are meant.
    huge: BoolArray = (np.abs(values) > LARGEST_VALUE) & np.isfinite(values)
    if huge.any():
        row = int(np.argmax(huge))
        raise InputError(
            "y", f"row {row} is beyond ±{LARGEST_VALUE:g}, where squares overflow; use a larger unit"
        )


def _mark_unusable(
    reasons: CodeArray, internal: FloatArray, values: FloatArray, precision: FloatArray | None
) -> None:
    reasons[np.isinf(values) | np.isinf(internal)] = Reason.invalid
    reasons[np.isnan(values) | np.isnan(internal)] = Reason.missing
    if precision is not None:
        reasons[(reasons == Reason.ok) & (precision == 0)] = Reason.zero_weight


def _ordered_rows(reasons: CodeArray, internal: FloatArray, values: FloatArray) -> tuple[IntArray, bool]:
    """Usable rows by time, and whether they were in that order already."""
    rows = np.flatnonzero(reasons == Reason.ok)
    t_kept = internal[rows]
    was_sorted = bool(np.all(t_kept[1:] >= t_kept[:-1]))
    if not was_sorted or np.any(t_kept[1:] == t_kept[:-1]):
        # Ties in time are ordered by value so that the answer does not depend on the caller's row order.
        rows = rows[np.lexsort((values[rows], t_kept))]
    return rows, was_sorted
