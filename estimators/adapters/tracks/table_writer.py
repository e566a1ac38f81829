"""A cleaned track as a table, Parquet or an Arrow stream, a batch of rows at a time.

Needs the extra ``plumbline[arrow]``. Columns have the names of those of CSV, and values instead of text.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from estimators.adapters.tracks.cleaned import Cleaned
from estimators.adapters.tracks.column_values import column_values
from estimators.adapters.tracks.recording import FIELD, Recording
from estimators.adapters.tracks.written_columns import Layout, epoch_numbers, zone_text
from estimators.arrays import InputError

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


def stream_parquet(pairs: Iterable[tuple[Recording, Cleaned]], layout: Layout) -> Iterator[bytes]:
    """Write Parquet, a row group for each piece.

    Parameters
    ----------
    pairs : iterable
        Rows and what is said of them.

    Raises
    ------
    InputError
        If pyarrow is not installed.
    """
    _, pq = _pyarrow()
    return _written(pairs, layout, pq.ParquetWriter)


def stream_arrow(pairs: Iterable[tuple[Recording, Cleaned]], layout: Layout) -> Iterator[bytes]:
    """Write an Arrow IPC stream, a batch for each piece; otherwise as :func:`stream_parquet`."""
    pa, _ = _pyarrow()
    return _written(pairs, layout, pa.ipc.new_stream)


def _pyarrow() -> tuple[Any, Any]:
    try:
        import pyarrow as pa  # noqa: PLC0415
        import pyarrow.parquet as pq  # noqa: PLC0415
    except ImportError as error:
        raise InputError(
            FIELD, "needs pyarrow to be written; install plumbline[arrow], or write CSV"
        ) from error
    return pa, pq


class _Drain(io.RawIOBase):
    """A file that is only appended to, and emptied as it grows."""

    def __init__(self) -> None:
        super().__init__()
        self._parts: list[bytes] = []
        self._size = 0

    def writable(self) -> bool:
        return True

    def write(self, data: ReadableBuffer, /) -> int:
        part = bytes(data)
        self._parts.append(part)
        self._size += len(part)
        return len(part)

    def tell(self) -> int:
        return self._size

    def emptied(self) -> bytes:
        """Take what was written since the last time."""
        held = b"".join(self._parts)
        self._parts.clear()
        return held


def _written(pairs: Iterable[tuple[Recording, Cleaned]], layout: Layout, opened: Any) -> Iterator[bytes]:
    drain = _Drain()
    writer: Any = None
    for recording, cleaned in pairs:
        table = _table(recording, cleaned, layout)
        if writer is None:
            writer = opened(drain, table.schema)
        writer.write_table(table)
        yield drain.emptied()
    if writer is not None:
        writer.close()
    yield drain.emptied()


def _table(recording: Recording, cleaned: Cleaned, layout: Layout) -> Any:
    pa, _ = _pyarrow()
    columns = _times(recording, layout)
    columns |= {name: _array(values) for name, values in column_values(recording, cleaned).items()}
    noted = {"plumbline.method": layout.method} if layout.method else None
    return pa.table(columns).replace_schema_metadata(noted)


def _array(values: Any) -> Any:
    """Arrow array of texts or of numbers."""
    pa, _ = _pyarrow()
    if isinstance(values, list):
        return pa.array(values, type=pa.string())
    return _numbers(values) if values.dtype.kind == "f" else pa.array(values)


def _numbers(values: Any) -> Any:
    """Floats, with null for what is not finite."""
    pa, _ = _pyarrow()
    return pa.array(values, mask=~np.isfinite(values))


def _times(recording: Recording, layout: Layout) -> dict[str, Any]:
    """Give times in the form they came; a zone that all share is the column's, others stand beside it."""
    pa, _ = _pyarrow()
    if recording.time.dtype.kind != "M":
        return {"time": _numbers(recording.time)}
    moments = recording.time.astype("datetime64[ns]")
    if layout.epoch is not None:
        numbers, missing = epoch_numbers(moments, layout)
        return {"time": pa.array(numbers, mask=missing)}
    if layout.zone_minutes is None:
        utc = pa.array(moments, type=pa.timestamp("ns", tz="UTC"))
        return {"time": utc, "utc_offset_minutes": pa.array(recording.utc_offset_minutes)}
    zone = "UTC" if layout.zone_minutes == 0 else zone_text(layout.zone_minutes)
    return {"time": pa.array(moments, type=pa.timestamp("ns", tz=zone))}
