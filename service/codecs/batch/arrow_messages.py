"""How much an Arrow IPC message holds, from its metadata and without unpacking it.

An IPC message is a flatbuffer (Arrow columnar format, "Encapsulated message format"; ``Message.fbs``) and a
body of buffers. Where buffers are compressed each begins with its unpacked length, and a reader allocates
what stands there; this module adds those lengths up first.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any

from service.errors import Problem, ProblemType

_DICTIONARY, _RECORDS = 2, 3


@dataclass(frozen=True, slots=True)
class MessageSizes:
    """What a message unpacks to; ``rows`` are those of the table, 0 for schemas and dictionaries."""

    rows: int
    bytes: int


class _Table:
    """A table of a flatbuffer: fields are found through its vtable."""

    def __init__(self, buffer: memoryview, place: int) -> None:
        self._buffer = buffer
        self._place = place
        self._vtable = place - _read("<i", buffer, place)
        self._fields = (_read("<H", buffer, self._vtable) - 4) // 2

    def place(self, field: int) -> int | None:
        """Where a field stands, or None where it has its default."""
        if field >= self._fields:
            return None
        offset = _read("<H", self._buffer, self._vtable + 4 + 2 * field)
        return self._place + offset if offset else None

    def number(self, field: int, layout: str) -> int:
        """Return a number, 0 by default."""
        place = self.place(field)
        return 0 if place is None else _read(layout, self._buffer, place)

    def table(self, field: int) -> _Table | None:
        """Return a table, or None where there is none."""
        place = self.place(field)
        return None if place is None else _Table(self._buffer, place + _read("<I", self._buffer, place))

    def buffers(self, field: int) -> list[tuple[int, int]]:
        """Return a vector of pairs (offset, length) of 64 bits each."""
        place = self.place(field)
        if place is None:
            return []
        start = place + _read("<I", self._buffer, place)
        count = _read("<I", self._buffer, start)
        if start + 4 + 16 * count > len(self._buffer):
            raise _broken()
        pairs = struct.iter_unpack("<qq", self._buffer[start + 4 : start + 4 + 16 * count])
        return list(pairs)


def sizes_of(message: Any) -> MessageSizes:
    """Rows and unpacked bytes of a message.

    Parameters
    ----------
    message : pyarrow.ipc.Message

    Raises
    ------
    Problem
        400 if the metadata contradict themselves.
    """
    metadata = memoryview(message.metadata)
    root = _Table(metadata, _read("<I", metadata, 0))
    kind = root.number(1, "<B")
    header = root.table(2)
    body = memoryview(b"" if message.body is None else message.body)
    if header is None or kind not in (_DICTIONARY, _RECORDS):
        return MessageSizes(0, body.nbytes)
    records = header.table(1) if kind == _DICTIONARY else header
    if records is None:
        raise _broken()
    rows = records.number(0, "<q")
    if rows < 0:
        raise _broken()
    unpacked = body.nbytes
    if records.table(3) is not None:
        unpacked = sum(_unpacked(body, offset, length) for offset, length in records.buffers(2))
    return MessageSizes(rows if kind == _RECORDS else 0, unpacked)


def _unpacked(body: memoryview, offset: int, length: int) -> int:
    """Length of a compressed buffer once unpacked; -1 before its bytes says that it is not compressed."""
    if length == 0:
        return 0
    if offset < 0 or length < 8 or offset + length > body.nbytes:
        raise _broken()
    told = _read("<q", body, offset)
    if told < -1:
        raise _broken()
    return length if told == -1 else told


def _read(layout: str, buffer: memoryview, place: int) -> int:
    if place < 0:
        raise _broken()
    try:
        number: int = struct.unpack_from(layout, buffer, place)[0]
    except struct.error:
        raise _broken() from None
    return number


def _broken() -> Problem:
    return Problem(ProblemType.malformed_body, "the Arrow data are broken: a message contradicts itself")
