"""CSV to a :class:`Recording`: a header, columns known by their usual names, any common delimiter.

The file is read in pieces, so that ten million rows take the memory of their columns and not of their text.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Mapping
from itertools import islice
from typing import IO

import numpy as np

from estimators.adapters.tracks.assembly import RANGES, assemble, code_names
from estimators.adapters.tracks.field_names import NAMES, ColumnError, find_columns
from estimators.adapters.tracks.moments import Bytes, as_bytes
from estimators.adapters.tracks.numbers import parse_numbers
from estimators.adapters.tracks.recording import FIELD, Recording
from estimators.adapters.tracks.times import TimeUnit, times_of_cells
from estimators.arrays import BoolArray, FloatArray, InputError, IntArray

# Tried in this order: a comma may also be a decimal sign, so it yields to the others.
_DELIMITERS = "\t;|,"
_PIECE_ROWS = 1 << 16
_CLOCK = re.compile(r"\d\d:\d\d", re.ASCII)
_LONGEST_LINE = 1 << 16


def read_csv(
    stream: IO[bytes], *, columns: Mapping[str, str] | None = None, time_unit: TimeUnit | None = None
) -> Recording:
    r"""Read a table of fixes.

    Parameters
    ----------
    stream : binary file
        UTF-8, or UTF-16 with a mark. Lines that start with # are comments.
    columns : mapping of str to str, optional
        Name in the file of a column of :data:`NAMES`, where it is not told by its name.
    time_unit : {"s", "ms", "us", "ns"}, optional
        Times are numbers of these since 1970. Default: told by their form and size.

    Raises
    ------
    InputError
        If it is no table, or lacks times, latitudes or longitudes.

    Examples
    --------
    >>> import io
    >>> read_csv(io.BytesIO(b"Timestamp;Latitude;Longitude\n2021-07-28 07:00:00;50,5;7\n")).lat
    array([50.5])
    """
    head = stream.peek(2)[:2] if isinstance(stream, io.BufferedReader) else b""
    encoding = "utf-16" if head in {b"\xff\xfe", b"\xfe\xff"} else "utf-8-sig"
    lines = _lines(io.TextIOWrapper(stream, encoding=encoding, errors="replace", newline=""))
    delimiter, header = _read_header(next(lines, ""), columns or {})
    named = find_columns(header)
    for column, name in (columns or {}).items():
        named[column] = _own_name(column, name, header)
    if "time" not in named and "date" in named:
        named["time"] = named.pop("date")
    missing = [column for column in ("time", "lat", "lon") if column not in named]
    if missing:
        shown = ", ".join(repr(name[:30]) for name in header[:12])
        raise ColumnError(
            FIELD,
            f"has no column for {', '.join(missing)} in its header {shown}; rename, or say which it is",
            tuple(missing),
        )
    table = _Table({column: header.index(name) for column, name in named.items()}, delimiter)
    rows = csv.reader(lines, delimiter=delimiter, skipinitialspace=True, strict=True)
    try:
        while piece := list(islice(rows, _PIECE_ROWS)):
            table.extend([row for row in piece if row])
    except csv.Error as error:
        raise InputError(FIELD, f"cannot be read as CSV near row {rows.line_num} ({error})") from error
    return table.recording(time_unit)


def _lines(text: io.TextIOWrapper) -> Iterator[str]:
    for line in text:
        if line[0] != "#" and not line.isspace():
            yield line


def _read_header(line: str, columns: Mapping[str, str]) -> tuple[str, list[str]]:
    """Delimiter with which most columns are known, and the names."""
    best: tuple[int, str, list[str]] = (-1, ",", [])
    if len(line) <= _LONGEST_LINE:
        for delimiter in _DELIMITERS:
            try:
                names = [name.strip() for name in next(csv.reader([line], delimiter=delimiter))]
            except (csv.Error, StopIteration):
                continue
            known = len(find_columns(names)) + sum(name in names for name in columns.values())
            if known > best[0]:
                best = (known, delimiter, names)
    return best[1], best[2]


def _own_name(column: str, name: str, header: list[str]) -> str:
    if column not in NAMES:
        raise InputError("columns", f"{column[:40]!r} is none of {', '.join(NAMES)}")
    if name not in header:
        raise ColumnError("columns", f"the file has no column {name[:40]!r} for {column}", (column,))
    return name


class _Table:
    """Columns that grow piece by piece."""

    def __init__(self, places: dict[str, int], delimiter: str) -> None:
        self._places = places
        self._decimal_comma = delimiter != ","
        self._times: list[Bytes] = []
        self._numbers: dict[str, list[FloatArray]] = {
            column: [] for column in ("lat", "lon", *RANGES) if column in places
        }
        self._codes: dict[str, list[IntArray]] = {
            column: [] for column in ("device", "segment") if column in places
        }
        self._known: dict[str, dict[str, int]] = {"device": {}, "segment": {}}
        self._unreadable: list[BoolArray] = []

    def extend(self, rows: list[list[str]]) -> None:
        """Add rows; a cell beyond the end of a short row is missing."""
        self._times.append(as_bytes(self._moments(rows)))
        unreadable = np.zeros(len(rows), dtype=np.bool_)
        for column, parts in self._numbers.items():
            values, bad = parse_numbers(self._cells(column, rows), decimal_comma=self._decimal_comma)
            parts.append(values)
            if column in {"lat", "lon"}:
                unreadable |= bad
        self._unreadable.append(unreadable)
        for column, codes in self._codes.items():
            codes.append(code_names(self._cells(column, rows), self._known[column])[0])

    def _moments(self, rows: list[list[str]]) -> list[str | None]:
        """Cells of the times; behind those of a date where the file has it in a column of its own."""
        cells = self._cells("time", rows)
        if "date" not in self._places:
            return cells
        dates = self._cells("date", rows)
        return [
            f"{date} {cell}" if cell and date and _CLOCK.match(cell) else cell
            for date, cell in zip(dates, cells, strict=True)
        ]

    def _cells(self, column: str, rows: list[list[str]]) -> list[str | None]:
        place = self._places[column]
        try:
            return [row[place] for row in rows]
        except IndexError:
            return [row[place] if place < len(row) else None for row in rows]

    def recording(self, unit: TimeUnit | None) -> Recording:
        """All pieces as one."""
        if not self._times:
            raise InputError(FIELD, "has a header but no rows")
        # Parts are dropped as they are joined, which keeps the peak near the size of the columns.
        time, offsets, time_unreadable = times_of_cells(self._times, unit)
        self._times.clear()
        joined: dict[str, FloatArray] = {}
        for column in list(self._numbers):
            joined[column] = np.concatenate(self._numbers.pop(column))
        codes = {column: np.concatenate(parts) for column, parts in self._codes.items()}
        return assemble(
            "csv",
            time=time,
            lat=joined.pop("lat"),
            lon=joined.pop("lon"),
            time_unreadable=time_unreadable,
            position_unreadable=np.concatenate(self._unreadable),
            offsets=offsets,
            measured=joined,
            device=codes.get("device"),
            devices=tuple(self._known["device"]),
            segment=codes.get("segment"),
        )
