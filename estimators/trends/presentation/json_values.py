"""Times in JSON-safe form: what JSON lacks becomes null."""

from __future__ import annotations

from typing import Any

import numpy as np

from estimators.presentation.json_values import numbers_to_json


def time_to_json(times: np.ndarray[Any, Any]) -> list[Any]:
    """Numbers stay numbers (integers exactly); points in time become ISO 8601 in UTC; missing times None."""
    if times.dtype.kind == "M":
        return _iso_column(times.astype("datetime64[ns]"))
    if times.dtype.kind in "iu":
        return list(times.tolist())
    return numbers_to_json(np.asarray(times, dtype=np.float64))


def _iso_column(moments: np.ndarray[Any, np.dtype[np.datetime64]]) -> list[str | None]:
    missing = np.isnat(moments)
    whole_seconds = moments.astype("datetime64[s]")
    if np.all(missing | (whole_seconds == moments)):
        texts: list[str | None] = [f"{text}Z" for text in np.datetime_as_string(whole_seconds).tolist()]
    else:
        texts = [_with_zone(text) for text in np.datetime_as_string(moments).tolist()]
    for row in np.flatnonzero(missing).tolist():
        texts[row] = None
    return texts


def _with_zone(text: str) -> str:
    """ISO 8601 text without the zeros that end its fraction, and with ``Z``."""
    head, _, fraction = text.partition(".")
    fraction = fraction.rstrip("0")
    return f"{head}.{fraction}Z" if fraction else f"{head}Z"


def iso_utc(moment: np.datetime64) -> str:
    """ISO 8601 with ``Z``, as few decimals of a second as the moment needs."""
    return _with_zone(str(moment.astype("datetime64[ns]")))


def origin_to_json(origin: float | np.datetime64) -> float | str:
    """Origin as a number or ISO 8601."""
    if isinstance(origin, np.datetime64):
        return iso_utc(origin)
    # A large integer, such as epoch nanoseconds, would lose digits as a float.
    return int(origin) if isinstance(origin, int) else float(origin)
