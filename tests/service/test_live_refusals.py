"""What ``POST /v1/trajectories/live`` refuses, and that it tells nobody what was sent."""

from __future__ import annotations

import base64
import hashlib
import json
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from estimators import clean_live
from estimators.trajectories.live.token import LONGEST_TOKEN
from service.codecs.columns import TimeForm
from service.errors import Problem, ProblemType
from service.trajectories.live_state import LiveState, read_state, write_state
from tests.service.conftest import MakeClient
from tests.service.fixes import N, clock, walk
from tests.service.problems import refused

URL = "/v1/trajectories/live"
FIRST = clean_live(
    **{f"{name}": walk()[key] for name, key in (("t_s", "time"), ("lat_deg", "lat"), ("lon_deg", "lon"))}
)
TRACK = LiveState(FIRST.state, TimeForm("number"), np.zeros(len(FIRST.provisional), dtype=np.int16))
STATE = write_state(TRACK)


def post(client: TestClient, fields: dict[str, Any]) -> Any:
    return client.post(URL, json=fields)


def later() -> dict[str, Any]:
    """Rows that come after those of the state."""
    return {**walk(), "time": list(range(N, 2 * N))}


def test_a_state_is_read_as_it_was_written() -> None:
    state = LiveState("abc", TimeForm("epoch", "ms"), np.array([-570, 0, 840], dtype=np.int16))
    found = read_state(write_state(state))
    assert (found.track, found.form, found.waiting.tolist()) == ("abc", state.form, [-570, 0, 840])


@given(place=st.integers(0, len(STATE) - 1), letter=st.sampled_from("Ab9-_."))
@settings(max_examples=60, deadline=None)
def test_a_changed_character_is_refused(place: int, letter: str) -> None:
    assume(letter != STATE[place])
    with pytest.raises(Problem) as problem:
        read_state(STATE[:place] + letter + STATE[place + 1 :])
    assert problem.value.errors[0].field == "state"


@given(text=st.text(max_size=100) | st.integers(0, len(STATE) - 1).map(STATE.__getitem__))
def test_what_is_no_state_is_refused(text: str) -> None:
    with pytest.raises(Problem):
        read_state(text)


def test_a_damaged_state_is_a_problem_that_does_not_repeat_it(client: TestClient) -> None:
    response = post(client, later() | {"state": STATE[:-9] + "AAAAAAAAA"})
    problem = refused(response, ProblemType.invalid_value, "state")
    assert "is damaged; send back the state of the last answer" in problem["detail"]
    assert "AAAAAAAAA" not in response.text


def test_a_state_of_another_version_is_named_so(client: TestClient) -> None:
    response = post(client, later() | {"state": STATE.replace("plumbline.1.", "plumbline.2.", 1)})
    assert "another version" in refused(response, ProblemType.invalid_value, "state")["detail"]


def test_a_track_of_another_version_is_named_so(client: TestClient) -> None:
    content = bytearray(base64.urlsafe_b64decode(FIRST.state)[:-16])
    content[9] = 77
    digest = hashlib.blake2b(bytes(content), digest_size=16).digest()
    state = LiveState(base64.urlsafe_b64encode(content + digest).decode(), TRACK.form, TRACK.waiting)
    response = post(client, later() | {"state": write_state(state)})
    assert "version 77" in refused(response, ProblemType.invalid_value, "state")["detail"]


@pytest.mark.parametrize(
    "state",
    [
        LiveState("", TRACK.form, TRACK.waiting),
        LiveState(None, None),
        LiveState(FIRST.state, TRACK.form, TRACK.waiting[1:]),
        LiveState(FIRST.state, TimeForm("iso"), TRACK.waiting),
        LiveState(FIRST.state, TimeForm("epoch", "ms"), TRACK.waiting),
        LiveState(FIRST.state, TRACK.form, np.zeros(500, dtype=np.int16)),
        LiveState(FIRST.state, TRACK.form, np.full(500, 60, dtype=np.int16)),
        LiveState(FIRST.state, TRACK.form, np.full(TRACK.waiting.size, 30_000, dtype=np.int16)),
    ],
)
def test_a_forged_state_is_refused(client: TestClient, state: LiveState) -> None:
    refused(post(client, {"state": write_state(state), "finish": True}), ProblemType.invalid_value, "state")


@pytest.mark.parametrize("form", ["iso", "ms", "none", "week"])
def test_a_forged_form_of_times_is_refused_or_answered(client: TestClient, form: str) -> None:
    zones, track = str(TRACK.waiting.size), FIRST.state
    seal = hashlib.blake2b(f"{form}.{zones}.{track}".encode(), digest_size=12).digest()
    state = ".".join(["plumbline", "1", form, zones, base64.urlsafe_b64encode(seal).decode(), track])
    response = post(client, later() | {"state": state})
    assert response.status_code in (200, 422)
    assert form == "none" or response.status_code == 422


