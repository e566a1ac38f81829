"""Every way to ask wrongly, by name: each is answered by its own problem, never by 500 or with an echo."""

from __future__ import annotations

import dataclasses
import json

import httpx2
import pytest
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.errors import ProblemType
from service.schemas.problems import ProblemAnswer
from tests.service.series import CSV, JSON

SECRET = "do-not-repeat-me"


@dataclasses.dataclass(frozen=True)
class Wrong:
    """A request, and where the problem it meets points to."""

    body: bytes
    kind: ProblemType
    field: str | None = None
    row: int | None = None
    headers: dict[str, str] = dataclasses.field(default_factory=lambda: JSON)
    query: str = ""


VALUE, UNKNOWN, BROKEN = ProblemType.invalid_value, ProblemType.unknown_field, ProblemType.malformed_body


def columns(value: bytes, time: bytes = b"[0,1,2]", rest: bytes = b"") -> bytes:
    return b'{"time":' + time + b',"value":' + value + rest + b"}"


def extra(rest: str) -> bytes:
    return columns(b"[1,2,3]", rest=b"," + rest.encode())


JSON_BODIES = {
    "NaN": Wrong(columns(b"[1,NaN,3]"), VALUE, "value", 1),
    "Infinity": Wrong(columns(b"[1,2,Infinity]"), VALUE, "value", 2),
    "minus Infinity": Wrong(columns(b"[ -Infinity , 1,2]"), VALUE, "value", 0),
    "1e999": Wrong(columns(b"[1,2,1e999]"), VALUE, "value", 2),
    "a boolean as a number": Wrong(columns(b"[true,2,3]"), VALUE, "value", 0),
    "a string as a number": Wrong(columns(b'[1,"2",3]'), VALUE, "value", 1),
    "nested arrays": Wrong(columns(b"[[1],[2],[3]]"), VALUE, "value", 0),
    "an object as a column": Wrong(columns(b'{"a":1}'), VALUE, "value"),
    "unequal lengths": Wrong(columns(b"[1,2]"), VALUE, "value"),
    "empty columns": Wrong(columns(b"[]", b"[]"), VALUE, "time"),
    "no value column": Wrong(b'{"time":[1,2]}', VALUE, "value"),
    "no time column": Wrong(b'{"value":[1,2]}', VALUE, "time"),
    "null as a column": Wrong(columns(b"null"), VALUE, "value"),
    "a boolean as a time": Wrong(columns(b"[1,2,3]", b"[0,false,2]"), VALUE, "time", 1),
    "times in two forms": Wrong(columns(b"[1,2,3]", b'["2024-01-01",2,3]'), VALUE, "time", 1),
    "text that is no time": Wrong(columns(b"[1,2,3]", b'["2024-01-01","noon","later"]'), VALUE, "time", 1),
    "integer beyond 64 bits": Wrong(columns(b"[1,2,3]", b"[0,1,9223372036854775808]"), VALUE, "time", 2),
    "integer of 5000 digits": Wrong(columns(b"[1,2,3]", b"[0,1," + b"9" * 5000 + b"]"), VALUE, "time", 2),
    "epoch number out of range": Wrong(
        columns(b"[1,2,3]", b"[0,1,1e300]", b',"time_unit":"s"'), VALUE, "time", 2
    ),
    "a unit for ISO times": Wrong(
        columns(b"[1]", b'["2024-01-01"]', b',"time_unit":"s"'), VALUE, "time_unit"
    ),
    "an unknown unit": Wrong(extra('"time_unit":"fortnight"'), VALUE, "time_unit"),
    "a negative weight": Wrong(extra('"weight":[1,1,-1]'), VALUE, "weight", 2),
    "a missing weight": Wrong(extra('"weight":[1,null,1]'), VALUE, "weight", 1),
    "too few weights": Wrong(extra('"weight":[1]'), VALUE, "weight"),
    "prediction in another form": Wrong(extra('"predict":["2024-01-01"]'), VALUE, "predict"),
    "prediction at no time": Wrong(extra('"predict":[5,null]'), VALUE, "predict", 1),
    "a value beyond 1e60": Wrong(columns(b"[1,2,-1e61]"), VALUE, "value", 2),
    "a time beyond 1e30": Wrong(columns(b"[1,2,3]", b"[0,1e300,2]"), VALUE, "time", 1),
    "integers further apart than 64 bits": Wrong(
        columns(b"[1,2]", b"[-9223372036854775808,9223372036854775807]"), VALUE, "time"
    ),
    "a time of 5e-324": Wrong(columns(b"[1,2]", b"[0,5e-324]"), VALUE, "time", 1),
    "an unknown key": Wrong(extra('"metod":"auto"'), UNKNOWN, "metod"),
    "an unknown option": Wrong(extra('"options":{"confidance":0.9}'), UNKNOWN, "options.confidance"),
    "a repeated key": Wrong(columns(b"[1,2,3]", rest=b',"value":[1,2,3]'), VALUE, "value"),
    "a repeated option": Wrong(
        extra('"options":{"confidence":0.9,"confidence":0.8}'), VALUE, "options.confidence"
    ),
    "an option of another type": Wrong(extra('"options":{"confidence":"0.9"}'), VALUE, "options.confidence"),
    "options that contradict": Wrong(
        extra('"options":{"max_hypotheses":5}'), VALUE, "options.min_hypotheses"
    ),
    "options that are null": Wrong(extra('"options":null'), VALUE, "options"),
    "an unknown method": Wrong(extra(f'"method":"{SECRET}"'), VALUE, "method"),
    "an unknown model": Wrong(extra(f'"model":"{SECRET}"'), VALUE, "model"),
    "a level of 1": Wrong(extra('"level":1'), VALUE, "level"),
    "a level of 1e999": Wrong(extra('"level":1e999'), VALUE, "level"),
    "a boolean seed": Wrong(extra('"seed":true'), VALUE, "seed"),
    "a threshold of zero": Wrong(extra('"threshold":0'), VALUE, "threshold"),
    "an empty body": Wrong(b"", ProblemType.empty_body),
    "a blank body": Wrong(b" \n\t", ProblemType.empty_body),
    "an array as body": Wrong(b"[1,2,3]", BROKEN),
    "null as body": Wrong(b"null", BROKEN),
    "a truncated body": Wrong(b'{"time":[0,1', BROKEN),
    "something after the body": Wrong(columns(b"[1,2,3]") + b"{}", BROKEN),
    "invalid UTF-8 in a key": Wrong(b'{"\xff":1}', BROKEN),
    "invalid UTF-8 in a time": Wrong(columns(b"[1]", b'["\xff"]'), VALUE, "time"),
    "invalid UTF-8 in an argument": Wrong(columns(b"[1]", b"[1]", b',"model":"\xff"'), VALUE, "model"),
    "deep nesting": Wrong(b'{"time":' + b"[" * 50_000 + b"]" * 50_000 + b"}", BROKEN),
    "too many rows": Wrong(
        json.dumps({"time": list(range(5_001)), "value": [0] * 5_001}).encode(), ProblemType.too_many_points
    ),
    "too large a body": Wrong(b" " * 200_001, ProblemType.body_too_large),
    "data without a trend": Wrong(columns(b"[1,2,3]", b"[5,5,5]"), ProblemType.no_fit, "time"),
    "nothing but missing values": Wrong(columns(b"[null,null,null]"), ProblemType.no_fit, "value"),
}
CSV_BODIES = {
    "an empty CSV": Wrong(b"", ProblemType.empty_body),
    "a CSV of blank lines": Wrong(b"\n\n", ProblemType.empty_body),
    "a CSV with a header only": Wrong(b"time,value\n", VALUE, "time"),
    "a CSV without the column": Wrong(b"a,b\n1,2\n", VALUE, "time_column"),
    "a CSV with the column twice": Wrong(b"time,value,value\n1,2,3\n", VALUE, "value_column"),
    "a CSV with a short row": Wrong(b"time,value\n1,2\n3\n", BROKEN, "body", 1),
    "a CSV with an open quote": Wrong(b'time,value\n1,"2\n', BROKEN),
    "a CSV with invalid UTF-8": Wrong(b"time,value\n1,\xff\n", BROKEN),
    "a CSV with infinity": Wrong(b"time,value\n1,inf\n", VALUE, "value", 0),
    "a CSV with 1e999": Wrong(b"time,value\n1,1\n2,1e999\n", VALUE, "value", 1),
    "a CSV with text for a number": Wrong(b"time,value\n1,1\n2,two\n", VALUE, "value", 1),
    "a CSV with times in two forms": Wrong(b"time,value\n2024-01-01,1\n2,2\n", VALUE, "time", 1),
    "a CSV with a bad prediction": Wrong(
        b"time,value\n1,1\n2,2\n", VALUE, "predict", 0, query="?predict=soon"
    ),
    "a CSV with a bad level": Wrong(b"time,value\n1,1\n2,2\n", VALUE, "level", query="?level=nan"),
    "a CSV with a bad option": Wrong(
        b"time,value\n1,1\n2,2\n", VALUE, "options.confidence", query="?options.confidence=2"
    ),
}
FINE = columns(b"[1,2,3]")
REQUESTS = {
    "no content type": Wrong(FINE, ProblemType.unsupported_media_type, headers={}),
    "an unknown content type": Wrong(
        FINE, ProblemType.unsupported_media_type, headers={"content-type": "application/xml"}
    ),
    "a compressed body": Wrong(
        FINE, ProblemType.unsupported_media_type, headers=JSON | {"content-encoding": "gzip"}
    ),
    "another charset": Wrong(
        FINE, ProblemType.unsupported_media_type, headers={"content-type": "text/csv; charset=latin-1"}
    ),
    "an unknown Accept": Wrong(FINE, ProblemType.not_acceptable, headers=JSON | {"accept": "text/html"}),
    "an unknown format": Wrong(FINE, VALUE, "format", query="?format=pdf"),
    "an unknown query parameter": Wrong(FINE, UNKNOWN, "fromat", query="?fromat=csv"),
    "a picture too small": Wrong(FINE, VALUE, "width_px", query="?format=png&width_px=1"),
    "a title with control characters": Wrong(FINE, VALUE, "title", query="?format=svg&title=a%00b"),
    "arguments in the query of a JSON body": Wrong(FINE, UNKNOWN, "level", query="?level=0.9"),
}
ALL = (
    JSON_BODIES
    | {name: Wrong(w.body, w.kind, w.field, w.row, CSV, w.query) for name, w in CSV_BODIES.items()}
    | REQUESTS
)


