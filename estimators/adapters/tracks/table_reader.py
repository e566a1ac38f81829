"""Parquet and Arrow tables to a :class:`Recording`, with the names of columns that CSV knows too.

Needs the extra ``plumbline[arrow]``. Only the columns that are used are read, and their size is known before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np

from estimators.adapters.tracks.assembly import RANGES, assemble, code_names
from estimators.adapters.tracks.field_names import ColumnError, find_columns
from estimators.adapters.tracks.moments import as_bytes
from estimators.adapters.tracks.numbers import parse_numbers
from estimators.adapters.tracks.recording import FIELD, Recording
from estimators.adapters.tracks.source import MOST_BYTES, TooLargeError
from estimators.adapters.tracks.times import Timed, TimeUnit, times_of_cells, times_of_numbers
from estimators.arrays import BoolArray, FloatArray, InputError

_BATCH_ROWS = 1 << 16
PARQUET, ARROW_FILE, ARROW_STREAM = b"PAR1", b"ARROW1", b"\xff\xff\xff\xff"


def read_table(
    stream: IO[bytes],
    *,
    columns: Mapping[str, str] | None = None,
    time_unit: TimeUnit | None = None,
    most_bytes: int = MOST_BYTES,
    path: Path | None = None,
) -> Recording:
    """Read a Parquet file, an Arrow file or an Arrow stream.

    Parameters
    ----------
    stream : binary file
    columns, time_unit
        As for CSV.
    most_bytes : int
        Size above which a table is refused: eight bytes per cell that is read.
    path : Path, optional
        Of the stream's file: Parquet is then read from it column by column, and never held as bytes.

    Raises
    ------
    InputError
        If it is damaged or too large, lacks times, latitudes or longitudes, or pyarrow is not installed.
    """
    try:
        import pyarrow as pa  # noqa: PLC0415
    except ImportError as error:
        raise InputError(FIELD, "needs pyarrow to be read; install plumbline[arrow], or send CSV") from error
    form, source = _source(stream, path)
    opened = _open_parquet if form == "parquet" else _open_arrow
    with _damage(form):
        names, rows, kind_of, chunks_of = opened(source, columns or {})
        _check_size(rows, len(names), most_bytes)

    def column_of(column: str) -> _Column:
        name = names[column]
        with _damage(form):
            kind = kind_of(name)
        return _Column(kind, rows, _sound_chunks(form, chunks_of(name)))

    try:
        return _recording(form, column_of, names, time_unit)
    except pa.ArrowException as error:
        raise InputError(FIELD, "has a column of a type that is no number, time or text") from error
    finally:
        pa.default_memory_pool().release_unused()


@dataclass(frozen=True, slots=True)
class _Column:
    """A column whose chunks are read when it is their turn."""

    type: Any
    rows: int
    chunks: Iterator[Any]


def _sound_chunks(form: str, chunks: Iterable[Any]) -> Iterator[Any]:
    """Read chunk after chunk; offsets of a damaged table may point anywhere."""
    reading = iter(chunks)
    while True:
        with _damage(form):
            chunk = next(reading, None)
            if chunk is not None:
                chunk.validate(full=True)
        if chunk is None:
            return
        yield chunk


@contextmanager
def _damage(form: str) -> Iterator[None]:
    """Call what goes wrong while a table is read damage."""
    import pyarrow as pa  # noqa: PLC0415

    try:
        yield
    except InputError:
        raise
    except (pa.ArrowException, OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(FIELD, f"is a damaged {form.capitalize()} file; write it again") from error


def _source(stream: IO[bytes], path: Path | None) -> tuple[str, Any]:
    """Form of a table, and where it is read from: its file, where that is the table itself, or its bytes."""
    import pyarrow as pa  # noqa: PLC0415

    if path is not None:
        with path.open("rb") as file:
            magic = file.read(len(PARQUET))
        if magic == PARQUET:
            return "parquet", str(path)
    body = stream.read()
    return "parquet" if body.startswith(PARQUET) else "arrow", pa.BufferReader(body)


_Opened = tuple[dict[str, str], int, Callable[[str], Any], Callable[[str], Iterable[Any]]]
"""Names of columns, number of rows, and functions that give type and chunks of a column."""


def _open_parquet(source: Any, columns: Mapping[str, str]) -> _Opened:
    import pyarrow.parquet as pq  # noqa: PLC0415

    names = _named(pq.read_schema(source).names, columns)
    # Text is left as it is stored, once for each different word: spelt out it has no bound.
    file = pq.ParquetFile(source, read_dictionary=list(names.values()))

    def chunks_of(name: str) -> Iterator[Any]:
        for batch in file.iter_batches(_BATCH_ROWS, columns=[name], use_threads=False):
            yield batch.column(name)

    return names, file.metadata.num_rows, lambda name: file.schema_arrow.field(name).type, chunks_of


def _open_arrow(source: Any, columns: Mapping[str, str]) -> _Opened:
    import pyarrow as pa  # noqa: PLC0415

    is_file = source.read(len(ARROW_FILE)) == ARROW_FILE
    source.seek(0)
    table = (pa.ipc.open_file if is_file else pa.ipc.open_stream)(source).read_all()
    names = _named(table.schema.names, columns)
    return (
        names,
        table.num_rows,
        lambda name: table.schema.field(name).type,
        lambda name: table.column(name).chunks,
    )


def _named(names: list[str], columns: Mapping[str, str]) -> dict[str, str]:
    named = find_columns(names)
    for column, name in columns.items():
        if name not in names:
            raise ColumnError("columns", f"the file has no column {name[:40]!r} for {column[:40]}", (column,))
        named[column] = name
    date = named.pop("date", None)
    if "time" not in named and date is not None:
        named["time"] = date
    missing = [column for column in ("time", "lat", "lon") if column not in named]
    if missing:
        shown = ", ".join(repr(name[:30]) for name in names[:12])
        raise ColumnError(
            FIELD,
            f"has no column for {', '.join(missing)} among {shown}; rename, or say which it is",
            tuple(missing),
        )
    return named


def _check_size(rows: int, columns: int, most_bytes: int) -> None:
    if rows * columns * 8 > most_bytes:
        raise TooLargeError(
            FIELD, f"has {rows} rows, more than fit into {most_bytes} bytes; split it by time"
        )


def _recording(
    form: str, column_of: Callable[[str], _Column], names: dict[str, str], unit: TimeUnit | None
) -> Recording:
    """Read column after column, so that one at a time is held in both forms."""
    time, offsets, time_unreadable = _times(column_of("time"), unit)
    lat, bad_lat = _numbers(column_of("lat"))
    lon, bad_lon = _numbers(column_of("lon"))
    measured = {column: _numbers(column_of(column))[0] for column in RANGES if column in names}
    device, devices = code_names(_texts(column_of("device"))) if "device" in names else (None, ())
    segment = code_names(_texts(column_of("segment")))[0] if "segment" in names else None
    return assemble(
        form,
        time=time,
        lat=lat,
        lon=lon,
        time_unreadable=time_unreadable,
        position_unreadable=bad_lat | bad_lon,
        offsets=offsets,
        measured=measured,
        device=device,
        devices=devices,
        segment=segment,
    )


def _texts(column: _Column) -> list[str]:
    """Text of each row, where rows of the same text share it; empty where one is missing."""
    import pyarrow as pa  # noqa: PLC0415

    texts: list[str] = []
    for chunk in column.chunks:
        coded = chunk if pa.types.is_dictionary(chunk.type) else chunk.dictionary_encode()
        words = ["" if word is None else str(word) for word in coded.dictionary.to_pylist()]
        texts += ["" if place is None else words[place] for place in coded.indices.to_pylist()]
    return texts


def _numbers(column: _Column) -> tuple[FloatArray, BoolArray]:
    """Numbers of a column of numbers or text; infinities and text that is none are unreadable."""
    import pyarrow as pa  # noqa: PLC0415

    kinds = (pa.types.is_integer, pa.types.is_floating, pa.types.is_null, pa.types.is_decimal)
    if not any(is_kind(column.type) for is_kind in kinds):
        return parse_numbers(_texts(column))
    values = np.empty(column.rows)
    for own, chunk in _placed(column):
        values[own] = chunk.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)
    infinite = np.isinf(values)
    values[infinite] = np.nan
    return values, infinite


def _placed(column: _Column) -> Iterator[tuple[slice, Any]]:
    """Chunks with the rows that they hold."""
    first = 0
    for chunk in column.chunks:
        yield slice(first, first + len(chunk)), chunk
        first += len(chunk)


def _times(column: _Column, unit: TimeUnit | None) -> Timed:
    import pyarrow as pa  # noqa: PLC0415

    if pa.types.is_date(column.type) or pa.types.is_timestamp(column.type):
        return _moments(column)
    if pa.types.is_integer(column.type) or pa.types.is_floating(column.type):
        return times_of_numbers(*_numbers(column), unit)
    return times_of_cells([as_bytes(_texts(column))], unit)


def _moments(column: _Column) -> Timed:
    """Points in time, and where they come with a zone, its offsets."""
    import pyarrow as pa  # noqa: PLC0415
    import pyarrow.compute as pc  # noqa: PLC0415

    zoned = pa.types.is_timestamp(column.type) and column.type.tz is not None
    moments = np.empty(column.rows, dtype="datetime64[ns]")
    minutes = np.zeros(column.rows if zoned else 0, dtype=np.int16)
    for own, chunk in _placed(column):
        seconds = chunk.cast(pa.timestamp("s")) if pa.types.is_date(chunk.type) else chunk
        moments[own] = _nanoseconds(seconds)
        if zoned:
            shift = (_nanoseconds(pc.local_timestamp(chunk)) - moments[own]).astype("timedelta64[m]")
            minutes[own] = np.where(np.isnat(shift), 0, shift.astype(np.int64))
    return moments, minutes if zoned else None, np.zeros(column.rows, dtype=np.bool_)


def _nanoseconds(chunk: Any) -> Any:
    import pyarrow as pa  # noqa: PLC0415

    return chunk.cast(pa.timestamp("ns", tz=chunk.type.tz)).to_numpy(zero_copy_only=False)
