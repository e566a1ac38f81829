"""``POST /v1/positions`` and ``GET /v1/position-methods`` as callers meet them."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

import estimators
from estimators import Epochs, locate, locate_series
from service.codecs.json import dumps
from service.errors import ProblemType
from service.schemas.fixes import PositionAnswer, PositionsAnswer
from tests.service.problems import refused
from tests.service.ranges import HERE, LIAR, NAMES, as_csv, epoch, epochs


def post(client: TestClient, fields: dict[str, Any], **params: Any) -> Any:
    return client.post("/v1/positions", json=fields, params=params)


def post_csv(client: TestClient, fields: dict[str, Any], **params: Any) -> Any:
    return client.post(
        "/v1/positions", content=as_csv(fields), params=params, headers={"content-type": "text/csv"}
    )


def satellites(fields: dict[str, Any]) -> np.ndarray:
    return np.column_stack([fields["x_m"], fields["y_m"], fields["z_m"]])


def test_one_epoch_is_answered_with_the_dict_of_the_library(client: TestClient) -> None:
    fields = epoch()
    answer = post(client, fields).json()
    fix = locate(satellites(fields), fields["pseudorange_m"], satellite=NAMES)
    assert isinstance(fix, estimators.Fix)
    assert answer == json.loads(dumps(fix.to_dict()))
    PositionAnswer.model_validate(answer)
    assert answer["satellites"]["status"][LIAR] == "excluded"
    assert np.linalg.norm(np.array(answer["position"]["ecef_m"]) - HERE) < 15.0


def test_many_epochs_are_answered_with_the_dict_of_the_library(client: TestClient) -> None:
    fields = epochs()
    answer = post(client, fields).json()
    columns = Epochs.from_columns(
        time=fields["time"],
        satellites_m=satellites(fields),
        pseudoranges_m=fields["pseudorange_m"],
        satellite=fields["satellite"],
    )
    fixes = locate_series(columns)
    assert isinstance(fixes, estimators.Fixes)
    assert answer == json.loads(dumps(fixes.to_dict()))
    PositionsAnswer.model_validate(answer)


def test_csv_is_answered_as_json_is(client: TestClient) -> None:
    assert post_csv(client, epoch(), rotated=True).content == post(client, epoch()).content
    assert post_csv(client, epochs(), rotated=True).json() == post(client, epochs()).json()


def test_columns_of_other_names_are_left_alone_in_csv(client: TestClient) -> None:
    fields = {**epoch(), "station": ["a"] * 9}
    assert post_csv(client, fields, rotated=True).content == post(client, epoch()).content


def test_options_in_the_query_of_a_csv_are_those_of_the_body(client: TestClient) -> None:
    asked = post_csv(client, epoch(), rotated=True, **{"options.fault_prior": 0.01}).json()
    assert asked["integrity"]["fault_prior"] == 0.01
    assert asked == post(client, epoch(options={"fault_prior": 0.01})).json()


def test_rows_of_mixed_epochs_come_back_in_the_order_they_came(client: TestClient) -> None:
    fields = epochs()
    order = np.random.default_rng(5).permutation(len(fields["time"]))
    mixed = {
        name: [column[row] for row in order] if isinstance(column, list) else column
        for name, column in fields.items()
    }
    answer = post(client, mixed).json()
    assert answer["satellites"]["satellite"] == mixed["satellite"]
    times = [answer["fixes"]["time"][k] for k in answer["satellites"]["epoch"]]
    assert times == mixed["time"]


@pytest.mark.parametrize(
    ("times", "unit"),
    [(["2024-05-01T12:00:00Z", "2024-05-01T12:00:30Z"], None), ([1714564800000, 1714564830000], "ms")],
)
def test_times_come_back_in_the_form_they_came(
    client: TestClient, times: list[Any], unit: str | None
) -> None:
    fields = epochs(2) | {"time": [moment for moment in times for _ in NAMES], "time_unit": unit}
    response = post(client, fields)
    assert response.json()["fixes"]["time"] == times
    features = post(client, fields, format="geojson").json()["features"]
    assert [feature["properties"]["time"] for feature in features] == times


def test_the_columns_of_the_satellites_can_be_left_out(client: TestClient) -> None:
    assert "satellites" not in post(client, epoch(), satellites=False).json()
    assert "satellites" not in post(client, epochs(), satellites=False).json()


def test_csv_out_has_a_line_per_satellite_with_its_status(client: TestClient) -> None:
    rows = list(csv.DictReader(io.StringIO(post(client, epoch(), format="csv").text)))
    assert [row["satellite"] for row in rows] == NAMES
    assert [row["satellite"] for row in rows if row["status"] == "excluded"] == [NAMES[LIAR]]


def test_csv_out_of_many_epochs_says_the_time_of_each_line(client: TestClient) -> None:
    rows = list(csv.DictReader(io.StringIO(post(client, epochs(), format="csv").text)))
    assert [float(row["time"]) for row in rows] == epochs()["time"]


def test_geojson_is_a_point_at_the_position(client: TestClient) -> None:
    response = client.post("/v1/positions", json=epoch(), headers={"accept": "application/geo+json"})
    assert response.headers["content-type"] == "application/geo+json"
    feature = response.json()
    assert feature["geometry"]["coordinates"][:2] == pytest.approx([13.4, 52.5], abs=1e-3)
    assert feature["properties"]["excluded"] == [NAMES[LIAR]]


def test_pictures_of_the_sky_are_drawn_in_the_size_asked_for(client: TestClient) -> None:
    svg = post(client, epoch(), format="svg")
    assert svg.headers["content-type"] == "image/svg+xml"
    assert NAMES[LIAR] in svg.text
    png = post(client, epoch(), format="png", width_px=300, height_px=240).content
    assert png[:4] == b"\x89PNG"
    assert (int.from_bytes(png[16:20]), int.from_bytes(png[20:24])) == (300, 240)


def test_a_picture_of_many_epochs_is_refused(client: TestClient) -> None:
    refused(post(client, epochs(), format="svg"), ProblemType.invalid_value, "figure")


def test_whether_positions_are_rotated_is_never_guessed(client: TestClient) -> None:
    fields = epoch()
    del fields["rotated"]
    refused(post(client, fields), ProblemType.invalid_value, "rotated")
    refused(post_csv(client, fields), ProblemType.invalid_value, "rotated")


def test_positions_that_are_not_rotated_are_turned_here(client: TestClient) -> None:
    turned = np.array(post(client, epoch(rotated=False)).json()["position"]["ecef_m"])
    kept = np.array(post(client, epoch()).json()["position"]["ecef_m"])
    assert np.linalg.norm(turned - kept) > 10.0


def test_what_is_infinite_is_null(client: TestClient) -> None:
    fields = {name: column[:4] if isinstance(column, list) else column for name, column in epoch(0.0).items()}
    answer = post(client, fields).json()
    assert answer["satellites"]["mdb_m"] == [None] * 4
    assert answer["satellites"]["status"] == ["untestable"] * 4
    PositionAnswer.model_validate(answer)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"pseudorange_m": [2e7] * 8}, "x_m"),
        ({"x_m": [0.0] * 9, "y_m": [0.0] * 9, "z_m": [0.0] * 9}, "x_m"),
        ({"satellite": ["G01"] * 9}, "satellite"),
        ({"system": ["Q"] * 9}, "system"),
        ({"sigma_m": [-1.0] * 9}, "sigma_m"),
        ({"cn0_dbhz": [99.0] * 9}, "cn0_dbhz"),
        ({"method": "wishes"}, "method"),
        ({"motion": "static"}, "motion"),
        ({"options": {"fault_prior": 2}}, "options.fault_prior"),
        ({"x_m": ["east"] * 9}, "x_m"),
        ({"pseudorange_m": []}, "pseudorange_m"),
        ({"time": [None] * 9}, "time"),
    ],
)
def test_a_wrong_value_is_refused_by_its_name_on_the_wire(
    client: TestClient, change: dict[str, Any], field: str
) -> None:
    refused(post(client, epoch(**change)), ProblemType.invalid_value, field)


def test_nan_in_json_is_refused_with_its_row(client: TestClient) -> None:
    fields = epoch()
    fields["pseudorange_m"][2] = float("nan")
    response = client.post(
        "/v1/positions", content=json.dumps(fields), headers={"content-type": "application/json"}
    )
    assert refused(response, ProblemType.invalid_value, "pseudorange_m")["row"] == 2


def test_too_few_satellites_are_told_with_the_reason(client: TestClient) -> None:
    fields = {name: column[:3] if isinstance(column, list) else column for name, column in epoch().items()}
    problem = refused(post(client, fields), ProblemType.no_position, "pseudorange_m")
    assert problem["reason"] == "too_few_satellites"
    assert len(problem["points"]["reason"]) == 3
    series = {**fields, "time": [0.0, 0.0, 0.0]}
    assert refused(post(client, series), ProblemType.no_position, "pseudorange_m")["reason"] == (
        "too_few_satellites"
    )


def test_a_required_column_that_is_absent_is_named(client: TestClient) -> None:
    fields = epoch()
    del fields["z_m"]
    refused(post(client, fields), ProblemType.invalid_value, "z_m")
    refused(post_csv(client, fields, rotated=True), ProblemType.invalid_value, "z_m")


def test_an_unknown_key_is_refused(client: TestClient) -> None:
    refused(post(client, epoch(speed=3)), ProblemType.unknown_field, "speed")


def test_arguments_of_a_json_body_do_not_come_in_the_query(client: TestClient) -> None:
    refused(post(client, epoch(), rotated=True), ProblemType.unknown_field, "rotated")


def test_more_rows_than_the_limit_are_refused(client: TestClient) -> None:
    fields = {name: [1.0] * 5001 for name in ("x_m", "y_m", "z_m", "pseudorange_m")} | {"rotated": True}
    problem = post(client, fields).json()
    assert (problem["type"], problem["limit"]) == (ProblemType.too_many_points.uri, 5000)


def test_a_method_for_single_epochs_takes_each_by_itself(client: TestClient) -> None:
    answer = post(client, epochs() | {"method": "raim"}).json()
    assert (answer["motion"], answer["method"]) == ("independent", "raim")


def test_the_methods_listed_are_those_of_the_library(client: TestClient) -> None:
    listed = [row["name"] for row in client.get("/v1/position-methods").json()["methods"]]
    assert listed == list(estimators.position_methods())
    for name in listed:
        assert post(client, epoch(method=name)).json()["method"] == name