@pytest.fixture(params=sorted(ALL))
def met(request: pytest.FixtureRequest, client: TestClient) -> tuple[Wrong, httpx2.Response]:
    """A wrong request and its answer."""
    wrong = ALL[request.param]
    return wrong, client.post(f"/v1/trends{wrong.query}", content=wrong.body, headers=wrong.headers)


def test_a_wrong_request_is_answered_by_its_problem(met: tuple[Wrong, httpx2.Response]) -> None:
    wrong, response = met
    problem = response.json()
    assert response.status_code == wrong.kind.status
    assert response.headers["content-type"] == "application/problem+json"
    assert problem["type"] == wrong.kind.uri
    assert (problem.get("field"), problem.get("row")) == (wrong.field, wrong.row)
    assert problem["request_id"] == response.headers["x-request-id"]


def test_a_problem_is_as_its_schema_says(met: tuple[Wrong, httpx2.Response]) -> None:
    _, response = met
    answer = ProblemAnswer.model_validate_json(response.content, strict=True)
    assert answer.status == response.status_code
    assert answer.detail


@pytest.mark.parametrize(
    "body",
    [
        columns(f'["{SECRET}"]'.encode()),
        columns(b"[1,2]", f'["{SECRET}","b"]'.encode()),
        extra(f'"method":"{SECRET}"'),
        extra(f'"level":"{SECRET}"'),
        extra(f'"options":{{"confidence":"{SECRET}"}}'),
        extra(f'"time_unit":"{SECRET}"'),
        SECRET.encode(),
    ],
)
def test_what_was_sent_is_never_repeated(client: TestClient, body: bytes) -> None:
    response = client.post("/v1/trends", content=body, headers=JSON)
    assert response.status_code in (400, 422)
    assert SECRET not in response.text


