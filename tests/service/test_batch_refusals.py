"""Every way to send a wrong batch: each is answered by a problem that names the field, never by 500."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import pyarrow as pa
import pytest
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.codecs.batch.registry import ARROW_FILE, ARROW_STREAM, PARQUET
from service.errors import ProblemType
from service.schemas.problems import ProblemAnswer
from tests.service.tables import ENDPOINT, FORMATS, as_csv, as_file, as_parquet, as_stream, long_table

SECRET = "do-not-repeat-me"
VALUE, BROKEN = ProblemType.invalid_value, ProblemType.malformed_body
TABLE = long_table()


@dataclasses.dataclass(frozen=True)
class Wrong:
    """A body, and where the problem it meets points to."""

    body: bytes
    kind: ProblemType
    field: str | None = None
    row: int | None = None
    media_type: str = "application/json"
    query: str = ""
    accept: dict[str, str] = dataclasses.field(default_factory=dict)


def columns(**changed: Any) -> bytes:
    given = {"series": ["a", "a", "b"], "time": [0, 1, 2], "value": [1.0, 2.0, 3.0]} | changed
    return json.dumps({name: column for name, column in given.items() if column is not ...}).encode()


def table(**changed: Any) -> pa.Table:
    given = {"series": ["a", "a", "b"], "time": [0, 1, 2], "value": [1.0, 2.0, 3.0]} | changed
    return pa.table({name: column for name, column in given.items() if column is not ...})


def stream(**changed: Any) -> dict[str, Any]:
    return {"body": as_stream(table(**changed)), "media_type": ARROW_STREAM}


def csv(text: str) -> dict[str, Any]:
    return {"body": text.encode(), "media_type": "text/csv"}


JSON_BODIES = {
    "names of two types": Wrong(columns(series=["1", 1, "1"]), VALUE, "series", 1),
    "a missing name": Wrong(columns(series=["a", None, "b"]), VALUE, "series", 1),
    "an empty name": Wrong(columns(series=["a", "a", ""]), VALUE, "series", 2),
    "a boolean name": Wrong(columns(series=[True, "a", "b"]), VALUE, "series", 0),
    "a name of 80 bits": Wrong(columns(series=[1, 2, 2**80]), VALUE, "series", 2),
    "a name of half a character": Wrong(b'{"series":["\\ud800"],"time":[0],"value":[1]}', BROKEN),
    "a value that is text": Wrong(columns(value=[1.0, SECRET, 2.0]), VALUE, "value", 1),
    "a time that is an array": Wrong(columns(time=[0, [1], 2]), VALUE, "time", 1),
    "times of two kinds": Wrong(columns(time=["2024-01-01", 1, 2]), VALUE, "time", 1),
    "columns of unequal length": Wrong(columns(value=[1.0]), VALUE, "value"),
    "no series": Wrong(columns(series=...), VALUE, "series"),
    "empty columns": Wrong(columns(series=[], time=[], value=[]), VALUE, "series"),
    "half a position": Wrong(columns(lat=[1.0, 1.0, 1.0]), VALUE, "lon"),
    "a latitude of 91": Wrong(columns(lat=[1.0, 91.0, 1.0], lon=[1.0] * 3), VALUE, "lat", 1),
    "a negative weight": Wrong(columns(weight=[1.0, -1.0, 1.0]), VALUE, "weight", 1),
    "a value beyond 1e60": Wrong(columns(value=[1.0, 1e61, 1.0]), VALUE, "value", 1),
    "a key that is not known": Wrong(columns(names=[1]), ProblemType.unknown_field, "names"),
    "a key twice": Wrong(b'{"series":["a"],"series":["a"],"time":[0],"value":[1]}', VALUE, "series"),
    "the arguments in the body": Wrong(columns(method="auto"), ProblemType.unknown_field, "method"),
    "an unknown method": Wrong(columns(), VALUE, "method", query=f"?method={SECRET}"),
    "an unknown format": Wrong(columns(), VALUE, "format", query="?format=xlsx"),
    "an unknown parameter": Wrong(columns(), ProblemType.unknown_field, "predict", query="?predict=3"),
    "options that contradict": Wrong(
        columns(), VALUE, "options.min_hypotheses", query="?options.max_hypotheses=5"
    ),
    "a picture": Wrong(columns(), ProblemType.not_acceptable, accept={"accept": "image/png"}),
    "an empty body": Wrong(b" ", ProblemType.empty_body),
    "too many rows": Wrong(
        columns(series=["a"] * 5_001, time=[0] * 5_001, value=[0.0] * 5_001), ProblemType.too_many_points
    ),
}
CSV_BODIES = {
    "no such column": Wrong(kind=VALUE, field="series_column", **csv("name,time,value\na,1,2\n")),
    "a column twice": Wrong(kind=VALUE, field="time_column", **csv("series,time,time,value\na,1,1,2\n")),
    "a column asked for": Wrong(
        kind=VALUE, field="lat_column", query="?lat_column=y", **csv("series,time,value\na,1,2\n")
    ),
    "text among numbers": Wrong(
        kind=VALUE, field="value", row=1, **csv(f"series,time,value\na,1,2\na,2,{SECRET}\n")
    ),
    "infinity": Wrong(kind=VALUE, field="value", row=0, **csv("series,time,value\na,1,inf\n")),
    "a number too large": Wrong(kind=VALUE, field="value", row=0, **csv("series,time,value\na,1,1e999\n")),
    "a hexadecimal time": Wrong(kind=VALUE, field="time", row=0, **csv("series,time,value\na,0x10,1\n")),
    "a date among numbers": Wrong(
        kind=VALUE, field="time", row=1, **csv("series,time,value\na,1,1\na,2024-01-01,1\n")
    ),
    "a number among dates": Wrong(
        kind=VALUE, field="time", row=1, **csv("series,time,value\na,2024-01-01,1\na,7,1\n")
    ),
    "a unit for dates": Wrong(
        kind=VALUE, field="time_unit", query="?time_unit=s", **csv("series,time,value\na,2024-01-01,1\n")
    ),
    "an empty name": Wrong(kind=VALUE, field="series", row=1, **csv("series,time,value\na,1,2\n,1,2\n")),
    "a row too short": Wrong(kind=BROKEN, field="body", row=1, **csv("series,time,value\na,1,2\na,1\n")),
    "invalid UTF-8": Wrong(b"series,time,value\n\xff,1,2\n", BROKEN, "body", 0, "text/csv"),
    "a header alone": Wrong(kind=VALUE, field="series", **csv("series,time,value\n")),
    "a header of commas": Wrong(kind=BROKEN, **csv("," * 100_000)),
}
ARROW_BODIES = {
    "a missing name": Wrong(kind=VALUE, field="series", row=1, **stream(series=["a", None, "b"])),
    "a missing name in a dictionary": Wrong(
        kind=VALUE,
        field="series",
        row=2,
        **stream(series=pa.DictionaryArray.from_arrays([0, 0, 1], pa.array(["a", None]))),
    ),
    "names that are numbers": Wrong(kind=VALUE, field="series", **stream(series=[1.0, 1.0, 2.0])),
    "names that are bytes": Wrong(kind=VALUE, field="series", **stream(series=[b"a", b"a", b"b"])),
    "names that are lists": Wrong(kind=VALUE, field="series", **stream(series=[["a"], ["a"], ["b"]])),
    "values that are text": Wrong(kind=VALUE, field="value", row=0, **stream(value=["x", "y", "z"])),
    "values that are structs": Wrong(kind=VALUE, field="value", **stream(value=[{"v": 1}] * 3)),
    "values that are dates": Wrong(
        kind=VALUE, field="value", **stream(value=pa.array([1, 2, 3], pa.timestamp("s")))
    ),
    "times that are booleans": Wrong(kind=VALUE, field="time", **stream(time=[True, False, True])),
    "times that are durations": Wrong(
        kind=VALUE, field="time", **stream(time=pa.array([1, 2, 3], pa.duration("s")))
    ),
    "times beyond 2262": Wrong(
        kind=VALUE, field="time", row=1, **stream(time=pa.array([0, 10**12, 1], pa.timestamp("s")))
    ),
    "text that is no time": Wrong(
        kind=VALUE, field="time", row=1, **stream(time=["2024-01-01", SECRET, "2024-01-02"])
    ),
    "times of 65 bits": Wrong(
        kind=VALUE, field="time", **stream(time=pa.array([0, 1, 2**64 - 1], pa.uint64()))
    ),
    "a unit for timestamps": Wrong(
        kind=VALUE,
        field="time_unit",
        query="?time_unit=s",
        **stream(time=pa.array([1, 2, 3], pa.timestamp("s"))),
    ),
    "a stream cut off": Wrong(as_stream(TABLE)[:-300], BROKEN, media_type=ARROW_STREAM),
    "a stream without records": Wrong(as_stream(TABLE.slice(0, 0)), VALUE, "series", media_type=ARROW_STREAM),
    "a stream of noise": Wrong(b"\xff\xff\xff\xff" + b"\x07" * 500, BROKEN, media_type=ARROW_STREAM),
    "a file cut off": Wrong(as_file(TABLE)[:600], BROKEN, media_type=ARROW_FILE),
    "a Parquet file cut off": Wrong(as_parquet(TABLE)[:-30], BROKEN, media_type=PARQUET),
    "a Parquet file of noise": Wrong(b"PAR1" + b"\x07" * 500 + b"PAR1", BROKEN, media_type=PARQUET),
    "a Parquet file with a nested column": Wrong(
        as_parquet(table(value=[[1.0], [2.0], [3.0]])), VALUE, "value", media_type=PARQUET
    ),
    "a workbook": Wrong(b"PK\x03\x04" + b"0" * 50, ProblemType.unsupported_media_type, media_type="x/y"),
}
CASES = (
    JSON_BODIES
    | {f"CSV: {k}": v for k, v in CSV_BODIES.items()}
    | {f"Arrow: {k}": v for k, v in ARROW_BODIES.items()}
)


@pytest.mark.parametrize("name", CASES)
def test_a_wrong_batch_is_answered_by_its_problem(client: TestClient, name: str) -> None:
    wrong = CASES[name]
    headers = {"content-type": wrong.media_type} | wrong.accept
    response = client.post(ENDPOINT + wrong.query, content=wrong.body, headers=headers)
    problem = ProblemAnswer.model_validate_json(response.content, strict=True)
    assert (response.status_code, problem.type) == (wrong.kind.status, wrong.kind.uri), problem.detail
    assert (problem.field, problem.row) == (wrong.field, wrong.row), problem.detail
    assert SECRET not in response.text


def test_more_series_than_allowed_are_refused(make_client: object) -> None:
    client: TestClient = make_client(max_series=4)  # type: ignore[operator]
    response = client.post(ENDPOINT, content=as_csv(TABLE), headers={"content-type": "text/csv"})
    assert (response.status_code, response.json()["type"]) == (413, ProblemType.too_many_series.uri)
    assert response.json()["limit"] == 4
    fewer = as_csv(long_table(4))
    assert client.post(ENDPOINT, content=fewer, headers={"content-type": "text/csv"}).status_code == 200


def test_the_row_of_a_problem_counts_the_record_batches_before(client: TestClient) -> None:
    values = TABLE["value"].to_pylist()
    values[77] = 1e61
    body = as_stream(TABLE.set_column(2, "value", pa.array(values)), rows=10)
    problem = client.post(ENDPOINT, content=body, headers={"content-type": ARROW_STREAM}).json()
    assert (problem["field"], problem["row"]) == ("value", 77)
    names = TABLE["series"].to_pylist()
    names[43] = None
    body = as_stream(TABLE.set_column(0, "series", pa.array(names)), rows=10)
    problem = client.post(ENDPOINT, content=body, headers={"content-type": ARROW_STREAM}).json()
    assert (problem["field"], problem["row"]) == ("series", 43)


QUIET = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow]


@settings(max_examples=150, deadline=None, suppress_health_check=QUIET)
@given(content=st.binary(max_size=80), media_type=st.sampled_from([item[0] for item in FORMATS.values()]))
def test_any_bytes_get_a_problem(client: TestClient, content: bytes, media_type: str) -> None:
    response = client.post(ENDPOINT, content=content, headers={"content-type": media_type})
    assert response.status_code in (400, 413, 422)
    assert response.headers["content-type"] == "application/problem+json"


DAMAGED = {
    ARROW_STREAM: as_stream(TABLE),
    ARROW_FILE: as_file(TABLE, compression="zstd"),
    PARQUET: as_parquet(TABLE),
}


@settings(max_examples=200, deadline=None, suppress_health_check=QUIET)
@given(data=st.data(), media_type=st.sampled_from(list(DAMAGED)))
def test_a_damaged_table_is_answered_or_refused(
    client: TestClient, data: st.DataObject, media_type: str
) -> None:
    body = bytearray(DAMAGED[media_type])
    for _ in range(data.draw(st.integers(1, 4))):
        body[data.draw(st.integers(0, len(body) - 1))] = data.draw(st.integers(0, 255))
    response = client.post(ENDPOINT, content=bytes(body), headers={"content-type": media_type})
    assert response.status_code in (200, 400, 413, 422)


@settings(max_examples=80, deadline=None, suppress_health_check=QUIET)
@given(
    names=st.lists(
        st.one_of(st.sampled_from(["a", "b"]), st.integers(0, 2), st.none()), min_size=1, max_size=8
    ),
    number=st.one_of(st.none(), st.floats(-1e60, 1e60), st.integers(-(2**70), 2**70)),
)
def test_any_columns_get_rows_or_a_problem(
    client: TestClient, names: list[Any], number: float | None
) -> None:
    content = {"series": names, "time": list(range(len(names))), "value": [number] * len(names)}
    assert client.post(ENDPOINT, json=content).status_code in (200, 422)
