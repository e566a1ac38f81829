"""``POST /v1/trajectories/live``: a track in pieces, with nothing kept on the server."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import httpx2
import numpy as np
import pytest
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from estimators import clean_live
from estimators.trajectories.live.token import LONGEST_TOKEN
from service.schemas.live_tracks import LiveAnswer
from tests.service.fixes import SPIKE, clock, walk
from tests.service.server import Server, serve

URL = "/v1/trajectories/live"
ROWS = 110


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with serve() as running:
        yield running


def zoned() -> dict[str, Any]:
    """A walk across a change of the clocks, some times with fractions, one missing, one late."""
    times: list[Any] = clock(ROWS)
    times[40:] = [text.replace("T12", "T13").replace("+02:00", "+03:00") for text in times[40:]]
    times[20] = times[20].replace("+02:00", ".25+02:00")
    times[60] = times[60].replace("+03:00", ".123456789+03:00")
    times[90] = times[90].replace("T13", "T10").replace("+03:00", "Z")
    times[5] = None
    fields = walk(ROWS, time=times, accuracy=[4.0 + k % 3 for k in range(ROWS)])
    for column in fields.values():
        column[50], column[57] = column[57], column[50]
    return fields


def epoch() -> dict[str, Any]:
    """A walk with seconds since 1970, not all of them whole."""
    return walk(
        ROWS, time=[1_714_564_800 + k + (0.5 if k % 7 == 3 else 0) for k in range(ROWS)], time_unit="s"
    )


def part(fields: dict[str, Any], first: int, last: int) -> dict[str, Any]:
    return {name: value[first:last] if isinstance(value, list) else value for name, value in fields.items()}


def ask(client: TestClient, fields: dict[str, Any]) -> dict[str, Any]:
    """Answer with every number as the text that was sent."""
    response = client.post(URL, json=fields)
    assert response.status_code == 200, response.text
    LiveAnswer.model_validate(response.json())
    answer: dict[str, Any] = json.loads(response.content, parse_float=str, parse_int=str)
    return answer


def send_in(client: TestClient, fields: dict[str, Any], cuts: Sequence[int]) -> dict[str, list[Any]]:
    """All settled rows of a track that is sent in pieces; the last ones by finishing."""
    settled: dict[str, list[Any]] = {}
    state: dict[str, Any] = {}
    for first, last in pairwise(sorted({0, *cuts, ROWS})):
        answer = ask(client, part(fields, first, last) | state)
        settled = {name: settled.get(name, []) + column for name, column in answer["settled"].items()}
        state = {"state": answer["state"]}
    answer = ask(client, state | {"finish": True})
    assert answer["provisional"]["row"] == []
    return {name: settled[name] + column for name, column in answer["settled"].items()}


@given(cuts=st.lists(st.integers(1, ROWS - 1), max_size=8))
@settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@pytest.mark.parametrize("fields", [walk(ROWS), zoned(), epoch()], ids=["numbers", "zones", "epoch"])
def test_settled_rows_are_the_same_text_however_they_are_cut(
    client: TestClient, fields: dict[str, Any], cuts: list[int]
) -> None:
    assert send_in(client, fields, cuts) == send_in(client, fields, [])


def test_a_server_settles_every_row_once_as_the_library_does(server: Server) -> None:
    fields = walk(ROWS)
    state: dict[str, Any] = {}
    rows: list[int] = []
    found: list[float] = []
    for first, last in ((0, 17), (17, 70), (70, ROWS)):
        body = part(fields, first, last) | state | {"lag": 16, "finish": last == ROWS}
        answer = httpx2.post(server.url + URL, json=body, timeout=60).json()
        rows += answer["settled"]["row"]
        found += answer["settled"]["lat_deg"]
        state = {"state": answer["state"]}
    whole = clean_live(fields["time"], fields["lat"], fields["lon"], lag=16, finish=True)
    assert rows == list(range(ROWS))
    assert found == whole.settled.lat_deg.tolist()
    assert not whole.settled.inlier[SPIKE]


def test_an_answer_is_that_of_the_library_with_another_state(client: TestClient) -> None:
    fields = walk(ROWS, height=[500.0] * ROWS, accuracy=[5.0 + k % 3 for k in range(ROWS)])
    answer = client.post(URL, json=fields | {"lag": 24, "max_speed_mps": 40.0}).json()
    expected = clean_live(
        fields["time"],
        fields["lat"],
        fields["lon"],
        height_m=fields["height"],
        accuracy_m=fields["accuracy"],
        lag=24,
    ).to_dict()
    assert {**answer, "state": ""} == {**expected, "state": ""}


def test_a_given_noise_reaches_the_library(client: TestClient) -> None:
    noise = client.post(URL, json=walk(ROWS, sigma_m=7.0)).json()["noise"]
    assert (noise["sigma_m"], noise["source"]) == (pytest.approx(7.0), "given")


def test_the_same_call_gives_the_same_bytes(client: TestClient) -> None:
    assert client.post(URL, json=zoned()).content == client.post(URL, json=zoned()).content


def test_times_come_back_as_they_came_in_settled_and_provisional_rows(client: TestClient) -> None:
    fields = zoned()
    answer = client.post(URL, json=fields).json()
    for name in ("settled", "provisional"):
        rows = answer[name]
        assert rows["row"]
        came = [fields["time"][row] for row in rows["row"]]
        # Fractions come back in thousands.
        assert rows["time"] == [text and text.replace(".25+", ".250+") for text in came]


@pytest.mark.parametrize(("unit", "factor"), [("s", 1), ("ms", 10**3), ("us", 10**6), ("ns", 10**9)])
def test_numbers_since_1970_stay_what_they_are_in_later_calls(
    client: TestClient, unit: str, factor: int
) -> None:
    times = [(1_714_564_800 + k) * factor for k in range(ROWS)]
    fields = walk(ROWS, time=times)
    first = client.post(URL, json=part(fields, 0, 40) | {"time_unit": unit}).json()
    second = client.post(URL, json=part(fields, 40, ROWS) | {"state": first["state"], "finish": True}).json()
    assert first["settled"]["time"] + second["settled"]["time"] == times


def test_the_form_of_times_is_that_of_the_first_row_with_one(client: TestClient) -> None:
    fields = zoned()
    empty = {**part(fields, 0, 3), "time": [None] * 3}
    first = client.post(URL, json=empty).json()
    assert first["settled"]["reason"] == ["invalid"] * 3
    assert first["settled"]["time"] == [None] * 3
    second = client.post(URL, json=part(fields, 0, 20) | {"state": first["state"], "finish": True}).json()
    assert second["settled"]["row"][:2] == [8, 3]
    assert second["settled"]["time"][1] == fields["time"][0]


def test_rows_without_any_time_may_come_between(client: TestClient) -> None:
    first = client.post(URL, json=part(zoned(), 0, 20)).json()
    gap = {"time": [None], "lat": [48.0], "lon": [11.0], "state": first["state"]}
    answer = client.post(URL, json=gap).json()
    assert (answer["settled"]["reason"], answer["settled"]["time"]) == (["invalid"], [None])


def test_many_rows_without_a_time_before_the_first_are_settled_along(client: TestClient) -> None:
    fields = walk(700, time=[None] * 600 + clock(100))
    answer = client.post(URL, json=fields | {"finish": True}).json()
    LiveAnswer.model_validate(answer)
    assert answer["settled"]["time"] == fields["time"]


def test_no_more_rows_than_the_lag_wait(client: TestClient) -> None:
    answer = client.post(URL, json=walk(ROWS, lag=4)).json()
    assert 1 <= len(answer["provisional"]["row"]) <= 4


def test_a_track_goes_on_after_it_was_finished(client: TestClient) -> None:
    fields = walk(ROWS)
    first = client.post(URL, json=part(fields, 0, 60) | {"finish": True}).json()
    second = client.post(URL, json=part(fields, 60, ROWS) | {"state": first["state"], "finish": True}).json()
    assert second["settled"]["row"] == list(range(60, ROWS))


@pytest.mark.parametrize("zone", ["Z", "+05:30"])
def test_a_state_stays_within_its_size(client: TestClient, zone: str) -> None:
    times = [text for hour in range(12) for text in clock(60, zone)]
    times = [text.replace("T12:00", f"T12:{k // 60:02d}") for k, text in enumerate(times)]
    answer = client.post(URL, json=walk(720, time=times, lag=128)).json()
    assert 20_000 < len(answer["state"]) <= LONGEST_TOKEN


def test_whatever_the_numbers_nothing_on_the_wire_is_no_number(client: TestClient) -> None:
    random = np.random.default_rng(2)
    fields = {
        "time": [None if k % 5 == 1 else float(t) for k, t in enumerate(random.normal(0, 1e6, 80))],
        "lat": [None if k % 7 == 2 else float(x) for k, x in enumerate(random.uniform(-120, 120, 80))],
        "lon": [float(x) for x in random.uniform(-400, 400, 80)],
        "accuracy": [float(x) for x in random.normal(0, 1e3, 80)],
        "height": [float(x) for x in random.normal(0, 1e6, 80)],
    }
    response = client.post(URL, json=fields | {"finish": True})
    answer = response.json()
    LiveAnswer.model_validate(answer)
    assert sorted(answer["settled"]["row"]) == list(range(80))
    assert b"NaN" not in response.content
