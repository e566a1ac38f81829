"""Text to points in time, many at a time, with the zone in which each was written: :func:`parse_moments`.

Rows are grouped by their layout (the text with every digit replaced by 0), which is checked once per group by
one expression; the digits are then read column by column. ISO 8601 and what loggers make of it, and dates as
``31/12/2021`` where the column itself tells days from months.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from estimators.adapters.tracks.numbers import MISSING
from estimators.adapters.tracks.recording import Moments, Offsets
from estimators.arrays import BoolArray, InputError

_CLOCK = rb"(?P<hour>00):(?P<minute>00)(?::(?P<second>00)(?:[.,](?P<fraction>0{1,12}))?)?"
_ZONE = rb" ?(?:[Zz]|UTC|GMT|(?P<sign>[+-])(?P<off_hour>00)(?::?(?P<off_minute>00))?)"
_YEAR_FIRST = rb"(?P<year>0000)(?P<mark>[-/.])(?P<month>00)(?P=mark)(?P<day>00)"
_YEAR_LAST = rb"(?P<first>00)(?P<mark>[-/.])(?P<second_part>00)(?P=mark)(?P<year>0000)"
_LAYOUTS = tuple(
    re.compile(date + rb"(?:(?:[Tt]| +)" + _CLOCK + rb"(?:" + _ZONE + rb")?)?")
    for date in (_YEAR_FIRST, _YEAR_LAST)
)
_LONGEST = 48
_SLICE = 1 << 16
_ZERO, _NINE = ord("0"), ord("9")

Bytes = npt.NDArray[np.bytes_]
Digits = npt.NDArray[np.uint8]
Integers = npt.NDArray[np.int64]


def as_bytes(texts: Sequence[str | None]) -> Bytes:
    """Cells as fixed-width ASCII, a fifth of the memory of as many strings; empty where one is missing."""
    present = ["" if text is None else text.strip() for text in texts]
    if any(len(text) > _LONGEST for text in present):
        present = [text if len(text) <= _LONGEST else "?" for text in present]
    plain = [text.encode("ascii", "replace") for text in present]
    missing = {word.encode() for word in MISSING}
    # Bytes 0 at the end of a cell would vanish in a fixed-width column and make it look sound.
    return np.array(
        [b"" if word.lower() in missing else b"?" if b"\0" in word else word for word in plain], dtype="S"
    )


def parse_moments(texts: Sequence[str | None]) -> tuple[Moments, Offsets, BoolArray]:
    """Read points in time.

    Parameters
    ----------
    texts : sequence of str or None, length n
        ``2021-12-31T23:59:59.123+09:00``: blank or T, with or without clock, fraction and zone (none: UTC);
        also ``31/12/2021 23:59``, days or months first as the column tells.

    Returns
    -------
    moments : ndarray of datetime64[ns], shape (n,)
        In UTC; NaT where missing or unreadable.
    offsets : ndarray of int16, shape (n,)
        Minutes east of UTC in which each was written; 0 where no zone was written.
    unreadable : ndarray of bool, shape (n,)

    Raises
    ------
    InputError
        If days cannot be told from months.

    Examples
    --------
    >>> moments, offsets, _ = parse_moments(["2021-07-28T09:19:04+02:00", "31/07/2021 07:20"])
    >>> moments.astype("datetime64[s]"), offsets
    (array(['2021-07-28T07:19:04', '2021-07-31T07:20:00'],
          dtype='datetime64[s]'), array([120,   0], dtype=int16))
    """
    column = as_bytes(texts)
    return parse_pieces([column[start : start + _SLICE] for start in range(0, column.size, _SLICE)])


def parse_pieces(pieces: Sequence[Bytes]) -> tuple[Moments, Offsets, BoolArray]:
    """Read points in time of a column in pieces from :func:`as_bytes`, as :func:`parse_moments` does."""
    n = sum(piece.size for piece in pieces)
    moments = np.full(n, np.datetime64("NaT"), dtype="datetime64[ns]")
    offsets = np.zeros(n, dtype=np.int16)
    unreadable = np.zeros(n, dtype=np.bool_)
    day_first = _are_days_first(pieces)
    start = 0
    for piece in pieces:
        part = slice(start, start + piece.size)
        moments[part], offsets[part] = _parse_slice(piece, day_first)
        unreadable[part] = (piece != b"") & np.isnat(moments[part])
        start += piece.size
    return moments, offsets, unreadable


def _characters(column: Bytes) -> Digits:
    return np.ascontiguousarray(column).view(np.uint8).reshape(column.size, -1)


def _are_days_first(pieces: Sequence[Bytes]) -> bool:
    """Whether the first number of dates with the year last is the day: one of them above 12 decides."""
    largest = [0, 0]
    for piece in pieces:
        if piece.dtype.itemsize < 10:
            continue
        cells = _characters(piece)
        digit = (cells >= _ZERO) & (cells <= _NINE)
        shape = digit[:, [0, 1, 3, 4, 6, 7, 8, 9]].all(axis=1) & ~digit[:, 2] & ~digit[:, 5]
        for place, at in ((0, 0), (1, 3)):
            numbers = _number(cells[shape], at, at + 2)
            largest[place] = max(largest[place], int(numbers.max(initial=0)))
    if 0 < largest[0] <= 12 and largest[1] <= 12:
        raise InputError(
            "time", "days cannot be told from months in dates such as 03/04/2021; write 2021-04-03 (ISO 8601)"
        )
    return largest[0] > 12


def _parse_slice(column: Bytes, day_first: bool) -> tuple[Moments, Offsets]:
    cells = _characters(column)
    digit = (cells >= _ZERO) & (cells <= _NINE)
    layouts = np.where(digit, np.uint8(_ZERO), cells).view(column.dtype).ravel()
    moments = np.full(column.size, np.datetime64("NaT"), dtype="datetime64[ns]")
    offsets = np.zeros(column.size, dtype=np.int16)
    kinds, member = np.unique(layouts, return_inverse=True)
    for place, kind in enumerate(kinds):
        match = next((found for found in (layout.fullmatch(kind) for layout in _LAYOUTS) if found), None)
        if match is not None:
            rows = np.flatnonzero(member == place)
            moments[rows], offsets[rows] = _read_digits(cells[rows], match, day_first)
    return moments, offsets


def _number(cells: Digits, start: int, stop: int) -> Integers:
    value = np.zeros(len(cells), dtype=np.int64)
    for at in range(start, stop):
        value = 10 * value + (cells[:, at].astype(np.int64) - _ZERO)
    return value


def _read_digits(cells: Digits, match: re.Match[bytes], day_first: bool) -> tuple[Moments, Offsets]:
    groups = match.groupdict()

    def part(name: str) -> Integers:
        if groups.get(name) is None:
            return np.zeros(len(cells), dtype=np.int64)
        return _number(cells, *match.span(name))

    if "first" in groups:
        day, month = (part("first"), part("second_part"))
        if not day_first:
            day, month = month, day
    else:
        day, month = part("day"), part("month")
    year, hour, minute, second = part("year"), part("hour"), part("minute"), part("second")
    start, stop = match.span("fraction")
    nanoseconds = _number(cells, start, min(stop, start + 9)) * 10 ** max(0, 9 - (stop - start))
    offset = 60 * part("off_hour") + part("off_minute")
    if groups["sign"] is not None:
        offset = np.where(cells[:, match.start("sign")] == ord("-"), -offset, offset)
    # 64-bit nanoseconds reach from 1677-09-21 to 2262-04-11.
    sound = (year >= 1678) & (year <= 2261) & (month >= 1) & (month <= 12) & (day >= 1)
    sound &= (hour < 24) & (minute < 60) & (second <= 60) & (np.abs(offset) < 24 * 60)
    months = np.where(sound, (year - 1970) * 12 + month - 1, 0).astype("datetime64[M]")
    days = months.astype("datetime64[D]") + np.where(sound, day - 1, 0)
    sound &= days.astype("datetime64[M]") == months
    seconds = 3600 * hour + 60 * minute + second - 60 * offset
    moments = days.astype("datetime64[ns]") + (seconds * 1_000_000_000 + nanoseconds).astype(
        "timedelta64[ns]"
    )
    moments[~sound] = np.datetime64("NaT")
    return moments, np.where(sound, offset, 0).astype(np.int16)
