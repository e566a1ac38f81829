"""Parquet and Arrow tables to a :class:`Recording`, with the names of columns that CSV knows too.

Needs the extra ``plumbline[arrow]``. Only the columns that are used are read, and their size is known before.
"""

from __future__ import annotations

from collections.abc import Mapping
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

PARQUET, ARROW_FILE, ARROW_STREAM = b"PAR1", b"ARROW1", b"\xff\xff\xff\xff"


def read_table(
    stream: IO[bytes],
    *,
    columns: Mapping[str, str] | None = None,
    time_unit: TimeUnit | None = None,
    most_bytes: int = MOST_BYTES,
) -> Recording:
    """Read a Parquet file, an Arrow file or an Arrow stream.

    Parameters
    ----------
    stream : binary file
    columns, time_unit
        As for CSV.
    most_bytes : int
        Size above which a table is refused: eight bytes per cell that is read.

    Raises
    ------
    InputError
        If it is damaged or too large, lacks times, latitudes or longitudes, or pyarrow is not installed.
    """
    try:
        import pyarrow as pa  # noqa: PLC0415
        import pyarrow.parquet as pq  # noqa: PLC0415
    except ImportError as error:
        raise InputError(FIELD, "needs pyarrow to be read; install plumbline[arrow], or send CSV") from error
    body = stream.read()
    form = "parquet" if body.startswith(PARQUET) else "arrow"
    try:
        if form == "parquet":
            names = _named(pq.read_schema(pa.BufferReader(body)).names, columns or {})
            # Text is left as it is stored, once for each different word: spelt out it has no bound.
            file = pq.ParquetFile(pa.BufferReader(body), read_dictionary=list(names.values()))
            _check_size(file.metadata.num_rows, len(names), most_bytes)
            table = file.read(columns=list(names.values()))
        else:
            source = pa.BufferReader(body)
            opened = pa.ipc.open_file if body.startswith(ARROW_FILE) else pa.ipc.open_stream
            table = opened(source).read_all()
            names = _named(table.schema.names, columns or {})
            _check_size(table.num_rows, len(names), most_bytes)
        # Offsets of a damaged table may point anywhere.
        table.select(list(names.values())).validate(full=True)
    except InputError:
        raise
    except (pa.ArrowException, OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(FIELD, f"is a damaged {form.capitalize()} file; write it again") from error
    try:
        return _recording(form, table, names, time_unit)
    except pa.ArrowException as error:
        raise InputError(FIELD, "has a column of a type that is no number, time or text") from error


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


def _recording(form: str, table: Any, names: dict[str, str], unit: TimeUnit | None) -> Recording:
    time, offsets, time_unreadable = _times(table.column(names["time"]), unit)
    lat, bad_lat = _numbers(table.column(names["lat"]))
    lon, bad_lon = _numbers(table.column(names["lon"]))
    measured = {column: _numbers(table.column(names[column]))[0] for column in RANGES if column in names}
    device, devices = code_names(_texts(table.column(names["device"]))) if "device" in names else (None, ())
    segment = code_names(_texts(table.column(names["segment"])))[0] if "segment" in names else None
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


def _texts(column: Any) -> list[str]:
    """Text of each row, where rows of the same text share it; empty where one is missing."""
    import pyarrow as pa  # noqa: PLC0415

    texts: list[str] = []
    for chunk in (column if pa.types.is_dictionary(column.type) else column.dictionary_encode()).chunks:
        words = ["" if word is None else str(word) for word in chunk.dictionary.to_pylist()]
        texts += ["" if place is None else words[place] for place in chunk.indices.to_pylist()]
    return texts


def _numbers(column: Any) -> tuple[FloatArray, BoolArray]:
    """Numbers of a column of numbers or text; infinities and text that is none are unreadable."""
    import pyarrow as pa  # noqa: PLC0415

    if not (
        pa.types.is_integer(column.type) or pa.types.is_floating(column.type) or pa.types.is_null(column.type)
    ):
        if pa.types.is_decimal(column.type):
            return _numbers(column.cast(pa.float64()))
        return parse_numbers(_texts(column))
    values = column.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)
    values = np.array(values, dtype=np.float64)
    infinite = np.isinf(values)
    values[infinite] = np.nan
    return values, infinite


def _times(column: Any, unit: TimeUnit | None) -> Timed:
    import pyarrow as pa  # noqa: PLC0415
    import pyarrow.compute as pc  # noqa: PLC0415

    if pa.types.is_date(column.type):
        column = column.cast(pa.timestamp("s"))
    if pa.types.is_timestamp(column.type):
        moments = _moments(column.cast(pa.timestamp("ns", tz=column.type.tz)))
        if column.type.tz is None:
            return moments, None, np.zeros(len(column), dtype=np.bool_)
        local = _moments(pc.local_timestamp(column).cast(pa.timestamp("ns")))
        shift = (local - moments).astype("timedelta64[m]")
        minutes = np.where(np.isnat(shift), 0, shift.astype(np.int64)).astype(np.int16)
        return moments, minutes, np.zeros(len(column), dtype=np.bool_)
    if pa.types.is_integer(column.type) or pa.types.is_floating(column.type):
        return times_of_numbers(*_numbers(column), unit)
    return times_of_cells([as_bytes(_texts(column))], unit)


def _moments(column: Any) -> Any:
    return column.to_numpy(zero_copy_only=False).astype("datetime64[ns]")
