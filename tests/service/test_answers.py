from __future__ import annotations

import json
import math
import struct
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from fastapi.testclient import TestClient

from estimators import Trend, fit_trend
from service.schemas.answers import TrendAnswer
from tests.service.series import CSV, body, contaminated

START = np.datetime64("2024-05-01T12:00:00", "ns")


def post(client: TestClient, fields: dict[str, Any], query: str = "", **headers: str) -> Any:
    response = client.post(f"/v1/trends{query}", json=fields, headers=headers)
    assert response.status_code == 200, response.text
    return response.json()


def library(times: Any, **arguments: Any) -> dict[str, Any]:
    """What the library answers, as plain JSON."""
    trend = fit_trend(times, np.array(contaminated()[1]), **arguments)
    assert isinstance(trend, Trend)
    plain: dict[str, Any] = json.loads(json.dumps(trend.to_dict()))
    return plain


def moments() -> np.ndarray[Any, np.dtype[np.datetime64]]:
    return START + (np.array(contaminated()[0]) * 60e9).astype("timedelta64[ns]")


def test_the_json_answer_is_the_dict_of_the_library(client: TestClient) -> None:
    answer = post(client, body(predict=[50.0], level=0.9, seed=3))
    assert answer == library(contaminated()[0], predict=[50.0], level=0.9, seed=3)


def test_with_points_in_time_it_is_the_dict_of_the_library_too(client: TestClient) -> None:
    texts = [f"{moment}Z" for moment in moments().astype("datetime64[s]")]
    assert post(client, body(time=texts)) == library(moments())


def test_fractions_of_seconds_are_written_as_the_library_writes_them(client: TestClient) -> None:
    shifted = moments() + np.timedelta64(1_500_000, "ns")
    answer = post(client, body(time=[f"{moment}Z" for moment in shifted]))
    assert answer == library(shifted)
    assert answer["points"]["time"][0] == "2024-05-01T12:00:00.0015Z"


@pytest.mark.parametrize(
    "fields",
    [
        body(),
        body(predict=[1, 2], method="msac", threshold=0.5),
        body(weight=[1.0] * 40),
        body(time=[f"2024-01-{day:02d}" for day in range(1, 21)] + [None] * 20),
        body(time_unit="ms", predict=[0]),
        {"time": [0, 1], "value": [0, 1]},
        {"time": [0, 1, 2, 3], "value": [5, 5, 5, 5]},
    ],
)
def test_a_real_answer_is_as_its_schema_says(client: TestClient, fields: dict[str, Any]) -> None:
    response = client.post("/v1/trends", json=fields)
    assert response.status_code == 200, response.text
    assert TrendAnswer.model_validate_json(response.content, strict=True).points is not None


def test_points_are_left_out_on_request(client: TestClient) -> None:
    whole = post(client, body())
    whole.pop("points")
    assert post(client, body(), "?points=false") == whole


def test_integer_epoch_times_come_back_as_the_same_integers(client: TestClient) -> None:
    nanoseconds = [1_714_564_800_000_000_001 + 60_000_000_000 * k for k in range(40)]
    answer = post(client, body(time=nanoseconds, time_unit="ns", predict=[nanoseconds[-1] + 7]))
    assert answer["points"]["time"] == nanoseconds
    assert answer["prediction"]["time"] == [nanoseconds[-1] + 7]
    assert answer["origin"] == nanoseconds[0]
    assert answer["time_unit"] == "second"


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
def test_the_unit_of_epoch_times_changes_nothing_else(client: TestClient, unit: str) -> None:
    factor = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}[unit]
    seconds = [1_714_564_800 + 60 * k for k in range(40)]
    answer = post(client, body(time=[factor * second for second in seconds], time_unit=unit))
    assert answer["parameters"] == post(client, body(time=seconds, time_unit="s"))["parameters"]
    assert answer["origin"] == factor * seconds[0]


