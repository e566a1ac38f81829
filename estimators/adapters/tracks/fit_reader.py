"""FIT activity files to a :class:`Recording`, without a library: records, pauses, the zone of the watch.

Structure and numbers are those of Garmin's "FIT Protocol" and of its profile: definition messages tell the
layout of the data messages that follow; message 20 (record) holds a fix, 21 (event) starts and stops the
timer, 34 (activity) tells local time. Whatever else stands in a file, developer fields included, is stepped
over by its size.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import IO

import numpy as np

from estimators.adapters.tracks.assembly import assemble
from estimators.adapters.tracks.recording import FIELD, Recording
from estimators.arrays import InputError

SIGNATURE = b".FIT"
_EPOCH = np.datetime64("1989-12-31T00:00:00", "ns")
_DEGREES = 180.0 / 2**31
_TIMESTAMP, _RECORD, _EVENT, _ACTIVITY = 253, 20, 21, 34

_BASE_TYPES: dict[int, tuple[str, int]] = {
    0x00: ("B", 0xFF),
    0x01: ("b", 0x7F),
    0x02: ("B", 0xFF),
    0x83: ("h", 0x7FFF),
    0x84: ("H", 0xFFFF),
    0x85: ("i", 0x7FFFFFFF),
    0x86: ("I", 0xFFFFFFFF),
    0x0A: ("B", 0x00),
    0x8B: ("H", 0x0000),
    0x8C: ("I", 0x00000000),
}
"""Integer types by their code: format of ``struct`` and the value that means "none"."""

_FIELDS: dict[int, dict[int, str]] = {
    _RECORD: {
        _TIMESTAMP: "time",
        0: "lat",
        1: "lon",
        2: "alt",
        78: "alt+",
        6: "speed",
        73: "speed+",
        31: "acc",
    },
    _EVENT: {0: "event", 1: "kind"},
    _ACTIVITY: {_TIMESTAMP: "time", 5: "local"},
}
"""Fields that are read of each message. The second altitude and speed are the wider ("enhanced") ones."""

_TIMER, _STOPPED = 0, frozenset({1, 4})
_CRC = (
    *(0x0000, 0xCC01, 0xD801, 0x1400, 0xF001, 0x3C00, 0x2800, 0xE401),
    *(0xA001, 0x6C00, 0x7800, 0xB401, 0x5000, 0x9C01, 0x8801, 0x4400),
)
"""CRC of four bits, from the protocol's own text; applied to a byte's lower half and then to its upper."""


@dataclass(frozen=True, slots=True)
class _Layout:
    message: int
    size: int
    read: struct.Struct
    names: tuple[str, ...]
    none: tuple[int, ...]


class _Fixes:
    """Columns that grow record by record."""

    def __init__(self) -> None:
        self.rows: list[dict[str, int]] = []
        self.offset: list[int] = []
        self.segment: list[int] = []
        self.pieces = 0


def read_fit(stream: IO[bytes]) -> Recording:
    """Read one FIT file, or several that are chained.

    Raises
    ------
    InputError
        If the file is damaged (its checksum is verified), or holds no records.
    """
    body = stream.read()
    fixes = _Fixes()
    start = 0
    while start < len(body):
        start = _read_file(body, start, fixes)
        fixes.pieces += 1
    if not fixes.rows:
        raise InputError(FIELD, "is a FIT file without records; export an activity, not a course or settings")
    seconds = _column(fixes, "time")
    known = ~np.isnan(seconds)
    time = np.full(seconds.size, np.datetime64("NaT"), dtype="datetime64[ns]")
    time[known] = _EPOCH + seconds[known].astype(np.int64) * np.timedelta64(1_000_000_000, "ns")
    height, fine_height = (_column(fixes, name) / 5.0 - 500.0 for name in ("alt", "alt+"))
    speed, fine_speed = (_column(fixes, name) / 1000.0 for name in ("speed", "speed+"))
    return assemble(
        "fit",
        time=time,
        lat=_column(fixes, "lat") * _DEGREES,
        lon=_column(fixes, "lon") * _DEGREES,
        offsets=np.array(fixes.offset, dtype=np.int16),
        measured={
            "height_m": np.where(np.isnan(fine_height), height, fine_height),
            "speed_mps": np.where(np.isnan(fine_speed), speed, fine_speed),
            "accuracy_m": _column(fixes, "acc"),
        },
        segment=np.unique(np.array(fixes.segment, dtype=np.int64), return_inverse=True)[1],
    )


def _column(fixes: _Fixes, name: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.array([row.get(name, np.nan) for row in fixes.rows], dtype=np.float64)


def _read_file(body: bytes, start: int, fixes: _Fixes) -> int:
    """Read the file that begins at ``start``; return where it ends."""
    header = body[start] if start < len(body) else 0
    if header < 12 or body[start + 8 : start + 12] != SIGNATURE:
        raise InputError(FIELD, "goes on after the end of its FIT data; cut it there, or send it again")
    size = int.from_bytes(body[start + 4 : start + 8], "little")
    stop = start + header + size
    if stop + 2 > len(body):
        raise InputError(FIELD, "is a FIT file that ends too early; send it again")
    if _crc(body[start : stop + 2]) != 0:
        raise InputError(FIELD, "is a damaged FIT file: its checksum is wrong; send it again")
    first = len(fixes.rows)
    try:
        minutes = _read_messages(body, start + header, stop, fixes)
    except (struct.error, IndexError, KeyError) as error:
        raise InputError(FIELD, "is a damaged FIT file: a message does not fit its layout") from error
    fixes.offset += [minutes] * (len(fixes.rows) - first)
    return stop + 2


def _crc(content: bytes) -> int:
    table = [_crc_of_byte(byte) for byte in range(256)]
    crc = 0
    for byte in content:
        crc = (crc >> 8) ^ table[(crc ^ byte) & 0xFF]
    return crc


def _crc_of_byte(byte: int) -> int:
    crc = 0
    for half in (byte & 0xF, byte >> 4):
        crc = (crc >> 4) ^ _CRC[crc & 0xF] ^ _CRC[half]
    return crc


def _read_messages(body: bytes, at: int, stop: int, fixes: _Fixes) -> int:
    """Add the records of one file; return the minutes by which its local time is ahead of UTC."""
    layouts: dict[int, _Layout] = {}
    clock: int | None = None
    minutes, paused = 0, False
    while at < stop:
        header = body[at]
        if not header & 0x80 and header & 0x40:
            layouts[header & 0x0F], at = _read_definition(body, at, developer=bool(header & 0x20))
            continue
        layout = layouts[(header >> 5) & 0x03 if header & 0x80 else header & 0x0F]
        values = layout.read.unpack_from(body, at + 1)
        at += 1 + layout.size
        if at > stop:
            raise IndexError("a message reaches beyond the end")
        found = {
            name: value
            for name, value, none in zip(layout.names, values, layout.none, strict=True)
            if value != none
        }
        if header & 0x80 and clock is not None:
            # Five bits of seconds after the last full time (protocol, "compressed timestamp header").
            clock += ((header & 0x1F) - clock) & 0x1F
            found["time"] = clock
        clock = found.get("time", clock)
        if layout.message == _RECORD:
            fixes.pieces += paused
            paused = False
            fixes.rows.append(found)
            fixes.segment.append(fixes.pieces)
        elif layout.message == _EVENT:
            paused |= found.get("event") == _TIMER and found.get("kind") in _STOPPED
        elif layout.message == _ACTIVITY and {"time", "local"} <= found.keys():
            minutes = _zone(found["local"] - found["time"])
    return minutes


def _zone(ahead_s: int) -> int:
    """Zones are whole quarters of an hour between -12:00 and +14:00; a clock set by hand tells nothing."""
    quarters = round(ahead_s / 900)
    return 15 * quarters if abs(ahead_s - 900 * quarters) <= 60 and -48 <= quarters <= 56 else 0


def _read_definition(body: bytes, at: int, *, developer: bool) -> tuple[_Layout, int]:
    order = ">" if body[at + 2] else "<"
    (message,) = struct.unpack_from(order + "H", body, at + 3)
    count = body[at + 5]
    wanted = _FIELDS.get(message, {})
    layout, names, none = [order], [], []
    at += 6
    for _ in range(count):
        number, size, base = body[at], body[at + 1], body[at + 2]
        form, invalid = _BASE_TYPES.get(base, ("x", 0))
        if number in wanted and form != "x" and struct.calcsize("<" + form) == size:
            layout.append(form)
            names.append(wanted[number])
            none.append(invalid)
        else:
            layout.append(f"{size}x")
        at += 3
    if developer:
        for place in range(body[at]):
            layout.append(f"{body[at + 2 + 3 * place]}x")
        at += 1 + 3 * body[at]
    read = struct.Struct("".join(layout))
    return _Layout(message, read.size, read, tuple(names), tuple(none)), at
