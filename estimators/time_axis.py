"""The caller's times and the numbers they become.

Times are subtracted as integers before they become floats (METHODS.md 13.2: float64 epoch nanoseconds are
256 ns apart), so that the first time is 0 and no digit is lost.
"""

from __future__ import annotations

import datetime as dt
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from estimators.arrays import (
    LARGEST_TIME,
    SMALLEST_TIME,
    ArrayLike,
    FloatArray,
    InputError,
    as_column,
    as_vector,
)

_EARLIEST, _LATEST = np.datetime64("1678-01-01T00:00:00"), np.datetime64("2261-12-31T23:59:59")


@dataclass(frozen=True, slots=True)
class TimeAxis:
    """How numbers on the internal time axis relate to the caller's times.

    Attributes
    ----------
    kind : {"number", "datetime"}
        Plain numbers, or points in time (the unit is then the second).
    origin : float or int or numpy.datetime64
        The caller's time at internal time 0 (the first time).
    """

    kind: Literal["number", "datetime"]
    origin: float | int | np.datetime64

    def to_internal(self, times: ArrayLike) -> FloatArray:
        """Caller's times to seconds or units since the origin, subtracting integers exactly.

        Parameters
        ----------
        times : array_like
            Of the same kind as the series.

        Returns
        -------
        ndarray of float64
            NaN where a time is missing (NaT or NaN).
        """
        if isinstance(self.origin, np.datetime64):
            return _datetimes_since(as_moments(times), self.origin)
        array = np.asarray(times)
        if array.dtype.kind == "M":
            raise InputError("t", "expected plain numbers, as in the series, not points in time")
        if array.dtype.kind in "iu" and isinstance(self.origin, int):
            return _integers_since(array, self.origin)
        return np.asarray(np.asarray(array, dtype=np.float64) - float(self.origin), dtype=np.float64)

    def read(self, times: ArrayLike) -> tuple[npt.NDArray[Any], FloatArray]:
        """Check the times at which somebody wants a prediction.

        Parameters
        ----------
        times : array_like, shape (k,), or one time
            Of the same kind as the series; points in time may be ISO 8601.

        Returns
        -------
        column : ndarray, shape (k,)
            Numbers or datetime64[ns].
        internal : ndarray of float64, shape (k,)
            Since the origin; NaN where a time is missing.

        Raises
        ------
        InputError
            If the times are of another kind, infinite or too large.

        Examples
        --------
        >>> TimeAxis("number", 2000).read(2010)
        (array([2010]), array([10.]))
        """
        column = as_column(np.atleast_1d(np.asarray(times)), "t")
        if self.kind == "datetime":
            column = as_moments(column)
        elif _first_present(column) is not None and hasattr(_first_present(column), "isoformat"):
            raise InputError("t", "expected plain numbers, as in the series, not points in time")
        elif column.dtype.kind not in "iuM":
            column = as_vector(column, "t")
            if np.any(np.abs(column) > LARGEST_TIME):
                raise InputError("t", f"a time is beyond ±{LARGEST_TIME:g}")
        return column, self.to_internal(column)

    def from_internal(self, internal: FloatArray) -> npt.NDArray[np.float64] | npt.NDArray[np.datetime64]:
        """Seconds or units since the origin to the caller's kind of time."""
        if isinstance(self.origin, np.datetime64):
            nanoseconds = np.round(np.asarray(internal) * 1e9).astype("timedelta64[ns]")
            return np.asarray(self.origin.astype("datetime64[ns]") + nanoseconds)
        return np.asarray(np.asarray(internal) + float(self.origin), dtype=np.float64)


def as_times(t: ArrayLike) -> tuple[FloatArray, TimeAxis, npt.NDArray[Any]]:
    """Read the times of a series.

    Parameters
    ----------
    t : array_like, shape (n,)
        Numbers, datetime64 or ``datetime``.

    Returns
    -------
    internal : ndarray of float64, shape (n,)
        Since the first time; NaN where a time is missing.
    axis : TimeAxis
    column : ndarray, shape (n,)
        The caller's times as numbers or datetime64[ns].

    Raises
    ------
    InputError
        If they are neither numbers nor points in time, or too large or too small to compute with.
    """
    array = as_column(t, "t")
    if array.dtype.kind == "U":
        raise InputError("t", "expected numbers or points in time, got text; make datetime64 of ISO 8601")
    if array.dtype.kind == "O" and hasattr(_first_present(array), "isoformat"):
        array = as_moments(array)
    if array.dtype.kind == "M":
        moments = as_moments(array)
        valid = moments[~np.isnat(moments)]
        origin = np.datetime64(valid.min() if valid.size else 0, "ns")
        return _datetimes_since(moments, origin), TimeAxis("datetime", origin), moments
    if array.dtype.kind in "iu" and array.size:
        first = int(array.min())
        return _integers_since(array, first), TimeAxis("number", first), array
    numbers = as_vector(array, "t")
    start, end = _limits(numbers)
    _check_size(start, end)
    if array.dtype.kind == "O" and array.size:
        exact = _exact_integers(array)
        if exact is not None:
            return *exact, numbers
    return numbers - start, TimeAxis("number", start), numbers


def _first_present(array: npt.NDArray[Any]) -> object:
    """First of the caller's objects that is not missing; None if there is none."""
    if array.dtype.kind != "O":
        return None
    # NaN, NaT and pandas' NA are not equal to themselves (NA's answer is NA, which is no True either).
    return next((value for value in array if value is not None and (value == value) is True), None)  # noqa: PLR0124


