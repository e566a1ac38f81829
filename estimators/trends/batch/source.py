"""The columns of many series, checked once, and the settings they are all fitted with.

Series k is rows ``offsets[k]:offsets[k + 1]``. Whatever the compiled path does not take is answered here,
one series at a time, by :func:`estimators.trends.fit.fit_trend`: that answer is what all others equal.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from inspect import signature
from typing import Any

import numpy as np

from estimators.arrays import ArrayLike, FloatArray, InputError, IntArray, Reason, as_column, as_vector
from estimators.options import RobustOptions
from estimators.result import NoFit, NoFitReason, Points
from estimators.series import as_series
from estimators.time_axis import as_moments, as_times
from estimators.trends.fit import fit_trend
from estimators.trends.trend import Trend
from estimators.trends.unpack import plain_column


@dataclass(frozen=True, slots=True)
class Settings:
    """What all series are fitted with; the arguments of :func:`~estimators.trends.fit.fit_trend`.

    ``further`` holds those that have no name here, such as ``uncertainty``.
    """

    model: str
    method: str
    threshold: float | None
    sigma: float | None
    level: float
    seed: int
    options: RobustOptions
    further: Mapping[str, Any] = field(default_factory=dict)

    @property
    def is_usual(self) -> bool:
        """Whether all further arguments have their usual values."""
        usual = signature(fit_trend).parameters
        return all(_is_default(value, usual[name].default) for name, value in self.further.items())

    def fit(self, t: ArrayLike, y: ArrayLike, weights: ArrayLike | None = None) -> Trend | NoFit:
        """Fit one series with these settings."""
        return fit_trend(
            t,
            y,
            model=self.model,
            method=self.method,
            threshold=self.threshold,
            sigma=self.sigma,
            weights=weights,
            level=self.level,
            seed=self.seed,
            options=self.options,
            **self.further,
        )


def _is_default(value: object, default: object) -> bool:
    """Whether an argument has its default; arrays, which compare one by one, never do."""
    return value is default or (isinstance(value, str) and value == default)


@dataclass(frozen=True, slots=True)
class Source:
    """Many series, CSR-style.

    Attributes
    ----------
    times : ndarray, shape (total,), or (n,) if shared
        float64, integers, datetime64[ns], or objects that are looked at series by series.
    values : ndarray of float64, shape (total,)
    weights : ndarray of float64, shape (total,), or None
    offsets : ndarray of int64, shape (series + 1,)
    shared : bool
        Whether all series have the same times.
    settings : Settings
    """

    times: np.ndarray[Any, Any]
    values: FloatArray
    weights: FloatArray | None
    offsets: IntArray
    shared: bool
    settings: Settings

    @property
    def series(self) -> int:
        """Number of series."""
        return int(self.offsets.size) - 1

    def columns(self, k: int) -> tuple[np.ndarray[Any, Any], FloatArray, FloatArray | None]:
        """Return times, values and weights of series k, as views."""
        a, b = int(self.offsets[k]), int(self.offsets[k + 1])
        times = self.times if self.shared else self.times[a:b]
        return times, self.values[a:b], None if self.weights is None else self.weights[a:b]

    def answer(self, k: int) -> Trend | NoFit:
        """Fit series k alone; data that :func:`fit_trend` refuses by an exception are told as ``NoFit``."""
        t, y, weights = self.columns(k)
        try:
            as_series(t, y, weights)
            # The settings were checked; what is refused now is refused for what this series holds.
            return self.settings.fit(t, y, weights)
        except InputError as error:
            return _unusable(str(error), t, y)


def _unusable(message: str, t: np.ndarray[Any, Any], y: FloatArray) -> NoFit:
    nothing = np.full(y.size, np.nan)
    codes = np.full(y.size, int(Reason.invalid), dtype=np.uint8)
    points = Points(np.zeros(y.size, dtype=np.bool_), nothing, nothing.copy(), codes)
    return NoFit(NoFitReason.invalid_input, message, points, (), t, y)


def read_source(
    t: ArrayLike,
    values: ArrayLike,
    offsets: ArrayLike | None,
    weights: ArrayLike | None,
    settings: Settings,
) -> Source:
    """Check the columns of a batch for type and shape; what they hold is looked at series by series.

    Parameters
    ----------
    t : array_like, shape (total,) or (n,)
    values : array_like, shape (total,) or (series, n)
    offsets : array_like of int, shape (series + 1,), or None
        None with values of shape (series, n).
    weights : array_like of the shape of the values, or None
    settings : Settings

    Returns
    -------
    Source

    Raises
    ------
    InputError
        If columns and offsets do not belong together, or hold neither numbers nor times.

    Examples
    --------
    >>> asked = Settings("line", "auto", None, None, 0.95, 0, RobustOptions())
    >>> source = read_source([0, 1, 2], [[5.0, 6.0, 7.0], [1.0, 1.0, 1.0]], None, None, asked)
    >>> source.series, source.shared, source.offsets
    (2, True, array([0, 3, 6]))
    """
    column: Any = plain_column(values)
    shape = _shape(column) if offsets is None else None
    if shape is not None:
        column = np.asarray(column).reshape(-1)
    numbers = as_vector(column, "values")
    if shape is not None:
        bounds = np.arange(shape[0] + 1, dtype=np.int64) * shape[1]
    else:
        bounds = _read_offsets(offsets, numbers.size)
    times = _read_times(t)
    shared = shape is not None and times.size == shape[1]
    if not shared and times.size != numbers.size:
        expected = f"{numbers.size} values" if shape is None else f"values of shape {shape}"
        raise InputError("t", f"{times.size} times for {expected}; give one time per value")
    precision = None
    if weights is not None:
        given: Any = plain_column(weights)
        precision = as_vector(given if shape is None else np.asarray(given).reshape(-1), "weights")
        if precision.size != numbers.size:
            message = f"{precision.size} weights for {numbers.size} values; give one weight per value"
            raise InputError("weights", message)
    return Source(times, numbers, precision, bounds, shared, settings)


def _shape(values: Any) -> tuple[int, int]:
    try:
        shape = np.shape(values)
    except ValueError as error:
        raise InputError("values", "rows of unequal lengths; give one column and offsets") from error
    if len(shape) != 2:
        raise InputError("offsets", "without offsets the values need the shape (series, n)")
    return int(shape[0]), int(shape[1])


def _read_offsets(offsets: ArrayLike | None, total: int) -> IntArray:
    column = as_column(plain_column(offsets), "offsets")
    if column.dtype.kind not in "iu" or not column.size:
        raise InputError("offsets", "expected integers, one more than there are series")
    bounds = np.ascontiguousarray(column, dtype=np.int64)
    if bounds[0] != 0 or bounds[-1] != total or np.any(bounds[1:] < bounds[:-1]):
        raise InputError("offsets", f"must rise from 0 to the number of values, which is {total}")
    return bounds


def _read_times(t: ArrayLike) -> np.ndarray[Any, Any]:
    """Read times as float64, integers or datetime64[ns]; objects that are neither stay as they are."""
    column = as_column(plain_column(t), "t")
    if column.dtype.kind in "iu":
        return np.ascontiguousarray(column, dtype=column.dtype.newbyteorder("="))
    if column.dtype.kind == "f":
        return as_vector(column, "t")
    if column.dtype.kind == "M":
        return np.ascontiguousarray(as_moments(column))
    _, axis, read = as_times(column)
    return read if axis.kind == "datetime" else column