def test_a_state_that_is_too_long_is_refused(client: TestClient) -> None:
    refused(post(client, later() | {"state": "A" * (LONGEST_TOKEN + 1)}), ProblemType.invalid_value, "state")
    with pytest.raises(Problem, match="invalid-value"):
        read_state("A" * (LONGEST_TOKEN + 1))


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"lag": 16}, "lag"),
        ({"lag": 3}, "lag"),
        ({"lag": 129}, "lag"),
        ({"lag": 8.5}, "lag"),
        ({"finish": "yes"}, "finish"),
        ({"state": 5}, "state"),
        ({"sigma_m": 3.0}, "sigma_m"),
        ({"max_speed_mps": 30.0}, "max_speed_mps"),
        ({"time_unit": "ms"}, "time_unit"),
        ({"time": clock()}, "time"),
        ({"time": ["noon"] * N}, "time"),
        ({"time": [1e300 * k for k in range(N)]}, "time"),
        ({"time": []}, "time"),
        ({"lat": [48.0]}, "lat"),
        ({"lon": ["east"] * N}, "lon"),
        ({"height": [1.0]}, "height"),
        ({"accuracy": ["good"] * N}, "accuracy"),
        ({"lon": None}, "lon"),
    ],
)
def test_a_wrong_value_is_refused_by_its_name_on_the_wire(
    client: TestClient, change: dict[str, Any], field: str
) -> None:
    refused(post(client, later() | {"state": STATE} | change), ProblemType.invalid_value, field)


def test_the_unit_of_a_track_is_kept_and_another_refused(client: TestClient) -> None:
    times = [1_714_564_800_000 + 1000 * k for k in range(N)]
    state = post(client, walk(time=times)).json()["state"]
    rows = walk(time=[time + 1000 * N for time in times], state=state)
    assert post(client, rows | {"time_unit": "ms"}).content == post(client, rows).content
    problem = refused(post(client, rows | {"time_unit": "s"}), ProblemType.invalid_value, "time_unit")
    assert "the track so far has numbers since 1970 in 'ms'" in problem["detail"]


@pytest.mark.parametrize("fields", [{"lat": [], "lon": []}, {"state": STATE}, {"finish": True}, {}])
def test_a_call_needs_rows_or_a_track_to_finish(client: TestClient, fields: dict[str, Any]) -> None:
    refused(post(client, {"time": [], "lat": [], "lon": []} | fields), ProblemType.invalid_value, "time")


def test_a_column_of_devices_is_refused_with_a_hint(client: TestClient) -> None:
    problem = refused(post(client, walk(device=["a", "b"] * (N // 2))), ProblemType.invalid_value, "device")
    assert "send the rows of each in calls of their own" in problem["detail"]


def test_a_column_that_would_be_ignored_is_refused(client: TestClient) -> None:
    refused(post(client, walk(speed=[1.0] * N)), ProblemType.unknown_field, "speed")


@pytest.mark.parametrize("name", ["time", "lat", "lon", "accuracy"])
def test_nan_in_json_is_refused_with_its_row(client: TestClient, name: str) -> None:
    fields = walk(accuracy=[1.0] * N)
    fields[name][2] = float("nan")
    response = client.post(URL, content=json.dumps(fields), headers={"content-type": "application/json"})
    assert refused(response, ProblemType.invalid_value, name)["row"] == 2


def test_only_json_is_taken_and_given(client: TestClient) -> None:
    response = client.post(URL, content=b"time,lat,lon\n0,1,2\n", headers={"content-type": "text/csv"})
    assert response.status_code == 415
    assert client.post(URL, json=walk(), headers={"accept": "text/csv"}).status_code == 406
    refused(client.post(URL, json=walk(), params={"lag": 8}), ProblemType.unknown_field, "lag")


def test_more_rows_than_the_limit_are_refused(client: TestClient) -> None:
    fields = {name: [1.0] * 5001 for name in ("time", "lat", "lon")}
    assert refused(post(client, fields), ProblemType.too_many_points, None)["limit"] == 5000


def test_cleaning_past_the_deadline_is_a_problem(make_client: MakeClient) -> None:
    response = post(make_client(deadline_seconds=0.05), walk(3_000))
    refused(response, ProblemType.deadline_exceeded, None)


def test_no_log_holds_a_state(capsys: pytest.CaptureFixture[str], make_client: MakeClient) -> None:
    client = make_client(log_level="debug")
    answer = post(client, later() | {"state": STATE}).json()
    post(client, later() | {"state": STATE[:-1]})
    logged = capsys.readouterr().err
    assert '"status": 200' in logged
    assert '"status": 422' in logged
    for state in (STATE, answer["state"]):
        for piece in (state[:60], state[-60:]):
            assert piece not in logged


@given(
    fields=st.fixed_dictionaries(
        {"time": st.lists(st.none() | st.floats(allow_nan=False, allow_infinity=False), max_size=6)},
        optional={
            "finish": st.booleans(),
            "state": st.just(STATE) | st.text(max_size=20),
            "lag": st.integers(),
        },
    )
)
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_whatever_is_sent_the_answer_is_rows_or_a_problem(client: TestClient, fields: dict[str, Any]) -> None:
    rows = len(fields["time"])
    response = post(client, {**fields, "lat": [48.0] * rows, "lon": [11.0] * rows})
    if response.status_code != 200:
        assert response.status_code in (400, 422)
        assert response.json()["field"] in ("time", "state", "lag")
