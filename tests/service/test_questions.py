"""Regimes and crossings over HTTP: the dict of the library, with times in the form they came."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from estimators import fit_trend
from service.schemas.answers import TrendAnswer

ROWS = np.arange(120)
LEVEL = np.where(ROWS < 70, 0.5 * ROWS, 0.25 * (ROWS - 70)) + np.random.default_rng(1).normal(size=120)
ASKED: dict[str, Any] = {"regime": "last", "reach": [30.0, -5.0], "horizon": 200}


def post(client: TestClient, fields: dict[str, Any]) -> dict[str, Any]:
    response = client.post("/v1/trends", json=fields)
    assert response.status_code == 200, response.text
    assert TrendAnswer.model_validate_json(response.content, strict=True).crossings is not None
    answer: dict[str, Any] = response.json()
    return answer


def test_the_answer_is_that_of_the_library(client: TestClient) -> None:
    answer = post(client, {"time": ROWS.tolist(), "value": LEVEL.tolist(), **ASKED})
    trend = fit_trend(ROWS, LEVEL, **ASKED)
    assert answer == json.loads(json.dumps(trend.to_dict()))
    assert [item["start"] for item in answer["regimes"]] == [0, 70]
    assert set(answer["points"]["reason"][:70]) == {"earlier_regime"}


def test_times_since_1970_come_back_as_times_since_1970(client: TestClient) -> None:
    series = {"time": (ROWS * 60).tolist(), "time_unit": "s", "value": LEVEL.tolist()}
    answer = post(client, {**series, "regime": "last", "reach": 30, "horizon": 12_000})
    assert [item["start"] for item in answer["regimes"]] == [0, 4200]
    crossing = answer["crossings"][0]
    assert 7140 < crossing["low"] < crossing["time"] < crossing["high"]
    assert crossing["horizon"] == 12_000
    assert answer["slope_per"]["unit"] == "minute"


def test_iso_times_come_back_as_iso_times(client: TestClient) -> None:
    moments = (np.datetime64("2024-01-01", "s") + ROWS * np.timedelta64(1, "h")).astype(str).tolist()
    series = {"time": [f"{moment}Z" for moment in moments], "value": LEVEL.tolist()}
    answer = post(
        client, {**series, "regime": "last", "reach": [30.0], "horizon": "2024-02-01T00:00:00+01:00"}
    )
    assert answer["regimes"][1]["start"] == "2024-01-03T22:00:00Z"
    assert answer["crossings"][0]["horizon"] == "2024-01-31T23:00:00Z"
    assert answer["crossings"][0]["time"].startswith("2024-01-")


def test_a_csv_body_asks_in_the_query(client: TestClient) -> None:
    body = "time,value\n" + "".join(f"{t},{y}\n" for t, y in zip(ROWS, LEVEL.tolist(), strict=True))
    query = {"regime": "last", "reach": ["30,-5", "40"], "horizon": "200", "points": "false"}
    response = client.post("/v1/trends", params=query, content=body, headers={"Content-Type": "text/csv"})
    told = [(item["value"], item["status"]) for item in response.json()["crossings"]]
    assert told == [(30.0, "crosses"), (-5.0, "already"), (40.0, "crosses")]


@pytest.mark.parametrize(
    ("fields", "field"),
    [
        ({"regime": "first"}, "regime"),
        ({"reach": []}, "reach"),
        ({"reach": [1.0] * 101}, "reach"),
        ({"reach": "90"}, "reach"),
        ({"reach": 1e61}, "reach"),
        ({"reach": True}, "reach"),
        ({"reach": [None]}, "reach"),
        ({"reach": 90, "horizon": 5}, "horizon"),
        ({"reach": 90, "horizon": [200]}, "horizon"),
        ({"reach": 90, "horizon": {}}, "horizon"),
        ({"reach": 90, "horizon": "2024-01-01"}, "horizon"),
        ({"reach": 90, "horizon": 1e300}, "horizon"),
        ({"horizon": 200}, "horizon"),
    ],
)
def test_a_question_that_cannot_be_asked_names_its_field(
    client: TestClient, fields: dict[str, Any], field: str
) -> None:
    response = client.post("/v1/trends", json={"time": ROWS.tolist(), "value": LEVEL.tolist(), **fields})
    assert response.status_code == 422
    assert response.json()["errors"][0]["field"].startswith(field)


def test_in_a_query_a_value_that_is_no_number_is_refused(client: TestClient) -> None:
    response = client.post(
        "/v1/trends?reach=90,x", content="time,value\n1,2\n2,3\n", headers={"Content-Type": "text/csv"}
    )
    assert response.status_code == 422
    assert response.json()["errors"][0]["field"].startswith("reach")
