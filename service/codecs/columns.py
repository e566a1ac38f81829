"""What every input format becomes: :class:`Columns`, and the form its times came in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from service.errors import invalid_value
from service.schemas.fields import TimeUnit

Times: TypeAlias = npt.NDArray[np.float64] | npt.NDArray[np.int64] | npt.NDArray[np.datetime64]
WireTimes: TypeAlias = Times | list[Any]

UNIT_NANOSECONDS: dict[TimeUnit, int] = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}

#: datetime64[ns] reaches from 1677-09-21 to 2262-04-11; the first moment of 2262 lies safely inside.
NANOSECOND_LIMIT = 9_214_646_400 * 10**9


@dataclass(frozen=True, slots=True)
class TimeForm:
    """How the caller writes times, so that the answer writes them likewise.

    Attributes
    ----------
    kind : {"number", "iso", "epoch"}
        Plain numbers, ISO 8601 text, or numbers since 1970 in ``unit``.
    unit : {"s", "ms", "us", "ns"} or None
    """

    kind: Literal["number", "iso", "epoch"]
    unit: TimeUnit | None = None

    def render(self, times: Times) -> WireTimes:
        """Write times as the caller does, ready for orjson; null where one is missing.

        Parameters
        ----------
        times : ndarray
            Numbers for kind ``number``, datetime64[ns] for the others.
        """
        if self.kind == "number":
            return times
        moments = times.astype("datetime64[ns]")
        missing = np.isnat(moments)
        if self.kind == "iso":
            return _iso_texts(moments, missing)
        return _epoch_numbers(moments, missing, UNIT_NANOSECONDS[self.unit or "s"])


@dataclass(frozen=True, slots=True)
class Columns:
    """A series as it came, in arrays that ``estimators`` take as they are.

    Attributes
    ----------
    time : ndarray, shape (n,)
        float64 or int64 for plain numbers, datetime64[ns] otherwise; NaN or NaT where missing.
    value : ndarray of float64, shape (n,)
        NaN where missing.
    weight : ndarray of float64, shape (n,), or None
    predict : ndarray, shape (k,), or None
        Of the same type as ``time``.
    form : TimeForm
    horizon : ndarray, shape (1,), or None
        Time by which values are to be reached, of the same type as ``time``.
    own : mapping of str to ndarray of float64, shape (n,)
        Further columns of the caller, to be fitted along; NaN where missing.
    """

    time: Times
    value: npt.NDArray[np.float64]
    weight: npt.NDArray[np.float64] | None
    predict: Times | None
    form: TimeForm
    horizon: Times | None = None
    own: Mapping[str, npt.NDArray[np.float64]] = field(default_factory=dict)


def from_epoch(
    numbers: npt.NDArray[np.float64] | npt.NDArray[np.int64],
    unit: TimeUnit,
    field: str,
    missing: npt.NDArray[np.bool_] | None = None,
) -> Times:
    """Epoch numbers to datetime64[ns]; integers exactly, fractions to the nearest nanosecond.

    Parameters
    ----------
    numbers : ndarray of float64 or int64, shape (n,)
    unit : {"s", "ms", "us", "ns"}
    field : str
        Name used in errors.
    missing : ndarray of bool, shape (n,), optional
        Rows to become NaT; default: where the numbers are NaN.

    Returns
    -------
    ndarray of datetime64[ns], shape (n,)

    Raises
    ------
    Problem
        If a number lies outside of the years that nanoseconds can reach.
    """
    factor = UNIT_NANOSECONDS[unit]
    missing = np.isnan(numbers) if missing is None else missing
    limit = NANOSECOND_LIMIT // factor
    outside = ~missing & ((numbers > limit) | (numbers < -limit))
    if np.any(outside):
        row = int(np.argmax(outside))
        raise invalid_value(field, f"lies outside of the years 1678 to 2261 when read in {unit!r}", row)
    if numbers.dtype.kind == "f":
        filled = np.where(missing, 0.0, numbers)
        whole = np.floor(filled)
        # The fraction is scaled apart: a double of epoch seconds times 1e9 would lose its last 256 ns.
        nanoseconds = whole.astype(np.int64) * factor + np.rint((filled - whole) * factor).astype(np.int64)
    else:
        nanoseconds = numbers.astype(np.int64) * factor
    moments: npt.NDArray[np.datetime64] = nanoseconds.astype("datetime64[ns]")
    moments[missing] = np.datetime64("NaT")
    return moments


def are_whole(times: Times, form: TimeForm) -> bool:
    """Whether times since 1970 are integers in their unit."""
    if form.kind != "epoch":
        return True
    return not np.any(times.astype("datetime64[ns]").astype(np.int64) % UNIT_NANOSECONDS[form.unit or "s"])


def _epoch_numbers(
    moments: npt.NDArray[np.datetime64], missing: npt.NDArray[np.bool_], factor: int
) -> WireTimes:
    nanoseconds = moments.astype(np.int64)
    whole, rest = np.divmod(nanoseconds, factor)
    if np.any(rest[~missing]):
        return np.where(missing, np.nan, whole + rest / factor)
    if not np.any(missing):
        return np.asarray(whole)
    return [None if gone else number for number, gone in zip(whole.tolist(), missing.tolist(), strict=True)]


def _iso_texts(moments: npt.NDArray[np.datetime64], missing: npt.NDArray[np.bool_]) -> WireTimes:
    seconds = moments.astype("datetime64[s]")
    if not np.any(missing) and np.all(seconds == moments):
        return np.asarray(seconds)  # orjson writes whole seconds itself, ten times faster
    texts = np.strings.rstrip(np.strings.rstrip(np.datetime_as_string(moments, unit="ns"), "0"), ".").tolist()
    return [None if gone else f"{text}Z" for text, gone in zip(texts, missing.tolist(), strict=True)]
