"""What every body becomes: :class:`Recorded`, a recording with the form its times came in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from estimators.adapters.tracks.recording import Recording
from estimators.adapters.tracks.written_columns import clock_texts, clock_unit
from service.codecs.columns import TimeForm, Times, WireTimes
from service.errors import invalid_value

#: Formats that are tables, in which a column may say whose fix each row is.
TABLES = ("csv", "parquet", "arrow")


@dataclass(frozen=True, slots=True)
class Recorded:
    """Fixes that were read.

    Attributes
    ----------
    recording : Recording
    time : ndarray, shape (n,)
        As the library takes it and answers write it: plain numbers, or datetime64[ns].
    form : TimeForm
        How the times were written.
    is_many : bool
        Whether a track for each device is asked for.
    """

    recording: Recording
    time: Times
    form: TimeForm
    is_many: bool

    def written_times(self) -> WireTimes:
        """Write the times as the caller writes them; points in time in the zone in which each came."""
        if self.form.kind == "iso":
            return clock_texts(self.recording, slice(None), clock_unit(self.recording))
        return self.form.render(self.time)

    def as_written(self) -> Recording:
        """Give the recording with times since 1970 as the numbers that they were."""
        if self.form.kind != "epoch":
            return self.recording
        numbers = np.asarray(self.form.render(self.time))
        plain = numbers if numbers.dtype.kind in "iu" else numbers.astype(np.float64)
        return replace(self.recording, time=plain, utc_offset_minutes=None)


def of_file(recording: Recording, time_unit: Any = None) -> Recorded:
    """Of one file: tables say by a column whose fixes they are, other formats may hold several tracks.

    Parameters
    ----------
    recording : Recording
    time_unit : {"s", "ms", "us", "ns"}, optional
        Of times that are numbers, as the caller says.
    """
    is_many = bool(recording.devices) if recording.form in TABLES else len(recording.devices) > 1
    return Recorded(recording, recording.time, _form_of(recording, time_unit), is_many)


def of_files(recordings: Sequence[Recording], names: Sequence[str], time_unit: Any = None) -> Recorded:
    """Of several files: tracks are named after their files, and after their devices where a file has more.

    Parameters
    ----------
    recordings : sequence of Recording
    names : sequence of str
        Of the files; empty where one has none.
    time_unit : {"s", "ms", "us", "ns"}, optional

    Raises
    ------
    Problem
        If some files have points in time and some plain numbers.
    """
    if len(recordings) == 1:
        return of_file(recordings[0], time_unit)
    if len({recording.time.dtype.kind for recording in recordings}) > 1:
        raise invalid_value(
            "time", "some files have points in time and others plain numbers; send them apart"
        )
    joined = _join(recordings, _distinct(names))
    return Recorded(joined, joined.time, _form_of(joined, time_unit), is_many=True)


def _form_of(recording: Recording, time_unit: Any) -> TimeForm:
    if recording.time.dtype.kind != "M":
        return TimeForm("number")
    return TimeForm("iso") if time_unit is None else TimeForm("epoch", time_unit)


def _distinct(names: Sequence[str]) -> list[str]:
    """Names of files, those that have none or another's told by their number."""
    return [
        name if name and names.count(name) == 1 else f"{name or 'file'} ({place + 1})"
        for place, name in enumerate(names)
    ]


def _join(recordings: Sequence[Recording], names: Sequence[str]) -> Recording:
    """Rows of several recordings one after the other, each device with a name of its own."""
    devices: list[str] = []
    device, segment = [], []
    pieces = 0
    for recording, name in zip(recordings, names, strict=True):
        one = np.zeros(len(recording), dtype=np.int64)
        device.append(len(devices) + (one if recording.device is None else recording.device))
        segment.append(pieces + (one if recording.segment is None else recording.segment))
        pieces = int(segment[-1].max()) + 1
        several = recording.device is not None
        devices += [f"{name}: {own}" for own in recording.devices] if several else [name]
    joined: dict[str, Any] = {
        field.name: _stacked(recordings, field.name)
        for field in fields(Recording)
        if field.name not in ("form", "device", "devices", "segment", "left_out")
    }
    return Recording(
        "files",
        **joined,
        device=np.concatenate(device),
        devices=tuple(devices),
        segment=np.concatenate(segment) if any(item.segment is not None for item in recordings) else None,
        left_out=sum(recording.left_out for recording in recordings),
    )


def _stacked(recordings: Sequence[Recording], name: str) -> Any:
    """Column of all recordings, or None if none has it; those that lack it have NaN, or UTC."""
    columns = [getattr(recording, name) for recording in recordings]
    present = next((column for column in columns if column is not None), None)
    if present is None:
        return None
    blank = np.nan if present.dtype.kind == "f" else 0
    return np.concatenate(
        [
            np.full(len(recording), blank, dtype=present.dtype) if column is None else column
            for recording, column in zip(recordings, columns, strict=True)
        ]
    )
