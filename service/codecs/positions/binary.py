"""Answers about positions as Arrow IPC stream and Parquet."""

from __future__ import annotations

from typing import Any

import pyarrow as pa

from service.codecs.arrow_bytes import column_array, to_arrow, to_parquet
from service.codecs.batch.cells_out import time_array
from service.codecs.columns import are_whole
from service.codecs.positions.rows import columns_of, epochs_of
from service.positions.located import Located
from service.schemas.position_query import PositionAnswerQuery


def write_arrow(located: Located, query: PositionAnswerQuery) -> bytes:
    """Arrow IPC stream: a row per satellite and epoch in the order they came, or one per epoch."""
    return to_arrow(_table(located, query))


def write_parquet(located: Located, query: PositionAnswerQuery) -> bytes:
    """Parquet with the same rows."""
    return to_parquet(_table(located, query))


def _table(located: Located, query: PositionAnswerQuery) -> Any:
    columns = {name: column_array(column) for name, column in columns_of(located, query.rows).items()}
    if located.time is not None and located.form is not None:
        times = located.time[epochs_of(located, query.rows)]
        columns = {"time": time_array(times, located.form, whole=are_whole(times, located.form)), **columns}
    return pa.table(columns).replace_schema_metadata({"plumbline.method": located.answer.method})
