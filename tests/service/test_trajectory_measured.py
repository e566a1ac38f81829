"""What receivers measure beside places, over HTTP: speed and course, and error ellipses for accuracies."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from estimators import Track, accuracy_of_ellipse, clean_trajectory
from service.codecs.json import dumps
from service.errors import ProblemType
from tests.service.fixes import as_csv, walk
from tests.service.problems import refused

URL = "/v1/trajectories"
ROWS = 120


def measured() -> dict[str, Any]:
    """A walk with speeds and courses, as a receiver measures them."""
    random = np.random.default_rng(7)
    north, east = 11.1 + 0.2 * random.normal(size=ROWS), 0.2 * random.normal(size=ROWS)
    bearing = np.degrees(np.arctan2(east, north)) % 360.0
    return walk(ROWS, speed=np.hypot(north, east).tolist(), bearing=bearing.tolist())


def ellipses() -> dict[str, Any]:
    """A walk with error ellipses, every third of them large."""
    major = [30.0 if k % 3 == 0 else 4.0 for k in range(ROWS)]
    return walk(ROWS, semi_major=major, semi_minor=[3.0] * ROWS, orientation=[45.0] * ROWS)


def post(client: TestClient, fields: dict[str, Any]) -> Any:
    return client.post(URL, json=fields)


def post_table(client: TestClient, fields: dict[str, Any], **params: str) -> Any:
    return client.post(URL, content=as_csv(fields), headers={"content-type": "text/csv"}, params=params)


def of_library(fields: dict[str, Any], **columns: Any) -> Any:
    """Answer of the library as JSON."""
    track = clean_trajectory(fields["time"], fields["lat"], fields["lon"], **columns)
    assert isinstance(track, Track)
    return json.loads(dumps(track.to_dict()))


def test_speeds_and_courses_reach_the_library(client: TestClient) -> None:
    fields = measured()
    answer = post(client, fields).json()
    assert answer == of_library(fields, speed_mps=fields["speed"], bearing_deg=fields["bearing"])
    assert answer != post(client, walk(ROWS)).json()


def test_a_file_with_speeds_is_cleaned_with_them(client: TestClient) -> None:
    fields = measured()
    assert post_table(client, fields).json() == post(client, fields).json()


def test_columns_of_speeds_and_courses_are_told_by_the_query(client: TestClient) -> None:
    fields = measured()
    renamed = {**walk(ROWS), "doppler": fields["speed"], "toward": fields["bearing"]}
    asked = {"speed_column": "doppler", "bearing_column": "toward"}
    assert post_table(client, renamed, **asked).json() == post(client, fields).json()


def test_gaps_in_speeds_are_allowed(client: TestClient) -> None:
    fields = measured()
    fields["speed"][5], fields["bearing"][9] = None, None
    answer = post(client, fields).json()
    speed, bearing = np.array(fields["speed"], dtype=float), np.array(fields["bearing"], dtype=float)
    assert answer == of_library(fields, speed_mps=speed, bearing_deg=bearing)


def test_an_ellipse_is_the_circle_of_its_mean_square(client: TestClient) -> None:
    fields = ellipses()
    circle = accuracy_of_ellipse(fields["semi_major"], fields["semi_minor"])
    assert post(client, fields).json() == of_library(fields, accuracy_m=circle)
    assert post(client, fields).json() != post(client, walk(ROWS)).json()


def test_how_an_ellipse_lies_is_not_used(client: TestClient) -> None:
    fields = ellipses()
    turned = {**fields, "orientation": [-10.0] * ROWS}
    del fields["orientation"]
    assert post(client, turned).content == post(client, fields).content


def test_tables_may_hold_ellipses_under_any_name(client: TestClient) -> None:
    fields = ellipses()
    renamed = {**walk(ROWS), "a": fields["semi_major"], "b": fields["semi_minor"], "c": fields["orientation"]}
    asked = {"semi_major_column": "a", "semi_minor_column": "b", "orientation_column": "c"}
    expected = post(client, fields).json()
    assert post_table(client, renamed, **asked).json() == expected
    assert post_table(client, fields).json() == expected


def test_an_ellipse_that_is_named_goes_before_an_accuracy_that_the_table_holds(client: TestClient) -> None:
    fields = ellipses()
    both = {**fields, "accuracy": [4.0] * ROWS}
    asked = {"semi_major_column": "semi_major", "semi_minor_column": "semi_minor"}
    expected = post(client, fields).json()
    assert post_table(client, both, **asked).json() == expected
    assert post_table(client, both).json() == of_library(fields, accuracy_m=both["accuracy"])


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"accuracy": [5.0] * ROWS}, "accuracy"),
        ({"semi_minor": None}, "semi_minor"),
        ({"semi_major": None, "semi_minor": None}, "semi_major"),
        ({"semi_major": [5.0]}, "semi_major"),
        ({"orientation": ["north"] * ROWS}, "orientation"),
        ({"speed": [1.0]}, "speed"),
        ({"bearing": ["north"] * ROWS}, "bearing"),
    ],
)
def test_columns_that_make_no_sense_are_refused_by_their_names(
    client: TestClient, change: dict[str, Any], field: str
) -> None:
    refused(post(client, ellipses() | change), ProblemType.invalid_value, field)


@pytest.mark.parametrize("name", ["speed", "bearing", "semi_major", "semi_minor", "orientation"])
def test_nan_in_a_measured_column_is_refused_with_its_row(client: TestClient, name: str) -> None:
    fields = measured() | ellipses()
    fields[name][2] = float("nan")
    response = client.post(URL, content=json.dumps(fields), headers={"content-type": "application/json"})
    assert refused(response, ProblemType.invalid_value, name)["row"] == 2


@pytest.mark.parametrize(
    ("asked", "field"),
    [
        ({"semi_major_column": "a"}, "semi_minor_column"),
        ({"semi_minor_column": "a"}, "semi_major_column"),
        ({"semi_major_column": "a", "semi_minor_column": "gone"}, "semi_minor_column"),
        ({"semi_major_column": "a", "accuracy_column": "a"}, "accuracy_column"),
        ({"speed_column": "gone"}, "speed_column"),
        ({"bearing_column": "gone"}, "bearing_column"),
    ],
)
def test_columns_that_a_table_lacks_are_refused_by_the_parameter(
    client: TestClient, asked: dict[str, str], field: str
) -> None:
    table = {**walk(ROWS), "a": [5.0] * ROWS}
    refused(post_table(client, table, **asked), ProblemType.invalid_value, field)
