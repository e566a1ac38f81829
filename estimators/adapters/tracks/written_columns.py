"""A recording and what a cleaner said of it as columns of text: :func:`written_columns`, for all writers.

Text is made for a piece of the rows at a time, so that ten million rows need not stand in memory as text.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from estimators.adapters.tracks.assembly import RANGES
from estimators.adapters.tracks.cleaned import Cleaned
from estimators.adapters.tracks.recording import Moments, Offsets, Recording
from estimators.adapters.tracks.times import NANOSECONDS, TimeUnit
from estimators.arrays import BoolArray, FloatArray, InputError, IntArray

PIECE_ROWS = 1 << 13
_AT_ONCE = 1 << 16
_FEWEST_DIGITS, _MOST_DIGITS = 7, 10
"""Seven digits of a degree are 11 mm, ten 11 micrometres."""
_ROUNDING_DEG = 6e-14
"""Two units in the last place of a float64 near 180."""

Texts = list[str | None]
Rows = slice | IntArray
"""Rows of which text is made: a piece of the table, or some of it in another order."""


@dataclass(frozen=True, slots=True)
class Column:
    """A column of what is written.

    Parameters
    ----------
    name : str
    kind : {"number", "text", "flag"}
    text : function of rows
        Texts of these rows; None where there is no value.
    """

    name: str
    kind: Literal["number", "text", "flag"]
    text: Callable[[Rows], Texts]


@dataclass(frozen=True, slots=True)
class Layout:
    """What has to be known of a whole recording to write a part of it.

    Parameters
    ----------
    digits : int
        Of degrees, after the point.
    unit : {"s", "ms", "us", "ns"}
        The coarsest in which no point in time is rounded.
    zone_minutes : int or None
        East of UTC, of the zone that all times share; None where they differ.
    epoch : {"s", "ms", "us", "ns"}, optional
        Points in time are written as numbers of these since 1970, where the format takes numbers. Default: as
        points in time.
    method : str
        By which the track was cleaned, for formats that have a place for it; empty: not said.
    """

    digits: int
    unit: TimeUnit
    zone_minutes: int | None = 0
    epoch: TimeUnit | None = None
    method: str = ""

    @property
    def counts_whole(self) -> bool:
        """Whether numbers since 1970 are integers."""
        return self.epoch is not None and NANOSECONDS[self.epoch] <= NANOSECONDS[self.unit]


def layout_of(recording: Recording, *, epoch: TimeUnit | None = None, method: str = "") -> Layout:
    """Layout with which nothing of a recording is lost; ``epoch`` and ``method`` as in :class:`Layout`."""
    offsets = recording.utc_offset_minutes
    zone: int | None = 0
    if offsets is not None:
        zone = int(offsets[0]) if bool(np.all(offsets == offsets[0])) else None
    return Layout(position_digits(recording), clock_unit(recording), zone, epoch, method)


def written_columns(
    recording: Recording, cleaned: Cleaned | None, layout: Layout | None = None
) -> dict[str, Column]:
    """Columns by name, in the order in which they are written.

    Parameters
    ----------
    recording : Recording
    cleaned : Cleaned, optional
        Its positions then are ``lat`` and ``lon``, and the recorded ones ``raw_lat`` and ``raw_lon``.
    layout : Layout, optional
        That of the whole, if the recording is part of a longer one. Default: its own.

    Raises
    ------
    InputError
        If the two differ in length.
    """
    if cleaned is not None and len(cleaned.lat) != len(recording):
        raise InputError("cleaned", f"has {len(cleaned.lat)} rows where the recording has {len(recording)}")
    layout = layout or layout_of(recording)
    columns: dict[str, Column] = {"time": _time(recording, layout)}
    if recording.devices:
        columns["device"] = Column("device", "text", lambda part: _devices(recording, part))
    if recording.segment is not None:
        columns["segment"] = _number("segment", recording.segment, str)
    digits = layout.digits
    lat, lon, height = positions(recording, cleaned)
    columns |= {name: _fixed(name, values, digits) for name, values in (("lat", lat), ("lon", lon))}
    if height is not None:
        columns["height_m"] = _number("height_m", height, _metres)
    if cleaned is not None:
        columns["raw_lat"] = _fixed("raw_lat", recording.lat, digits)
        columns["raw_lon"] = _fixed("raw_lon", recording.lon, digits)
        if recording.height_m is not None and cleaned.height_m is not None:
            columns["raw_height_m"] = _number("raw_height_m", recording.height_m, _metres)
    for name in RANGES:
        values = getattr(recording, name)
        if name != "height_m" and values is not None:
            columns[name] = _number(name, values, _shortest)
    if cleaned is not None:
        columns |= _labels(cleaned)
    return columns


def positions(
    recording: Recording, cleaned: Cleaned | None
) -> tuple[FloatArray, FloatArray, FloatArray | None]:
    """Latitude, longitude and height that are written: the cleaned ones where there are any."""
    if cleaned is None:
        return recording.lat, recording.lon, recording.height_m
    height = recording.height_m if cleaned.height_m is None else cleaned.height_m
    return cleaned.lat, cleaned.lon, height


def position_digits(recording: Recording) -> int:
    """Digits after the point with which the recorded degrees can be written as they came, 7 to 10.

    Examples
    --------
    >>> import numpy as np
    >>> lat, lon = np.array([45.484591697]), np.array([13.50758978])
    >>> position_digits(Recording("gpx", np.zeros(1), lat, lon, np.zeros(1, dtype=np.uint8)))
    9
    """
    digits = _FEWEST_DIGITS
    for column in (recording.lat, recording.lon):
        for first in range(0, len(recording), _AT_ONCE):
            known = column[first : first + _AT_ONCE]
            known = known[~np.isnan(known)]
            while digits < _MOST_DIGITS and (np.abs(np.round(known, digits) - known) > _ROUNDING_DEG).any():
                digits += 1
    return digits


def _labels(cleaned: Cleaned) -> dict[str, Column]:
    columns: dict[str, Column] = {}
    if cleaned.inlier is not None:
        inlier: BoolArray = cleaned.inlier
        columns["inlier"] = Column(
            "inlier", "flag", lambda part: ["true" if good else "false" for good in inlier[part]]
        )
    if cleaned.probability is not None:
        columns["probability"] = _number("probability", cleaned.probability, _six)
    if cleaned.reason is not None:
        reason = np.array(cleaned.reason, dtype=object)
        columns["reason"] = Column("reason", "text", lambda part: [str(word) for word in reason[part]])
    for name, values in cleaned.others.items():
        columns[name] = _number(name, values, _six)
    return columns


def _number(name: str, values: FloatArray | np.ndarray, text: Callable[[float], str]) -> Column:
    return Column(
        name,
        "number",
        lambda part: [text(value) if value - value == 0 else None for value in values[part].tolist()],
    )


def _fixed(name: str, values: FloatArray, digits: int) -> Column:
    return _number(name, values, lambda value: f"{value:.{digits}f}")


def _metres(value: float) -> str:
    return f"{value:.3f}".rstrip("0").rstrip(".")


def _six(value: float) -> str:
    return f"{value:.6g}"


def _shortest(value: float) -> str:
    return repr(value).removesuffix(".0")


def _devices(recording: Recording, part: Rows) -> Texts:
    if recording.device is None:
        return [recording.devices[0]] * len(recording.time[part])
    return [recording.devices[place] for place in recording.device[part].tolist()]


def _time(recording: Recording, layout: Layout) -> Column:
    if recording.time.dtype.kind != "M":
        return _number("time", recording.time, _shortest)
    if layout.epoch is not None:
        return Column("time", "number", lambda part: _epoch_texts(recording, part, layout))
    return Column("time", "text", lambda part: clock_texts(recording, part, layout.unit))


def epoch_numbers(moments: Moments, layout: Layout) -> tuple[FloatArray | IntArray, BoolArray]:
    """Numbers since 1970 in the unit of a layout, integers if all of the whole are, and where there is none.

    Examples
    --------
    >>> moments = np.array(["1970-01-01T00:00:02.500", "NaT"], dtype="datetime64[ns]")
    >>> epoch_numbers(moments, Layout(7, "ms", epoch="s"))[0].tolist()[0]
    2.5
    """
    missing = np.isnat(moments)
    step = NANOSECONDS[layout.epoch or "s"]
    quotient, rest = np.divmod(moments.astype(np.int64), step)
    return quotient if layout.counts_whole else quotient + rest / step, missing


def _epoch_texts(recording: Recording, part: Rows, layout: Layout) -> Texts:
    numbers, missing = epoch_numbers(recording.time[part].astype("datetime64[ns]"), layout)
    return [
        None if gone else _shortest(number)
        for number, gone in zip(numbers.tolist(), missing.tolist(), strict=True)
    ]


def clock_unit(recording: Recording) -> TimeUnit:
    """Coarsest unit in which no time of the recording is rounded."""
    if recording.time.dtype.kind != "M":
        return "s"
    steps = list(NANOSECONDS.items())
    place = 0
    for first in range(0, len(recording), _AT_ONCE):
        moments = recording.time[first : first + _AT_ONCE]
        counts = moments[~np.isnat(moments)].astype("datetime64[ns]").astype(np.int64)
        while (counts % steps[place][1]).any():
            place += 1
    return steps[place][0]


def clock_texts(recording: Recording, part: Rows, unit: TimeUnit) -> Texts:
    """ISO 8601 in the zone in which each time came; Z where that is UTC or was not said."""
    time: Moments = recording.time[part].astype("datetime64[ns]")
    offsets = recording.utc_offset_minutes
    return zoned_texts(time, None if offsets is None else offsets[part], unit)


def zoned_texts(time: Moments, offsets: Offsets | None, unit: Literal["s", "ms", "us", "ns"]) -> Texts:
    """ISO 8601 of moments, each with its minutes east of UTC; None: all of them in UTC."""
    if offsets is None:
        return [
            None if text == "NaT" else f"{text}Z" for text in np.datetime_as_string(time, unit=unit).tolist()
        ]
    minutes = offsets.astype(np.int64)
    local = np.datetime_as_string(time + minutes.astype("timedelta64[m]"), unit=unit).tolist()
    zones = {value: zone_text(value) for value in set(minutes.tolist())}
    return [
        None if text == "NaT" else text + zones[offset]
        for text, offset in zip(local, minutes.tolist(), strict=True)
    ]


def zone_text(minutes: int) -> str:
    """Zone as ISO 8601 writes it, from minutes east of UTC."""
    if minutes == 0:
        return "Z"
    return f"{'-' if minutes < 0 else '+'}{abs(minutes) // 60:02d}:{abs(minutes) % 60:02d}"
