"""Answers about tracks as Arrow IPC stream and Parquet: a row per fix."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pyarrow as pa

from service.codecs.arrow_bytes import column_array, to_arrow, to_parquet
from service.codecs.batch.cells_out import time_array
from service.codecs.columns import are_whole
from service.codecs.trajectories.rows import columns_of
from service.schemas.trajectories import TrackAnswerQuery
from service.trajectories.cleaned import CleanedTracks
from service.trajectories.recorded import Recorded


def write_arrow(cleaned: CleanedTracks, _query: TrackAnswerQuery) -> Iterator[bytes]:
    """Arrow IPC stream, rows in the order they came."""
    yield to_arrow(_table(cleaned))


def write_parquet(cleaned: CleanedTracks, _query: TrackAnswerQuery) -> Iterator[bytes]:
    """Parquet with the same rows."""
    yield to_parquet(_table(cleaned))


def _table(cleaned: CleanedTracks) -> Any:
    columns = {**_times(cleaned.recorded)}
    columns |= {name: column_array(column) for name, column in columns_of(cleaned).items()}
    return pa.table(columns).replace_schema_metadata({"plumbline.method": cleaned.method})


def _times(recorded: Recorded) -> dict[str, Any]:
    """Write times in the form they came; a zone that all share is the column's, others stand beside it."""
    form = recorded.form
    times = time_array(recorded.time, form, whole=are_whole(recorded.time, form))
    offsets = recorded.recording.utc_offset_minutes
    if form.kind != "iso" or offsets is None:
        return {"time": times}
    minutes = int(offsets[0])
    if np.all(offsets == minutes):
        sign = "-" if minutes < 0 else "+"
        zone = f"{sign}{abs(minutes) // 60:02d}:{abs(minutes) % 60:02d}"
        return {"time": times.cast(pa.timestamp("ns", zone))}
    return {"time": times, "utc_offset_minutes": pa.array(offsets)}
