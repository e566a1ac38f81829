"""ISO 8601 text to datetime64[ns], many at a time.

Rows are grouped by their layout (the text with every digit replaced by 0), which is checked once per group
by one expression; the digits are then read column by column. Offsets are applied exactly; a time without
one is taken as UTC. NumPy's own parser ignores offsets with a warning, and pandas is not needed here.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from service.errors import Problem, invalid_value

LAYOUT = re.compile(
    rb"(?P<year>0000)-(?P<month>00)-(?P<day>00)"
    rb"(?:[Tt ](?P<hour>00):(?P<minute>00)(?::(?P<second>00)(?:[.,](?P<fraction>0{1,9}))?)?"
    rb"(?:[Zz]|[+-](?P<off_hour>00)(?::?(?P<off_minute>00))?)?)?"
)
LONGEST = 40
EXPLANATION = "is not a time; send ISO 8601 such as 2024-05-01T12:00:00Z (up to nanoseconds, offset optional)"

Digits = npt.NDArray[np.uint8]
Integers = npt.NDArray[np.int64]


def parse_iso(texts: Sequence[str | None], field: str) -> npt.NDArray[np.datetime64]:
    """Points in time, one per text.

    Parameters
    ----------
    texts : sequence of str or None, length n
        ``YYYY-MM-DD``, optionally with ``Thh:mm[:ss[.fraction]]`` and then ``Z`` or ``±hh[:mm]``;
        None is missing.
    field : str
        Name used in errors.

    Returns
    -------
    ndarray of datetime64[ns], shape (n,)
        NaT where missing.

    Raises
    ------
    Problem
        Naming the first row that is not a time between the years 1678 and 2261.

    Examples
    --------
    >>> parse_iso(["2024-05-01T14:00:00+02:00", None], "time")
    array(['2024-05-01T12:00:00.000000000', 'NaT'], dtype='datetime64[ns]')
    """
    moments = np.full(len(texts), np.datetime64("NaT"), dtype="datetime64[ns]")
    rows = [row for row, text in enumerate(texts) if text is not None]
    present = [text for text in texts if text is not None]
    if not present:
        return moments
    if max(map(len, present)) > LONGEST or not "".join(present).isascii():
        bad = next(k for k, text in enumerate(present) if len(text) > LONGEST or not text.isascii())
        raise invalid_value(field, EXPLANATION, rows[bad])
    characters = np.array(present, dtype=f"S{LONGEST}").view(np.uint8).reshape(len(present), LONGEST)
    digits = characters - np.uint8(ord("0"))
    layouts = np.where(digits <= 9, np.uint8(ord("0")), characters)
    index = np.asarray(rows, dtype=np.int64)
    nanoseconds = np.empty(len(present), dtype=np.int64)
    # A NUL at the end of a text would be lost in the padding, so the texts' own lengths are checked too.
    lengths = np.fromiter(map(len, present), dtype=np.int64, count=len(present))
    for layout, group in _groups(layouts):
        match = LAYOUT.fullmatch(layout)
        if match is None:
            raise invalid_value(field, EXPLANATION, int(index[group[0]]))
        wrong_length = lengths[group] != len(layout)
        if np.any(wrong_length):
            raise invalid_value(field, EXPLANATION, int(index[group[np.argmax(wrong_length)]]))
        nanoseconds[group] = _read(digits[group], characters[group], match, field, index[group])
    moments[index] = nanoseconds.astype("datetime64[ns]")
    return moments


def _groups(layouts: Digits) -> list[tuple[bytes, npt.NDArray[np.intp]]]:
    """Each layout with the positions of its texts; series are nearly always written in one layout."""
    if np.all(layouts == layouts[0]):
        return [(layouts[0].tobytes().rstrip(b"\0"), np.arange(len(layouts)))]
    keys = np.ascontiguousarray(layouts).view(f"S{layouts.shape[1]}").ravel()
    distinct, inverse = np.unique(keys, return_inverse=True)
    order = np.argsort(inverse, kind="stable")
    starts = np.searchsorted(inverse[order], np.arange(distinct.size))
    groups = zip(distinct.tolist(), np.split(order, starts[1:]), strict=True)
    return sorted(groups, key=lambda item: int(item[1][0]))


def _read(digits: Digits, characters: Digits, match: re.Match[bytes], field: str, rows: Integers) -> Integers:
    """Nanoseconds since 1970 of texts in one layout."""

    def number(name: str) -> Integers:
        start, stop = match.span(name)
        total = np.zeros(len(digits), dtype=np.int64)
        for place in range(start, stop):
            total = total * 10 + digits[:, place]
        return total

    year, month, day = number("year"), number("month"), number("day")
    hour, minute, second = number("hour"), number("minute"), number("second")
    off_hour, off_minute = number("off_hour"), number("off_minute")
    start, stop = match.span("fraction")
    fraction = number("fraction") * 10 ** (9 - (stop - start))
    problems = (
        ((year < 1678) | (year > 2261), "lies outside of the years 1678 to 2261"),
        ((month < 1) | (month > 12), "has no such month"),
        ((day < 1) | (day > _days_in_month(year, month)), "has no such day in its month"),
        ((hour > 23) | (minute > 59), "has no such time of day"),
        (second > 59, "has no such second; leap seconds are not taken"),
        ((off_hour > 23) | (off_minute > 59), "has no such offset"),
    )
    for bad, message in problems:
        if np.any(bad):
            raise _at(rows, bad, field, message)
    offset = off_hour * 3600 + off_minute * 60
    sign_at = match.start("off_hour") - 1
    if sign_at >= 0:
        offset = np.where(characters[:, sign_at] == ord("-"), -offset, offset)
    seconds = _days_since_1970(year, month, day) * 86_400 + hour * 3600 + minute * 60 + second - offset
    return np.asarray(seconds * 10**9 + fraction, dtype=np.int64)


def _at(rows: Integers, bad: npt.NDArray[np.bool_], field: str, message: str) -> Problem:
    return invalid_value(field, message, int(rows[np.argmax(bad)]))


def _days_in_month(year: Integers, month: Integers) -> Integers:
    usual = np.array([0, 31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31])[np.clip(month, 0, 12)]
    leap = (year % 4 == 0) & ((year % 100 != 0) | (year % 400 == 0))
    return np.asarray(usual + (leap & (month == 2)), dtype=np.int64)


def _days_since_1970(year: Integers, month: Integers, day: Integers) -> Integers:
    months = ((year - 1970) * 12 + month - 1).astype("datetime64[M]")
    return np.asarray(months.astype("datetime64[D]").astype(np.int64) + day - 1, dtype=np.int64)