def test_no_fit_says_why_and_what_became_of_every_row(client: TestClient) -> None:
    response = client.post("/v1/trends", json={"time": [5, 5, 5, None], "value": [1, 2, None, 3]})
    problem = response.json()
    assert problem["reason"] == "constant_time"
    assert len(problem["points"]["reason"]) == 4
    assert problem["points"]["reason"][2:] == ["missing", "missing"]


def test_all_wrong_arguments_are_named_at_once(client: TestClient) -> None:
    response = client.post("/v1/trends", content=extra('"level":2,"seed":-1'), headers=JSON)
    assert {error["field"] for error in response.json()["errors"]} == {"level", "seed"}


def test_all_unknown_keys_are_named_at_once(client: TestClient) -> None:
    response = client.post("/v1/trends", content=extra('"a":1,"b":2'), headers=JSON)
    assert [error["field"] for error in response.json()["errors"]] == ["a", "b"]


def test_a_405_says_which_methods_there_are(client: TestClient) -> None:
    response = client.get("/v1/trends")
    assert (response.status_code, response.headers["allow"]) == (405, "POST")
    assert response.json()["type"] == ProblemType.method_not_allowed.uri


@pytest.mark.parametrize(
    "path", ["/nowhere", "/v1/trends/", "/v1", "/v1/methods/x", "/docs/../etc", "/problems/x"]
)
def test_a_missing_route_is_a_problem(client: TestClient, path: str) -> None:
    response = client.get(path)
    assert response.status_code == 404
    assert response.json()["type"] == ProblemType.not_found.uri


