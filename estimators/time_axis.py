"""The caller's times and the numbers they become.

Times are subtracted as integers before they become floats (METHODS.md 13.2: float64 epoch nanoseconds are
256 ns apart), so that the first time is 0 and no digit is lost.
"""

from __future__ import annotations

import datetime as dt
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from estimators.arrays import ArrayLike, FloatArray, InputError, as_vector


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
        if np.issubdtype(array.dtype, np.datetime64):
            raise InputError("t", "expected plain numbers, as in the series, not datetimes")
        if np.issubdtype(array.dtype, np.integer) and isinstance(self.origin, int):
            return _integers_since(array, self.origin)
        return np.asarray(np.asarray(array, dtype=np.float64) - float(self.origin), dtype=np.float64)

    def from_internal(self, internal: FloatArray) -> npt.NDArray[np.float64] | npt.NDArray[np.datetime64]:
        """Seconds or units since the origin to the caller's kind of time."""
        if isinstance(self.origin, np.datetime64):
            nanoseconds = np.round(np.asarray(internal) * 1e9).astype("timedelta64[ns]")
            return np.asarray(self.origin.astype("datetime64[ns]") + nanoseconds)
        return np.asarray(np.asarray(internal) + float(self.origin), dtype=np.float64)


def as_times(t: ArrayLike) -> tuple[FloatArray, TimeAxis]:
    """Internal times and their axis; NaN where a time is missing.

    Parameters
    ----------
    t : array_like, shape (n,)
        Numbers, datetime64 or ``datetime``.

    Returns
    -------
    internal : ndarray of float64, shape (n,)
        Since the first time.
    axis : TimeAxis
    """
    array = np.asarray(t)
    if array.ndim != 1:
        raise InputError("t", f"expected one dimension, got shape {array.shape}")
    if array.dtype.kind == "O" and any(hasattr(value, "isoformat") for value in array[:8]):
        array = as_moments(array)
    if array.dtype.kind == "M":
        valid = array[~np.isnat(array)]
        origin = np.datetime64(valid.min() if valid.size else 0, "ns")
        return _datetimes_since(array, origin), TimeAxis("datetime", origin)
    if array.dtype.kind in "iu" and array.size:
        first = int(array.min())
        return _integers_since(array, first), TimeAxis("number", first)
    numbers = as_vector(array, "t")
    finite = numbers[np.isfinite(numbers)]
    start = float(finite.min()) if finite.size else 0.0
    return numbers - start, TimeAxis("number", start)


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
        return array.astype("datetime64[ns]")
    if array.dtype.kind not in "OU":
        raise InputError("t", "expected points in time (datetime64), as in the series")
    try:
        moments = [_as_utc(value) for value in array.ravel()]
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
            return np.datetime64(value[:-1], "ns")
        value = dt.datetime.fromisoformat(value)
    in_zone = getattr(value, "astimezone", None)
    if in_zone is not None and getattr(value, "tzinfo", None) is not None:
        value = in_zone(dt.UTC).replace(tzinfo=None)
    return np.datetime64(value, "ns")  # type: ignore[call-overload,no-any-return]


def _datetimes_since(array: npt.NDArray[np.datetime64], origin: np.datetime64) -> FloatArray:
    delta = array.astype("datetime64[ns]") - origin.astype("datetime64[ns]")
    seconds = delta.astype(np.int64) / 1e9
    return np.where(np.isnat(array), np.nan, seconds)


def _integers_since(array: npt.NDArray[np.integer], origin: int) -> FloatArray:
    if array.dtype == np.uint64:
        array = array.astype(object)
        return np.asarray([int(value) - origin for value in array.ravel()], dtype=np.float64)
    return (array.astype(np.int64) - np.int64(origin)).astype(np.float64)
