"""Columns as Arrow arrays, and a table of them as bytes."""

from __future__ import annotations

from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from service.codecs.batch.cells_out import number_array


def column_array(column: Any) -> Any:
    """Arrow array of a list of texts or an array of numbers, with null for NaN."""
    if isinstance(column, list):
        return pa.array(column, pa.string())
    return number_array(column) if column.dtype.kind == "f" else pa.array(column)


def to_arrow(table: Any) -> bytes:
    """Arrow IPC stream of a ``pyarrow.Table``."""
    return _through(table, pa.ipc.new_stream)


def to_parquet(table: Any) -> bytes:
    """Parquet file of a ``pyarrow.Table``."""
    return _through(table, pq.ParquetWriter)


def _through(table: Any, opened: Any) -> bytes:
    sink = pa.BufferOutputStream()
    with opened(sink, table.schema) as writer:
        writer.write_table(table)
    content: bytes = sink.getvalue().to_pybytes()
    return content