def _exact_integers(array: npt.NDArray[Any]) -> tuple[FloatArray, TimeAxis] | None:
    """Integers with gaps, as in a list with None: subtracted before they become floats."""
    present = [value for value in array if isinstance(value, (int, np.integer))]
    missing = [value is None or value != value for value in array]  # noqa: PLR0124
    if not present or len(present) + sum(missing) < array.size:
        return None
    first = int(min(present))
    since = [
        np.nan if gone else float(int(value) - first) for value, gone in zip(array, missing, strict=True)
    ]
    return np.array(since), TimeAxis("number", first)


def _limits(numbers: FloatArray) -> tuple[float, float]:
    """Least and greatest of the finite times; 0 and 0 if there are none."""
    if not numbers.size:
        return 0.0, 0.0
    low, high = float(numbers.min()), float(numbers.max())
    if np.isfinite(low) and np.isfinite(high):
        return low, high
    finite = numbers[np.isfinite(numbers)]
    return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)


def _check_size(low: float, high: float) -> None:
    """Refuse plain times with which slopes and predictions would overflow."""
    largest = max(high, -low)
    if largest > LARGEST_TIME or 0.0 < largest < SMALLEST_TIME:
        limits = f"from {SMALLEST_TIME:g} to {LARGEST_TIME:g} in size"
        raise InputError("t", f"the largest of plain times is {limits}; choose another unit")


def as_moments(times: ArrayLike) -> npt.NDArray[np.datetime64]:
    """Points in time as ``datetime64[ns]`` in UTC.

    Parameters
    ----------
    times : array_like
        datetime64, ``datetime``, pandas Timestamps or ISO 8601; without an offset they are taken as UTC.

    Returns
    -------
    ndarray of datetime64[ns]
        Of the same shape; NaT where a time is missing.

    Raises
    ------
    InputError
        If the times are no points in time.

    Examples
    --------
    >>> as_moments(["2025-10-01T02:00:00+02:00"])
    array(['2025-10-01T00:00:00.000000000'], dtype='datetime64[ns]')
    """
    array = np.asarray(times)
    if array.dtype.kind == "M":
        return _to_nanoseconds(array)
    if not array.size:
        return np.empty(array.shape, dtype="datetime64[ns]")
    if array.dtype.kind not in "OU":
        raise InputError("t", "expected points in time (datetime64), as in the series")
    try:
        moments = [_as_utc(value) for value in array.ravel()]
    except InputError:
        raise
    except (ValueError, TypeError) as error:
        raise InputError("t", "expected points in time") from error
    return np.asarray(moments, dtype="datetime64[ns]").reshape(array.shape)


def _as_utc(value: object) -> np.datetime64:
    """``datetime`` (naive is UTC), pandas Timestamp, ISO 8601 or NaT/None to datetime64 in UTC."""
    # NaT and NaN, pandas' too, are the values unequal to themselves.
    if value is None or value != value:  # noqa: PLR0124
        return np.datetime64("NaT")
    if isinstance(value, str):
        if value.endswith("Z"):
            return _moment(value[:-1])
        value = dt.datetime.fromisoformat(value)
    in_zone = getattr(value, "astimezone", None)
    if in_zone is not None and getattr(value, "tzinfo", None) is not None:
        value = in_zone(dt.UTC).replace(tzinfo=None)
    return _moment(value)


def _moment(value: Any) -> np.datetime64:
    """Text or ``datetime`` without a zone, to the nanosecond."""
    _check_years(np.asarray(np.datetime64(value)))
    return np.datetime64(value, "ns")


def _to_nanoseconds(array: npt.NDArray[np.datetime64]) -> npt.NDArray[np.datetime64]:
    """Any unit as nanoseconds; casting wraps round silently beyond what they can hold."""
    moments = array.astype("datetime64[ns]")
    if array.dtype != moments.dtype:
        _check_years(array)
    return moments


def _check_years(array: npt.NDArray[np.datetime64]) -> None:
    seconds = array.astype("datetime64[s]")
    if np.any(~np.isnat(array) & ((seconds < _EARLIEST) | (seconds > _LATEST))):
        raise InputError("t", "points in time lie between the years 1678 and 2261; send numbers instead")


def _datetimes_since(moments: npt.NDArray[np.datetime64], origin: np.datetime64) -> FloatArray:
    first = int(origin.astype("datetime64[ns]").astype(np.int64))
    counts = moments.astype(np.int64)
    missing = np.isnat(moments)
    if not missing.any():
        return _integers_since(counts, first) / 1e9
    seconds = np.full(moments.shape, np.nan)
    seconds[~missing] = _integers_since(counts[~missing], first) / 1e9
    return seconds


def _integers_since(array: npt.NDArray[np.integer], origin: int) -> FloatArray:
    """``array - origin`` as floats, without loss also where the difference leaves 64 bits with a sign."""
    if not array.size:
        return np.empty(array.shape)
    low, high = int(array.min()) - origin, int(array.max()) - origin
    # Unsigned arithmetic is modulo 2**64, so any difference that 64 bits can hold comes out right.
    since = array.astype(np.uint64) - np.uint64(origin % 2**64)
    if low >= -(2**63) and high < 2**63:
        return since.astype(np.int64).astype(np.float64)
    if low >= 0 and high < 2**64:
        return since.astype(np.float64)
    return np.array([int(value) - origin for value in array.ravel()], dtype=np.float64).reshape(array.shape)
