"""How much the pages of a Parquet column unpack to, from their headers and without unpacking them.

The footer of a file may say anything; what a reader allocates stands in the header of each page (Parquet
format, ``parquet.thrift``: ``PageHeader``, in Thrift's compact protocol). This module walks those headers.
It also refuses the one encoding by which few bytes become very many texts: in ``DELTA_BYTE_ARRAY`` each text
is a prefix of the one before it and a rest.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from service.errors import Problem, ProblemType

DELTA_BYTE_ARRAY = 7

_DEEPEST = 8
_STOP, _TRUE, _FALSE, _BYTE, _I16, _I32, _I64, _DOUBLE, _BINARY, _LIST, _SET, _MAP, _STRUCT = range(13)

#: Field numbers of ``PageHeader`` and of the data page headers, versions 1 and 2, in it.
_UNPACKED_SIZE, _PACKED_SIZE, _DATA_PAGE, _DATA_PAGE_2 = 2, 3, 5, 8
_ENCODING = {_DATA_PAGE: 2, _DATA_PAGE_2: 4}

#: A value that was read: numbers and structs are kept, the rest is skipped.
_Value = int | dict[int, "_Value"] | None


@dataclass(frozen=True, slots=True)
class Page:
    """What a page's header says.

    Attributes
    ----------
    bytes : int
        Size once unpacked.
    encoding : int or None
        Of a data page's values, as ``parquet.thrift`` numbers them.
    """

    bytes: int
    encoding: int | None


def pages_of(chunk: bytes) -> Iterator[Page]:
    """Headers of a column chunk's pages, one after the other.

    Parameters
    ----------
    chunk : bytes
        The chunk as it stands in the file, from its first page on.

    Raises
    ------
    Problem
        400 if they are no page headers.
    """
    place = 0
    while place < len(chunk):
        try:
            header, place = _struct(chunk, place, 0)
        except IndexError:
            raise _broken() from None
        unpacked, packed = header.get(_UNPACKED_SIZE), header.get(_PACKED_SIZE)
        if not isinstance(unpacked, int) or not isinstance(packed, int) or unpacked < 0 or packed < 0:
            raise _broken()
        place += packed
        if place > len(chunk):
            raise _broken()
        yield Page(unpacked, _encoding(header))


def _encoding(header: dict[int, _Value]) -> int | None:
    for kind, field in _ENCODING.items():
        inner = header.get(kind)
        if isinstance(inner, dict):
            found = inner.get(field)
            return found if isinstance(found, int) else None
    return None


def _struct(data: bytes, place: int, depth: int) -> tuple[dict[int, _Value], int]:
    if depth > _DEEPEST:
        raise _broken()
    fields: dict[int, _Value] = {}
    field = 0
    while True:
        head = data[place]
        place += 1
        kind, step = head & 0x0F, head >> 4
        if kind == _STOP:
            return fields, place
        if step:
            field += step
        else:
            raw, place = _varint(data, place)
            field = _zigzag(raw)
        fields[field], place = _value(data, place, kind, depth)


def _value(data: bytes, place: int, kind: int, depth: int) -> tuple[_Value, int]:
    if kind in (_TRUE, _FALSE):
        return int(kind == _TRUE), place
    if kind == _BYTE:
        return data[place], place + 1
    if kind in (_I16, _I32, _I64):
        raw, place = _varint(data, place)
        return _zigzag(raw), place
    if kind == _DOUBLE:
        return None, place + 8
    if kind == _BINARY:
        length, place = _varint(data, place)
        return None, place + length
    if kind == _STRUCT:
        return _struct(data, place, depth + 1)
    # Page headers of the format hold no lists, sets or maps.
    raise _broken()


def _varint(data: bytes, place: int) -> tuple[int, int]:
    number = shift = 0
    while True:
        byte = data[place]
        place += 1
        number |= (byte & 0x7F) << shift
        if byte < 0x80:
            return number, place
        shift += 7
        if shift > 63:
            raise _broken()


def _zigzag(number: int) -> int:
    return (number >> 1) ^ -(number & 1)


def _broken() -> Problem:
    return Problem(ProblemType.malformed_body, "the Parquet file is broken: a page has no readable header")
