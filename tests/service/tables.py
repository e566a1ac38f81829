"""Long tables that the tests of the batch share, in every format that a body may have."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv as arrow_csv
import pyarrow.parquet as pq

from service.codecs.batch.registry import ARROW_FILE, ARROW_STREAM, PARQUET

ENDPOINT = "/v1/trends/batch"


def long_table(series: int = 5, rows: int = 24, *, shuffled: bool = True) -> pa.Table:
    """Lines of different slopes with noise and outliers; their rows are mixed."""
    rng = np.random.default_rng(5)
    names = np.repeat([f"s{k}" for k in range(series)], rows)
    time = np.tile(np.arange(rows), series)
    value = np.repeat(np.arange(series), rows) * time + 0.1 * rng.standard_normal(time.size)
    value[3::9] += 20.0
    order = rng.permutation(time.size) if shuffled else np.arange(time.size)
    return pa.table({"series": names[order], "time": time[order], "value": value[order]})


def as_parquet(table: pa.Table, **options: Any) -> bytes:
    sink = io.BytesIO()
    pq.write_table(table, sink, **options)
    return sink.getvalue()


def as_stream(table: pa.Table, rows: int | None = None, **options: Any) -> bytes:
    sink = io.BytesIO()
    with pa.ipc.new_stream(sink, table.schema, options=pa.ipc.IpcWriteOptions(**options)) as writer:
        writer.write_table(table, max_chunksize=rows)
    return sink.getvalue()


def as_file(table: pa.Table, **options: Any) -> bytes:
    sink = io.BytesIO()
    with pa.ipc.new_file(sink, table.schema, options=pa.ipc.IpcWriteOptions(**options)) as writer:
        writer.write_table(table)
    return sink.getvalue()


def as_csv(table: pa.Table) -> bytes:
    sink = io.BytesIO()
    arrow_csv.write_csv(table, sink)
    return sink.getvalue()


def as_json(table: pa.Table) -> bytes:
    return json.dumps(table.to_pydict()).encode()


FORMATS: dict[str, tuple[str, Callable[[pa.Table], bytes]]] = {
    "json": ("application/json", as_json),
    "csv": ("text/csv", as_csv),
    "arrow stream": (ARROW_STREAM, as_stream),
    "arrow file": (ARROW_FILE, as_file),
    "parquet": (PARQUET, as_parquet),
}
