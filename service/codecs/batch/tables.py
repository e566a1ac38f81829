"""Answers of a batch as tables: Arrow stream and file, Parquet, CSV; generators of bytes over the parts."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from service.codecs.batch.answer import POINT_PREFIX, Answer
from service.codecs.batch.cells_out import to_values


def write_arrow(answer: Answer) -> Iterator[bytes]:
    """Arrow IPC stream: a record batch per part."""
    return _through(answer, pa.ipc.new_stream)


def write_arrow_file(answer: Answer) -> Iterator[bytes]:
    """Arrow IPC file: a record batch per part, and an index."""
    return _through(answer, pa.ipc.new_file)


def write_parquet(answer: Answer) -> Iterator[bytes]:
    """Parquet: a row group per part."""
    return _through(answer, pq.ParquetWriter)


def write_csv(answer: Answer) -> Iterator[bytes]:
    """One line per series; with points, one line per row of the table, series after series."""
    header = False
    for part in answer.parts:
        text = io.StringIO(newline="")
        lines = csv.writer(text, lineterminator="\n")
        columns = _point_columns(part) if answer.has_points else _series_columns(part)
        if not header:
            lines.writerow(columns)
            header = True
        lines.writerows(zip(*columns.values(), strict=True))
        yield text.getvalue().encode()


class _Drain(io.RawIOBase):
    """A file that is only written, and gives away what it holds."""

    def __init__(self) -> None:
        self._pieces: list[bytes] = []
        self._place = 0

    def writable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._place

    def write(self, piece: Any) -> int:
        kept = bytes(piece)
        self._pieces.append(kept)
        self._place += len(kept)
        return len(kept)

    def drain(self) -> bytes:
        """Everything written since the last time."""
        pieces, self._pieces = self._pieces, []
        return b"".join(pieces)


def _through(answer: Answer, opened: Callable[[Any, Any], Any]) -> Iterator[bytes]:
    """Bytes that one of Arrow's writers makes of the parts."""
    drain = _Drain()
    writer = None
    for part in answer.parts:
        if writer is None:
            writer = opened(pa.PythonFile(drain, mode="w"), part.schema.with_metadata(_facts(answer)))
        writer.write_batch(part.replace_schema_metadata(_facts(answer)))
        yield drain.drain()
    if writer is not None:
        writer.close()
    yield drain.drain()


def _facts(answer: Answer) -> dict[str, str]:
    """List what holds for all rows, as metadata of the schema."""
    facts = {
        "model": answer.model,
        "method": answer.method,
        "level": repr(answer.level),
        "seed": str(answer.seed),
        "time_unit": answer.time_unit or "",
    }
    return {f"plumbline.{name}": text for name, text in facts.items()}


def _series_columns(part: Any) -> dict[str, list[Any]]:
    named = zip(part.schema.names, part.columns, strict=True)
    columns = {name: _cells(to_values(column)) for name, column in named}
    columns["notices"] = [" ".join(codes) for codes in columns["notices"]]
    return columns


def _point_columns(part: Any) -> dict[str, list[Any]]:
    lists = {
        name.removeprefix(POINT_PREFIX): column
        for name, column in zip(part.schema.names, part.columns, strict=True)
        if name.startswith(POINT_PREFIX)
    }
    lengths = lists["row"].value_lengths().to_pylist()
    names = to_values(part.column("series"))
    series = [name for name, length in zip(names, lengths, strict=True) for _ in range(length)]
    flat = {name: _cells(to_values(column.flatten())) for name, column in lists.items()}
    return {"series": series} | flat


def _cells(values: list[Any]) -> list[Any]:
    """Values as CSV has them: empty where there is none, true and false in lower case."""
    if any(isinstance(value, bool) for value in values[:1]):
        return ["true" if value else "false" for value in values]
    return ["" if value is None or value != value else value for value in values]  # noqa: PLR0124