def test_a_fault_of_the_service_is_a_problem_that_tells_nothing(
    make_client: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    client: TestClient = make_client()  # type: ignore[operator]
    quiet = TestClient(client.app, raise_server_exceptions=False)

    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError(SECRET)

    monkeypatch.setattr("service.api.trends.fit_trend", broken)
    response = quiet.post("/v1/trends", content=FINE, headers=JSON)
    assert response.status_code == 500
    assert response.json()["type"] == ProblemType.internal_error.uri
    assert response.json()["request_id"] == response.headers["x-request-id"] != ""
    assert response.headers["x-content-type-options"] == "nosniff"
    assert SECRET not in response.text


NUMBERS = st.one_of(
    st.none(),
    st.integers(-(2**63), 2**63 - 1),
    st.floats(-1e30, 1e30),
    st.floats(-1e60, 1e60),
    st.integers(0, 5),
    st.floats(allow_nan=False, allow_infinity=False),
)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rows=st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=8))
def test_any_finite_numbers_get_a_trend_or_a_problem(
    client: TestClient, rows: list[tuple[float | None, float | None]]
) -> None:
    times, values = zip(*rows, strict=True)
    response = client.post("/v1/trends", json={"time": times, "value": values, "predict": [0]})
    assert response.status_code in (200, 422)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(content=st.binary(max_size=60), media=st.sampled_from([JSON, CSV]))
def test_any_bytes_get_a_problem(client: TestClient, content: bytes, media: dict[str, str]) -> None:
    response = client.post("/v1/trends", content=content, headers=media)
    assert response.status_code in (400, 422)
    assert response.headers["content-type"] == "application/problem+json"
