"""Pseudoranges as Arrow and Parquet, and positions as tables."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fastapi.testclient import TestClient

from service.codecs.batch.registry import ARROW_FILE, ARROW_STREAM, PARQUET
from service.errors import ProblemType
from tests.service.ranges import NAMES, epoch, epochs
from tests.service.tables import as_file, as_parquet, as_stream

FORMATS = {ARROW_STREAM: as_stream, ARROW_FILE: as_file, PARQUET: as_parquet}


def as_table(fields: dict[str, Any], **columns: Any) -> pa.Table:
    return pa.table({name: column for name, column in (fields | columns).items() if isinstance(column, list)})


def post(client: TestClient, body: bytes, media_type: str, **params: Any) -> Any:
    return client.post(
        "/v1/positions",
        content=body,
        params={"rotated": True, **params},
        headers={"content-type": media_type},
    )


def refused(response: Any, kind: ProblemType, field: str | None) -> dict[str, Any]:
    problem: dict[str, Any] = response.json()
    assert response.headers["content-type"] == "application/problem+json"
    assert (response.status_code, problem["type"], problem.get("field")) == (kind.status, kind.uri, field)
    return problem


@pytest.mark.parametrize("media_type", FORMATS)
@pytest.mark.parametrize("fields", [epoch(), epochs()], ids=["one epoch", "three epochs"])
def test_a_table_is_answered_as_json_is(client: TestClient, media_type: str, fields: dict[str, Any]) -> None:
    body = FORMATS[media_type](as_table(fields))
    assert post(client, body, media_type).json() == client.post("/v1/positions", json=fields).json()


def test_a_table_in_pieces_with_names_written_once_is_read_the_same(client: TestClient) -> None:
    fields = epochs(4)
    table = as_table(fields)
    place = table.schema.get_field_index("satellite")
    pieces = table.set_column(place, "satellite", table["satellite"].dictionary_encode())
    sink = io.BytesIO()
    with pa.ipc.new_stream(sink, pieces.schema) as writer:
        writer.write_table(pieces, max_chunksize=7)
    whole = post(client, as_stream(table), ARROW_STREAM)
    assert post(client, sink.getvalue(), ARROW_STREAM).content == whole.content


def test_timestamps_come_back_as_utc(client: TestClient) -> None:
    fields = epochs(2)
    moments = np.datetime64("2024-05-01T12:00:00", "s") + np.array(fields["time"], dtype=np.int64)
    table = as_table(fields | {"time": None}).append_column("time", pa.array(moments))
    answer = post(client, as_parquet(table), PARQUET).json()
    assert answer["fixes"]["time"] == ["2024-05-01T12:00:00Z", "2024-05-01T12:00:30Z"]


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"x_m": [True] * 9}, "x_m"),
        ({"x_m": [[1.0]] * 9}, "x_m"),
        ({"satellite": list(range(9))}, "satellite"),
        ({"satellite": ["a" * 101] * 9}, "satellite"),
        ({"satellite": [*NAMES[:8], None]}, "satellite"),
        ({"z_m": None}, "z_m"),
        ({"time": [[0]] * 9}, "time"),
    ],
)
@pytest.mark.parametrize("media_type", [ARROW_STREAM, PARQUET])
def test_a_column_that_is_something_else_is_refused_by_its_name(
    client: TestClient, media_type: str, change: dict[str, Any], field: str
) -> None:
    body = FORMATS[media_type](as_table(epoch() | change))
    refused(post(client, body, media_type), ProblemType.invalid_value, field)


def test_the_row_of_a_wrong_name_is_told(client: TestClient) -> None:
    names = [*NAMES[:5], "bell\a", *NAMES[6:]]
    problem = post(client, as_stream(as_table(epoch(satellite=names))), ARROW_STREAM).json()
    assert (problem["field"], problem["row"]) == ("satellite", 5)


@pytest.mark.parametrize("media_type", FORMATS)
def test_a_table_that_is_cut_off_is_refused(client: TestClient, media_type: str) -> None:
    body = FORMATS[media_type](as_table(epoch()))
    refused(post(client, body[: len(body) // 2], media_type), ProblemType.malformed_body, None)


def test_very_many_equal_rows_are_refused_before_they_are_unpacked(client: TestClient) -> None:
    zeros = pa.array(np.zeros(10**6))
    table = pa.table(dict.fromkeys(("x_m", "y_m", "z_m", "pseudorange_m"), zeros))
    body = as_parquet(table, compression="zstd")
    assert len(body) < 200_000
    refused(post(client, body, PARQUET), ProblemType.too_many_points, None)


def test_long_words_that_compress_to_nothing_are_refused(client: TestClient) -> None:
    table = as_table(epochs(100)).drop_columns(["satellite"]).append_column("system", [["a" * 5_000] * 900])
    body = as_parquet(table, compression="zstd", use_dictionary=False)
    assert len(body) < 200_000
    refused(post(client, body, PARQUET), ProblemType.body_too_large, None)


def read(content: bytes, kind: str) -> pa.Table:
    return pa.ipc.open_stream(content).read_all() if kind == "arrow" else pq.read_table(io.BytesIO(content))


@pytest.mark.parametrize("kind", ["arrow", "parquet"])
@pytest.mark.parametrize("fields", [epoch(), epochs()], ids=["one epoch", "three epochs"])
@pytest.mark.parametrize("rows", ["satellites", "epochs"])
def test_binary_tables_hold_what_the_csv_says(
    client: TestClient, kind: str, fields: dict[str, Any], rows: str
) -> None:
    def ask(form: str) -> Any:
        return client.post("/v1/positions", json=fields, params={"format": form, "rows": rows})

    table = read(ask(kind).content, kind)
    lines = list(csv.DictReader(io.StringIO(ask("csv").text)))
    assert table.column_names == list(lines[0])
    assert table.num_rows == len(lines)
    for name in table.column_names:
        for value, line in zip(table[name].to_pylist(), lines, strict=True):
            if value is None:
                assert line[name] == ""
            elif isinstance(value, bool):
                assert line[name] == str(value).lower()
            elif isinstance(value, float):
                assert float(line[name]) == value
            else:
                assert line[name] == str(value)


def test_a_row_per_epoch_says_where_it_was(client: TestClient) -> None:
    fields = epochs()
    answer = client.post("/v1/positions", json=fields).json()["fixes"]
    response = client.post("/v1/positions", json=fields, params={"format": "csv", "rows": "epochs"})
    lines = list(csv.DictReader(io.StringIO(response.text)))
    assert [float(line["time"]) for line in lines] == answer["time"]
    assert [float(line["lat_deg"]) for line in lines] == answer["lat_deg"]
    assert [float(line["clock_G_m"]) for line in lines] == answer["clocks_m"]["G"]


@pytest.mark.parametrize(
    ("times", "unit", "kind"),
    [
        (["2024-05-01T12:00:00Z"] * 9, None, pa.timestamp("ns", "UTC")),
        ([1714564800000] * 9, "ms", pa.int64()),
        ([1714564800.25] * 9, "s", pa.float64()),
        ([7.5] * 9, None, pa.float64()),
    ],
)
def test_times_of_an_arrow_answer_have_the_type_of_their_form(
    client: TestClient, times: list[Any], unit: str | None, kind: pa.DataType
) -> None:
    fields = epoch(time=times, time_unit=unit)
    table = read(client.post("/v1/positions", json=fields, params={"format": "arrow"}).content, "arrow")
    assert table.schema.field("time").type == kind
