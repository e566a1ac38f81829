import io
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from estimators.adapters.tracks import RowFault, read_track
from estimators.arrays import InputError


def parquet(columns: dict[str, Any]) -> bytes:
    sink = io.BytesIO()
    pq.write_table(pa.table(columns), sink)
    return sink.getvalue()


def arrow(columns: dict[str, Any], opened: Any) -> bytes:
    table, sink = pa.table(columns), io.BytesIO()
    with opened(sink, table.schema) as writer:
        writer.write_table(table)
    return sink.getvalue()


COLUMNS = {
    "time": [0.0, 1.0, 2.0],
    "latitude": [50.0, 91.0, None],
    "lng": [7.0, 7.0, 7.0],
    "vehicle": ["a", "b", "a"],
}


@pytest.mark.parametrize("form", ["parquet", "file", "stream"])
def test_parquet_and_arrow_tables_are_read_alike(form: str) -> None:
    writers = {"file": pa.ipc.new_file, "stream": pa.ipc.new_stream}
    body = parquet(COLUMNS) if form == "parquet" else arrow(COLUMNS, writers[form])
    track = read_track(body)
    assert track.form == ("parquet" if form == "parquet" else "arrow")
    assert track.device_names() == ["a", "b", "a"]
    assert track.fault.tolist() == [RowFault.none, RowFault.position_unreadable, RowFault.position_missing]


def test_the_zone_of_a_timestamp_column_is_kept() -> None:
    moments = np.array(["2021-07-28T07:00", "2021-12-28T07:00", "NaT"], dtype="datetime64[ms]")
    column = pa.array(moments, pa.timestamp("ms", tz="Europe/Berlin"))
    track = read_track(parquet({"time": column, "lat": [50.0] * 3, "lon": [7.0] * 3}))
    assert track.utc_offset_minutes is not None
    assert track.utc_offset_minutes.tolist() == [120, 60, 0]
    assert track.time[0] == np.datetime64("2021-07-28T07:00")


def test_text_in_a_column_of_numbers_costs_its_row_only() -> None:
    track = read_track(parquet({"time": ["2021-07-28", "x"], "lat": ["50", "51"], "lon": ["7", "east"]}))
    assert track.lat[0] == 50.0
    assert track.fault.tolist() == [RowFault.none, RowFault.position_unreadable]


def test_a_table_that_would_not_fit_is_refused_before_it_is_read() -> None:
    column = pa.array(np.zeros(1_000_000))
    body = parquet({"time": column, "lat": column, "lon": column})
    assert len(body) < 1_000_000
    with pytest.raises(InputError, match="1000000 rows"):
        read_track(body, most_bytes=1_000_000)


def test_a_table_without_positions_names_its_columns() -> None:
    with pytest.raises(InputError, match=r"no column for lat, lon among 'time', 'value'"):
        read_track(parquet({"time": [0.0], "value": [1.0]}))


def test_a_cut_parquet_file_is_said_to_be_damaged() -> None:
    with pytest.raises(InputError, match="damaged Parquet"):
        read_track(parquet(COLUMNS)[:-20])


def test_words_of_a_dictionary_are_read_as_the_rows_have_them() -> None:
    words = pa.array(["b", None, "a"]).dictionary_encode()
    track = read_track(
        parquet({"time": [0.0, 1.0, 2.0], "lat": [1.0] * 3, "lon": [2.0] * 3, "device": words})
    )
    assert track.device_names() == ["b", "", "a"]
