"""Answers about positions as Arrow IPC stream and Parquet."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from service.codecs.batch.cells_out import number_array, time_array
from service.codecs.columns import UNIT_NANOSECONDS, TimeForm, Times
from service.codecs.positions.rows import Column, columns_of, epochs_of
from service.positions.located import Located
from service.schemas.position_query import PositionAnswerQuery


def write_arrow(located: Located, query: PositionAnswerQuery) -> bytes:
    """Arrow IPC stream: a row per satellite and epoch in the order they came, or one per epoch."""
    return _through(located, query, pa.ipc.new_stream)


def write_parquet(located: Located, query: PositionAnswerQuery) -> bytes:
    """Parquet with the same rows."""
    return _through(located, query, pq.ParquetWriter)


def _through(located: Located, query: PositionAnswerQuery, opened: Callable[[Any, Any], Any]) -> bytes:
    columns = {name: _array(column) for name, column in columns_of(located, query.rows).items()}
    if located.time is not None and located.form is not None:
        times = located.time[epochs_of(located, query.rows)]
        columns = {"time": time_array(times, located.form, whole=_are_whole(times, located.form)), **columns}
    table = pa.table(columns).replace_schema_metadata({"plumbline.method": located.answer.method})
    sink = pa.BufferOutputStream()
    with opened(sink, table.schema) as writer:
        writer.write_table(table)
    content: bytes = sink.getvalue().to_pybytes()
    return content


def _array(column: Column) -> Any:
    if isinstance(column, list):
        return pa.array(column, pa.string())
    return number_array(column) if column.dtype.kind == "f" else pa.array(column)


def _are_whole(times: Times, form: TimeForm) -> bool:
    """Whether times since 1970 are integers in their unit."""
    if form.kind != "epoch":
        return True
    return not np.any(times.astype("datetime64[ns]").astype(np.int64) % UNIT_NANOSECONDS[form.unit or "s"])