def test_fractional_epoch_times_come_back_as_fractions(client: TestClient) -> None:
    times = [1_714_564_800.25 + k for k in range(40)]
    assert post(client, body(time=times, time_unit="s"))["points"]["time"] == times


def test_plain_integers_come_back_as_integers_and_plain_floats_as_floats(client: TestClient) -> None:
    response = client.post(
        "/v1/trends",
        content=json.dumps(body(time=list(range(40)))),
        headers={"content-type": "application/json"},
    )
    assert '"time":[0,1,2' in response.text
    assert post(client, body(time=[k + 0.5 for k in range(40)]))["points"]["time"][0] == 0.5


def test_rows_keep_their_order_and_missing_ones_their_place(client: TestClient) -> None:
    times, values = contaminated()
    fields = {"time": times[::-1], "value": [None, *values[::-1][1:]]}
    points = post(client, fields)["points"]
    assert points["time"] == times[::-1]
    assert points["reason"][0] == "missing"
    assert points["residual"][0] is None
    assert points["inlier"][0] is False


def test_csv_and_json_bodies_get_the_same_answer(client: TestClient) -> None:
    times, values = contaminated()
    table = "time,value\n" + "".join(f"{t!r},{v!r}\n" for t, v in zip(times, values, strict=True))
    response = client.post(
        "/v1/trends?level=0.9&predict=50.0&options.confidence=0.9", content=table, headers=CSV
    )
    assert response.json() == post(client, body(level=0.9, predict=[50.0], options={"confidence": 0.9}))


def test_csv_is_answered_as_csv(client: TestClient) -> None:
    response = client.post("/v1/trends", json=body(), headers={"accept": "text/csv"})
    assert response.headers["content-type"].startswith("text/csv")
    assert len(response.text.splitlines()) == 41


def test_a_picture_comes_as_svg_with_the_same_bytes_every_time(client: TestClient) -> None:
    first, second = (client.post("/v1/trends?format=svg", json=body()) for _ in range(2))
    assert first.headers["content-type"] == "image/svg+xml"
    assert ET.fromstring(first.content).tag.endswith("svg")
    assert first.content == second.content


def test_a_picture_comes_as_png_in_the_size_asked_for(client: TestClient) -> None:
    response = client.post(
        "/v1/trends?format=png&width_px=400&height_px=300&theme=dark&title=%24x%5E", json=body()
    )
    assert response.headers["content-type"] == "image/png"
    assert struct.unpack(">II", response.content[16:24]) == (400, 300)


def test_answers_tell_how_long_each_phase_took(client: TestClient) -> None:
    header = client.post("/v1/trends", json=body()).headers["server-timing"]
    phases = dict(part.split(";dur=") for part in header.split(", "))
    assert list(phases) == ["parse", "queue", "fit", "encode"]
    assert all(math.isfinite(float(value)) and float(value) >= 0 for value in phases.values())


def test_seasons_and_the_evidence_for_a_shape_go_over_the_wire(client: TestClient) -> None:
    times, _ = contaminated()
    seasonal = {"seasonal": [12.0], "harmonics": 1}
    answer = post(client, body(model="linear", degree=2, **seasonal))
    assert answer == library(times, model="linear", degree=2, **seasonal)
    assert answer["seasons"] == [{"period": 12.0, "harmonics": 1, "chosen": False}]
    TrendAnswer.model_validate(answer)
    told = post(client, body(model="auto", seasonal="auto"))
    assert told == library(times, model="auto", seasonal="auto")
    assert [row["chosen"] for row in told["evidence"]].count(True) == 1
    TrendAnswer.model_validate(told)


@pytest.mark.parametrize(
    "fields", [{"seasonal": [1e9]}, {"seasonal": ["year"]}, {"degree": 2}, {"harmonics": 2}]
)
def test_seasons_that_cannot_be_fitted_are_a_problem(client: TestClient, fields: dict[str, Any]) -> None:
    response = client.post("/v1/trends", json=body(**fields))
    assert response.status_code == 422, response.text
    assert response.json()["errors"][0]["field"] in fields
