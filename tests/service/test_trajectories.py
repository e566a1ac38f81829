"""``POST /v1/trajectories`` with JSON columns, and ``GET /v1/trajectory-methods``, as callers meet them."""

from __future__ import annotations

import json
from typing import Any

import pytest
from fastapi.testclient import TestClient

import estimators
from estimators import TrackOptions, clean_trajectory
from service.codecs.json import dumps
from service.errors import ProblemType
from service.schemas.tracks import TrackAnswer, TracksAnswer
from tests.service.fixes import SPIKE, N, clock, two_walks, walk
from tests.service.problems import refused

URL = "/v1/trajectories"


def post(client: TestClient, fields: dict[str, Any], **params: Any) -> Any:
    return client.post(URL, json=fields, params=params)


def test_a_track_is_answered_with_the_dict_of_the_library(client: TestClient) -> None:
    fields = walk()
    answer = post(client, fields).json()
    track = clean_trajectory(fields["time"], fields["lat"], fields["lon"])
    assert isinstance(track, estimators.Track)
    assert answer == json.loads(dumps(track.to_dict()))
    TrackAnswer.model_validate(answer)
    assert answer["points"]["reason"][SPIKE] == "spike"


def test_the_same_request_gives_the_same_bytes(client: TestClient) -> None:
    assert post(client, two_walks()).content == post(client, two_walks()).content


def test_heights_and_accuracies_take_part(client: TestClient) -> None:
    height, accuracy = [100.0] * N, [5.0 + k % 3 for k in range(N)]
    fields = walk(height=height, accuracy=accuracy)
    track = clean_trajectory(
        fields["time"], fields["lat"], fields["lon"], height_m=height, accuracy_m=accuracy
    )
    assert isinstance(track, estimators.Track)
    assert post(client, fields).json() == json.loads(dumps(track.to_dict()))


def test_arguments_of_the_body_reach_the_library(client: TestClient) -> None:
    asked = {"method": "speed-gate", "level": 0.5, "sigma_m": 4.0, "max_speed_mps": 20.0}
    fields = walk()
    track = clean_trajectory(
        fields["time"],
        fields["lat"],
        fields["lon"],
        method="speed-gate",
        level=0.5,
        options=TrackOptions(sigma_m=4.0, max_speed_mps=20.0),
    )
    assert isinstance(track, estimators.Track)
    assert post(client, fields | asked).json() == json.loads(dumps(track.to_dict()))


def test_the_columns_per_fix_can_be_left_out(client: TestClient) -> None:
    answer = post(client, walk(), points=False).json()
    assert "points" not in answer
    assert answer["inliers"] == N - 1
    assert "row" not in post(client, two_walks(), points=False).json()["tracks"][0]


@pytest.mark.parametrize("zone", ["+02:00", "-09:30", "Z"])
def test_times_come_back_in_the_zone_in_which_they_came(client: TestClient, zone: str) -> None:
    times = clock(zone=zone)
    assert post(client, walk(time=times)).json()["points"]["time"] == times


def test_mixed_zones_are_one_time_line_and_each_is_kept(client: TestClient) -> None:
    times = [text if k % 2 else text.replace("T12", "T10") for k, text in enumerate(clock())]
    times = [text if k % 2 else text.replace("+02:00", "Z") for k, text in enumerate(times)]
    answer = post(client, walk(time=times)).json()
    assert answer["points"]["time"] == times
    plain = post(client, walk()).json()
    assert answer["points"]["lat_deg"] == pytest.approx(plain["points"]["lat_deg"], abs=1e-9)


@pytest.mark.parametrize(("unit", "factor"), [("s", 1), ("ms", 10**3), ("us", 10**6), ("ns", 10**9)])
def test_numbers_since_1970_come_back_as_such(client: TestClient, unit: str, factor: int) -> None:
    times = [(1_714_564_800 + k) * factor for k in range(N)]
    answer = post(client, walk(time=times, time_unit=unit)).json()
    assert answer["points"]["time"] == times
    assert answer["distance"] == post(client, walk(time=clock())).json()["distance"]


def test_milliseconds_since_1970_are_told_by_their_size(client: TestClient) -> None:
    times = [1_714_564_800_000 + 1_000 * k for k in range(N)]
    assert post(client, walk(time=times)).content == post(client, walk(time=times, time_unit="ms")).content


def test_every_device_has_a_track_in_order_of_first_appearance(client: TestClient) -> None:
    fields = two_walks()
    answer = post(client, fields).json()
    TracksAnswer.model_validate(answer)
    assert [item["device"] for item in answer["tracks"]] == ["van", "bus"]
    for k, item in enumerate(answer["tracks"]):
        rows = list(range(k, 2 * N, 2))
        assert item["row"] == rows
        alone = {name: [fields[name][row] for row in rows] for name in ("time", "lat", "lon")}
        assert item["track"] == post(client, alone).json()


def test_a_device_that_cannot_be_cleaned_has_its_reason_and_the_others_tracks(client: TestClient) -> None:
    fields = two_walks()
    for name, more in (("time", [7, 7]), ("lat", [1.0, 2.0]), ("lon", [3.0, 4.0]), ("device", ["x", "x"])):
        fields[name] += more
    answer = post(client, fields).json()
    TracksAnswer.model_validate(answer)
    assert [item["track"] is None for item in answer["tracks"]] == [False, False, True]
    assert answer["tracks"][2]["refusal"]["reason"] == "constant_time"
    assert answer["tracks"][2]["row"] == [2 * N, 2 * N + 1]


def test_a_column_of_one_device_makes_the_answer_one_of_many(client: TestClient) -> None:
    (only,) = post(client, walk(device=[7] * N)).json()["tracks"]
    assert (only["device"], only["track"]) == ("7", post(client, walk()).json())


def test_rows_without_a_name_are_a_device_too(client: TestClient) -> None:
    (only,) = post(client, walk(device=[None] * N)).json()["tracks"]
    assert only["device"] is None


def test_gpx_of_plain_numbers_is_refused_before_the_work(client: TestClient) -> None:
    refused(post(client, walk(), format="gpx"), ProblemType.invalid_value, "format")
    assert post(client, walk(time_unit="s"), format="gpx").status_code == 200


def test_the_phases_are_timed(client: TestClient) -> None:
    timing = post(client, walk()).headers["server-timing"]
    assert [part.partition(";")[0] for part in timing.split(", ")] == ["parse", "queue", "fit", "encode"]


def test_the_methods_listed_are_those_of_the_library(client: TestClient) -> None:
    listed = [row["name"] for row in client.get("/v1/trajectory-methods").json()["methods"]]
    assert listed == list(estimators.track_methods())
    for name in listed:
        assert post(client, walk(method=name)).json()["method"] == name
