"""Fixes that are no fixes, and requests that are refused, in JSON columns of ``POST /v1/trajectories``."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.errors import ProblemType
from service.schemas.tracks import TrackAnswer
from tests.service.conftest import MakeClient
from tests.service.fixes import SPIKE, N, clock, walk
from tests.service.problems import refused

URL = "/v1/trajectories"


def post(client: TestClient, fields: dict[str, Any], **params: Any) -> Any:
    return client.post(URL, json=fields, params=params)


def changed(row: int, **values: Any) -> dict[str, Any]:
    """A walk with other values in a row."""
    fields = walk()
    for name, value in values.items():
        fields[name][row] = value
    return fields


@pytest.mark.parametrize(
    ("row", "values"),
    [
        (7, {"lat": 91.0}),
        (7, {"lat": None}),
        (7, {"lon": -720.5}),
        (7, {"time": None}),
        (7, {"lat": 0.0, "lon": 0.0}),
    ],
)
def test_a_row_that_is_no_fix_is_invalid_and_the_others_are_cleaned(
    client: TestClient, row: int, values: dict[str, Any]
) -> None:
    answer = post(client, changed(row, **values)).json()
    TrackAnswer.model_validate(answer)
    assert answer["points"]["reason"][row] == "invalid"
    assert answer["points"]["reason"].count("invalid") == 1
    assert answer["points"]["reason"][SPIKE] == "spike"


FIXES = st.lists(
    st.tuples(
        st.none() | st.integers(-(10**9), 10**9) | st.floats(-1e9, 1e9, allow_nan=False),
        st.none() | st.floats(-200.0, 200.0, allow_nan=False),
        st.none() | st.floats(-800.0, 800.0, allow_nan=False),
        st.none() | st.floats(-1e9, 1e9, allow_nan=False),
    ),
    min_size=1,
    max_size=12,
)


@given(fixes=FIXES)
@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_whatever_the_numbers_every_row_has_a_reason_or_the_request_a_problem(
    client: TestClient, fixes: list[tuple[float | None, ...]]
) -> None:
    columns = dict(zip(("time", "lat", "lon", "accuracy"), map(list, zip(*fixes, strict=True)), strict=True))
    response = post(client, columns | {"height": columns["accuracy"]})
    if response.status_code == 200:
        TrackAnswer.model_validate(response.json())
        assert len(response.json()["points"]["reason"]) == len(fixes)
    else:
        assert response.status_code == 422
        assert response.json()["field"] in ("time", "lat")


def test_time_that_goes_backwards_is_put_in_order(client: TestClient) -> None:
    fields = walk()
    order = np.random.default_rng(5).permutation(N).tolist()
    mixed = {name: [column[k] for k in order] for name, column in fields.items()}
    answer, sorted_answer = post(client, mixed).json(), post(client, fields).json()
    assert answer["points"]["reason"] == [sorted_answer["points"]["reason"][k] for k in order]
    assert "unsorted_times" in [item["code"] for item in answer["notices"]]


@pytest.mark.parametrize("n", [1, 2])
def test_one_or_two_fixes_are_taken_for_what_they_are(client: TestClient, n: int) -> None:
    fields = {name: column[:n] for name, column in walk().items()}
    answer = post(client, fields).json()
    TrackAnswer.model_validate(answer)
    assert answer["points"]["lat_deg"] == pytest.approx(fields["lat"], abs=1e-3)


def test_all_the_same_place_is_a_track_that_stands(client: TestClient) -> None:
    answer = post(client, walk(lat=[48.0] * N, lon=[11.0] * N)).json()
    TrackAnswer.model_validate(answer)
    assert answer["distance"]["cleaned_m"]["value"] == 0.0


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"lat": [91.0] * N}, "no_data"),
        ({"lon": [None] * N}, "no_data"),
        ({"time": [5] * N}, "constant_time"),
    ],
)
def test_fixes_that_determine_no_track_are_told_with_the_reason(
    client: TestClient, change: dict[str, Any], reason: str
) -> None:
    field = "time" if reason == "constant_time" else "lat"
    problem = refused(post(client, walk(**change)), ProblemType.no_track, field)
    assert problem["reason"] == reason
    assert len(problem["points"]["reason"]) == N


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"time": []}, "time"),
        ({"time": [None] * N}, "time"),
        ({"time": ["noon"] * N}, "time"),
        ({"time": [1e300 * k for k in range(N)]}, "time"),
        ({"time": [3e9 * k for k in range(N)]}, "time"),
        ({"lat": [48.0] * (N - 1)}, "lat"),
        ({"lon": ["east"] * N}, "lon"),
        ({"height": [1.0]}, "height"),
        ({"device": ["a"]}, "device"),
        ({"device": ["a\n"] * N}, "device"),
        ({"device": [1.5] * N}, "device"),
        ({"method": "wishes"}, "method"),
        ({"level": 1.0}, "level"),
        ({"sigma_m": 0.0}, "sigma_m"),
        ({"max_speed_mps": -1.0}, "max_speed_mps"),
        ({"time_unit": "s", "time": clock()}, "time_unit"),
    ],
)
def test_a_wrong_value_is_refused_by_its_name_on_the_wire(
    client: TestClient, change: dict[str, Any], field: str
) -> None:
    refused(post(client, walk(**change)), ProblemType.invalid_value, field)


@pytest.mark.parametrize("name", ["lat", "lon", "time", "height", "accuracy"])
def test_nan_in_json_is_refused_with_its_row(client: TestClient, name: str) -> None:
    fields = walk(height=[1.0] * N, accuracy=[1.0] * N)
    fields[name][2] = float("nan")
    response = client.post(URL, content=json.dumps(fields), headers={"content-type": "application/json"})
    assert refused(response, ProblemType.invalid_value, name)["row"] == 2


@pytest.mark.parametrize("name", ["time", "lat", "lon"])
def test_a_required_column_that_is_absent_is_named(client: TestClient, name: str) -> None:
    fields = walk()
    del fields[name]
    refused(post(client, fields), ProblemType.invalid_value, name)


def test_a_column_that_would_be_ignored_is_refused(client: TestClient) -> None:
    refused(post(client, walk(temperature=[20.0] * N)), ProblemType.unknown_field, "temperature")


def test_arguments_of_a_json_body_do_not_come_in_the_query(client: TestClient) -> None:
    refused(post(client, walk(), method="auto"), ProblemType.unknown_field, "method")
    refused(post(client, walk(), lat_column="y"), ProblemType.unknown_field, "lat_column")


def test_more_fixes_than_the_limit_are_refused(client: TestClient) -> None:
    fields = {name: [1.0] * 5001 for name in ("time", "lat", "lon")}
    assert refused(post(client, fields), ProblemType.too_many_points, None)["limit"] == 5000


def test_more_devices_than_the_limit_are_refused(make_client: MakeClient) -> None:
    fields = walk(device=[f"d{k % 3}" for k in range(N)])
    problem = refused(post(make_client(max_series=2), fields), ProblemType.too_many_series, None)
    assert problem["limit"] == 2


def test_cleaning_past_the_deadline_is_a_problem(make_client: MakeClient) -> None:
    fields = walk(4_000, device=[f"d{k % 100}" for k in range(4_000)])
    response = post(make_client(deadline_seconds=0.05), fields)
    refused(response, ProblemType.deadline_exceeded, None)
