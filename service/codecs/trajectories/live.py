"""JSON of live tracks: the rows of a call in, settled and provisional rows out."""

from __future__ import annotations

import math
import re
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from estimators.adapters.tracks.recording import Offsets
from estimators.adapters.tracks.written_columns import zoned_texts
from service.codecs.arguments import refuse_absent, validated
from service.codecs.columns import UNIT_NANOSECONDS, TimeForm, Times
from service.codecs.json import dumps, is_null, read_argument, read_numbers, read_object
from service.codecs.sent import Sent
from service.codecs.trajectories.clock import read_clock, read_clock_on
from service.codecs.trajectories.columns import REQUIRED, check_lengths
from service.errors import invalid_value, unknown_fields
from service.schemas.fields import TimeUnit
from service.schemas.live_tracks import LiveArguments, LiveQuery
from service.trajectories.live import LiveCleaned, LiveFixes
from service.trajectories.live_state import LiveState, read_state

MEASURED = {"height": "height_m", "accuracy": "accuracy_m"}
COLUMNS = (*REQUIRED, *MEASURED)
FIELDS = (*COLUMNS, *LiveArguments.model_fields)

_ZEROS = re.compile(r"\.0{9}$|0{6}$|0{3}$")
_CLOCK_LETTERS = len("2024-05-01T12:00:00.000000000")

Moments = npt.NDArray[np.datetime64]


def read_live_rows(sent: Sent[LiveQuery]) -> tuple[LiveFixes, LiveArguments]:
    """Rows, state and arguments of a JSON body.

    Raises
    ------
    Problem
        If the body is not JSON, holds unknown or repeated keys, or a value of the wrong type.
    """
    fields = _fields(sent.content)
    arguments = validated(
        LiveArguments, {name: read_argument(raw, name) for name, raw in fields.items() if name not in COLUMNS}
    )
    state = LiveState() if arguments.state is None else read_state(arguments.state)
    absent = [name for name in REQUIRED if is_null(fields.get(name))]
    if len(absent) < len(REQUIRED):
        refuse_absent(absent)
    columns = {name: msgspec.Raw(b"[]") for name in REQUIRED}
    columns |= {name: raw for name, raw in fields.items() if name in COLUMNS and not is_null(raw)}
    time, form, offsets = _clock(columns["time"], arguments.time_unit, state)
    sent.limits.check_points(time.size)
    if time.size == 0 and not (arguments.finish and state.track is not None):
        raise invalid_value("time", "is empty; send at least one fix, or finish a track with its state")
    numbers = {name: read_numbers(raw, name) for name, raw in columns.items() if name != "time"}
    check_lengths(time.size, {name: column.size for name, column in numbers.items()})
    return LiveFixes(
        LiveState(state.track, form, state.waiting),
        time,
        numbers["lat"],
        numbers["lon"],
        np.zeros(time.size, dtype=np.int16) if offsets is None else offsets,
        {column: numbers[name] for name, column in MEASURED.items() if name in numbers},
    ), arguments


def write_live_rows(cleaned: LiveCleaned) -> bytes:
    """Write an answer; a row is written the same whatever rows stand beside it."""
    answer = cleaned.answer
    told = answer.to_dict()
    told["settled"]["time"] = _written(answer.settled.time, cleaned.form, cleaned.settled_offsets)
    told["provisional"]["time"] = _written(answer.provisional.time, cleaned.form, cleaned.provisional_offsets)
    return dumps(told)


def _fields(content: bytes) -> dict[str, msgspec.Raw]:
    """Texts of the body's values by key; a column of devices is refused in words of its own."""
    fields = read_object(content, None, "")
    if "device" in fields:
        raise invalid_value(
            "device",
            "a live track is of one receiver; send the rows of each in calls of their own, with its state",
        )
    unknown = [name for name in fields if name not in FIELDS]
    if unknown:
        raise unknown_fields(unknown, FIELDS, "this request")
    return fields


def _clock(
    raw: msgspec.Raw, unit: TimeUnit | None, state: LiveState
) -> tuple[Times, TimeForm | None, Offsets | None]:
    """Read times in the form of the track; the first row with a time decides it."""
    if state.form is not None:
        return read_clock_on(raw, unit, state.form)
    time, form, offsets = read_clock(raw, unit)
    return time, None if np.isnan(time).all() else form, offsets


def _written(times: npt.NDArray[Any], form: TimeForm | None, offsets: Offsets) -> list[Any]:
    if form is None or form.kind == "number":
        return [None if math.isnan(time) else time for time in times.tolist()]
    if form.kind == "epoch":
        return _numbers(times, UNIT_NANOSECONDS[form.unit or "s"])
    return [
        None if text is None else _ZEROS.sub("", text[:_CLOCK_LETTERS]) + text[_CLOCK_LETTERS:]
        for text in zoned_texts(times, offsets, "ns")
    ]


def _numbers(moments: Moments, factor: int) -> list[int | float | None]:
    """Numbers since 1970, each an integer if it is whole."""
    whole, rest = np.divmod(moments.astype(np.int64), factor)
    return [
        None if missing else number if part == 0 else number + part / factor
        for missing, number, part in zip(
            np.isnat(moments).tolist(), whole.tolist(), rest.tolist(), strict=True
        )
    ]
