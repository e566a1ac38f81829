"""Pseudoranges as measured, corrected by the service, and range rates of moving receivers."""

from __future__ import annotations

import csv
import datetime as dt
import gzip
import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from estimators.geodesy.ellipsoid import to_cartesian
from estimators.gnss.snapshot.linearise import SPEED_OF_LIGHT
from service.errors import ProblemType
from service.schemas.fixes import PositionAnswer, PositionsAnswer
from tests.gnss.recorded import read_recorded
from tests.service.ranges import HERE, NAMES, as_csv, epoch, epochs

CLOCKS_S = np.linspace(-3e-4, 3e-4, 9)
DELAYS_S = np.linspace(-1e-8, 1e-8, 9)
COEFFICIENTS = {
    "klobuchar_alpha": [1.1e-08, 1.5e-08, -6.0e-08, -1.2e-07],
    "klobuchar_beta": [9.0e04, 1.3e05, -6.6e04, -5.2e05],
}


def raw(count: int = 1, **fields: Any) -> dict[str, Any]:
    """Epochs whose satellite clocks and group delays are still in the ranges."""
    columns = epoch(0.0) if count == 1 else epochs(count)
    shift = SPEED_OF_LIGHT * np.tile(CLOCKS_S - DELAYS_S, count)
    return {
        **columns,
        "pseudorange_m": (np.array(columns["pseudorange_m"]) - shift).tolist(),
        "satellite_clock_s": np.tile(CLOCKS_S, count).tolist(),
        "group_delay_s": np.tile(DELAYS_S, count).tolist(),
        "raw": True,
        "troposphere": False,
        "options": {"elevation_mask_deg": -5.0},
        **fields,
    }


def post(client: TestClient, fields: dict[str, Any], **params: Any) -> Any:
    return client.post("/v1/positions", json=fields, params=params)


def answered(client: TestClient, fields: dict[str, Any]) -> dict[str, Any]:
    response = post(client, fields)
    assert response.status_code == 200, response.text
    answer: dict[str, Any] = response.json()
    (PositionsAnswer if "fixes" in answer else PositionAnswer).model_validate(answer)
    return answer


def refused(response: Any, field: str) -> str:
    problem = response.json()
    assert response.status_code == 422, problem
    assert response.headers["content-type"] == "application/problem+json"
    assert (problem["type"], problem["field"]) == (ProblemType.invalid_value.uri, field)
    detail: str = problem["detail"]
    return detail


def test_satellite_clocks_and_group_delays_are_removed(client: TestClient) -> None:
    answer = answered(client, raw())
    assert np.linalg.norm(np.array(answer["position"]["ecef_m"]) - HERE) < 10.0
    assert answer["satellites"]["row"] == list(range(9))
    assert answer["left_out"] == {"row": [], "satellite": [], "reason": []}


def test_many_epochs_are_corrected_each(client: TestClient) -> None:
    answer = answered(client, raw(3))
    positions = np.array(answer["fixes"]["position_ecef_m"])
    assert np.linalg.norm(positions - HERE, axis=1).max() < 10.0
    assert answer["fixes"]["time"] == [0.0, 30.0, 60.0]


def test_the_troposphere_is_removed_unless_it_shall_stay(client: TestClient) -> None:
    kept = answered(client, raw())
    removed = answered(client, raw(troposphere=True))
    # Low satellites lose most, which brings the position down.
    assert 3.0 < kept["position"]["height_m"] - removed["position"]["height_m"] < 20.0


def test_ranges_below_the_mask_are_left_out_with_the_reason(client: TestClient) -> None:
    answer = answered(client, raw(options={"elevation_mask_deg": 30.0}))
    assert answer["left_out"]["row"] != []
    assert set(answer["left_out"]["reason"]) == {"masked"}
    rows = answer["left_out"]["row"] + answer["satellites"]["row"]
    assert sorted(rows) == list(range(9))
    assert [NAMES[row] for row in answer["satellites"]["row"]] == answer["satellites"]["satellite"]


def test_rows_of_mixed_epochs_are_told_by_their_own_numbers(client: TestClient) -> None:
    fields = raw(3)
    order = np.random.default_rng(5).permutation(27)
    mixed = {
        name: [column[row] for row in order] if name != "options" and isinstance(column, list) else column
        for name, column in fields.items()
    }
    mixed["pseudorange_m"][4] = None
    answer = answered(client, mixed)
    assert answer["left_out"] == {"row": [4], "satellite": [mixed["satellite"][4]], "reason": ["missing"]}
    assert answer["satellites"]["row"] == [row for row in range(27) if row != 4]
    times = [answer["fixes"]["time"][k] for k in answer["satellites"]["epoch"]]
    assert times == [time for row, time in enumerate(mixed["time"]) if row != 4]


def test_the_ionosphere_is_removed_by_its_coefficients(client: TestClient) -> None:
    times = {"time": ["2024-05-01T12:00:00Z"] * 9}
    without = answered(client, raw(**times))["fixes"]
    corrected = answered(client, raw(**times, **COEFFICIENTS))["fixes"]
    assert corrected["time"] == without["time"] == ["2024-05-01T12:00:00Z"]
    assert 1.0 < without["height_m"][0] - corrected["height_m"][0] < 20.0


def test_csv_is_answered_as_json_is(client: TestClient) -> None:
    fields = raw(time=["2024-05-01T12:00:00Z"] * 9)
    columns = {name: column for name, column in fields.items() if name != "options"}
    params = {
        "rotated": True, "raw": True, "troposphere": False, "options.elevation_mask_deg": -5,
        "klobuchar_alpha": ",".join(map(str, COEFFICIENTS["klobuchar_alpha"])),
        "klobuchar_beta": COEFFICIENTS["klobuchar_beta"],
    }  # fmt: skip
    sent = client.post(
        "/v1/positions", content=as_csv(columns), params=params, headers={"content-type": "text/csv"}
    )
    assert sent.status_code == 200, sent.text
    assert sent.json() == answered(client, fields | COEFFICIENTS)


def test_recorded_ranges_of_a_station_are_corrected_to_metres(client: TestClient, gnss_data: Path) -> None:
    packed = gnss_data / "esbc_2020_177" / "corrected_pseudoranges_240ep.csv.gz"
    rows = [
        row
        for row in csv.DictReader(io.StringIO(gzip.decompress(packed.read_bytes()).decode()))
        if row["epoch"] == "0" and row["sat"][0] == "G"
    ]
    fields = {name: [float(row[name]) for row in rows] for name in ("x_m", "y_m", "z_m")}
    clocks = [float(row["sat_clk_m"]) / SPEED_OF_LIGHT for row in rows]
    measured = [float(row["raw_pr_m"]) for row in rows]
    names = [row["sat"] for row in rows]
    sent = fields | {
        "pseudorange_m": measured, "satellite_clock_s": clocks, "satellite": names,
        "raw": True, "rotated": True,
    }  # fmt: skip
    found = np.array(answered(client, sent)["position"]["ecef_m"])
    assert np.linalg.norm(found - read_recorded(gnss_data, "esbc").truth) < 8.0


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"raw": False}, "satellite_clock_s"),
        ({"satellite_clock_s": [300.0] * 9}, "satellite_clock_s"),
        ({"frequency_hz": [1575.42] * 9}, "frequency_hz"),
        ({"second_m": [2e7] * 9}, "second_hz"),
        ({"klobuchar_alpha": [1e-8] * 4}, "klobuchar_beta"),
        ({"klobuchar_alpha": [1e-8] * 3, "klobuchar_beta": [9e4] * 4}, "klobuchar_alpha"),
        (COEFFICIENTS, "time"),
        (COEFFICIENTS | {"time": [0.0] * 9}, "time"),
        ({"group_delay_s": [0.0] * 8}, "group_delay_s"),
    ],
)
def test_what_raw_ranges_cannot_be_is_refused(client: TestClient, change: dict[str, Any], field: str) -> None:
    refused(post(client, raw(**change)), field)


def test_arguments_of_raw_ranges_are_refused_of_corrected_ones(client: TestClient) -> None:
    refused(post(client, epoch(troposphere=False)), "troposphere")
    refused(post(client, epoch(weights="strength")), "weights")


def test_ranges_that_are_all_masked_are_no_position(client: TestClient) -> None:
    for fields in (raw(), raw(2)):
        response = post(client, fields | {"options": {"elevation_mask_deg": 89.0}})
        problem = response.json()
        assert (response.status_code, problem["type"]) == (422, ProblemType.no_position.uri), problem
        assert problem["reason"] == "too_few_satellites"


@pytest.mark.parametrize("method", ["auto", "raim"])
def test_an_epoch_that_loses_all_its_ranges_keeps_its_place(client: TestClient, method: str) -> None:
    fields = raw(3, method=method)
    fields["pseudorange_m"][9:18] = [None] * 9
    answer = answered(client, fields)
    assert answer["fixes"]["time"] == [0.0, 30.0, 60.0]
    assert (answer["fixes"]["status"][0], answer["fixes"]["status"][2]) == ("solved", "solved")
    assert answer["left_out"]["row"] == list(range(9, 18))
    assert set(answer["satellites"]["epoch"]) == {0, 2}


NUMBERS = st.one_of(
    st.none(),
    st.floats(allow_nan=False, allow_infinity=False),
    st.floats(-3e7, 3e7),
    st.sampled_from([0.0, 1e-12, 1.57542e9]),
)
COLUMNS = (
    "x_m", "y_m", "z_m", "pseudorange_m", "sigma_m", "cn0_dbhz", "range_rate_mps", "vx_mps", "vy_mps",
    "vz_mps", "satellite_clock_s", "group_delay_s", "clock_drift", "accuracy_m", "frequency_hz", "second_m",
    "second_hz",
)  # fmt: skip
MOMENTS = st.datetimes(dt.datetime(1678, 1, 1), dt.datetime(2261, 1, 1)).map(
    lambda when: f"{when.isoformat()}Z"
)


@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_whatever_the_numbers_are_there_is_an_answer_or_a_problem(client: TestClient, data: Any) -> None:
    times = {"time": [data.draw(MOMENTS)] * 9 + [data.draw(MOMENTS)] * 9}
    fields, names = (raw(2), COLUMNS) if data.draw(st.booleans()) else (epochs(2), COLUMNS[:10])
    fields |= times
    if names == COLUMNS and data.draw(st.booleans()):
        fields |= COEFFICIENTS
    for name in data.draw(st.sets(st.sampled_from(names), max_size=3)):
        column = fields.get(name) or [data.draw(NUMBERS)] * 18
        for row in data.draw(st.sets(st.integers(0, 17), min_size=1, max_size=3)):
            column[row] = data.draw(NUMBERS)
        fields[name] = column
    response = post(client, fields)
    assert response.status_code in (200, 422), response.text
    if response.status_code == 200:
        PositionsAnswer.model_validate(response.json())
    else:
        assert response.json()["field"] in {*COLUMNS, "time", "satellite"}


def driving(count: int = 12, speed: float = 10.0) -> dict[str, Any]:
    """A receiver that drives east past standing satellites, with its Doppler."""
    parts = []
    north = to_cartesian(np.array([90.0, 0.0, 0.0]))
    east = np.cross(north, HERE)
    east /= np.linalg.norm(east)
    for k in range(count):
        part = epoch(0.0, seed=k)
        satellites = np.column_stack([part["x_m"], part["y_m"], part["z_m"]])
        here = HERE + east * speed * k
        ranges = np.linalg.norm(satellites - here, axis=1)
        sight = (satellites - here) / ranges[:, None]
        noise = np.array(part["pseudorange_m"]) - np.linalg.norm(satellites - HERE, axis=1)
        part["pseudorange_m"] = (ranges + noise).tolist()
        part["range_rate_mps"] = (-sight @ east * speed).tolist()
        part |= {name: [0.0] * 9 for name in ("vx_mps", "vy_mps", "vz_mps")}
        part["time"] = [float(k)] * 9
        parts.append(part)
    joined = {name: [item for part in parts for item in part[name]] for name in parts[0] if name != "rotated"}
    return {**joined, "rotated": True, "motion": "moving", "surroundings": "open"}


def test_range_rates_tell_the_velocity(client: TestClient) -> None:
    fields = driving()
    velocity = np.array(answered(client, fields)["fixes"]["velocity_enu_mps"])
    assert np.abs(velocity[:, :2] - [10.0, 0.0]).max() < 0.3
    doppler = ("range_rate_mps", "vx_mps", "vy_mps", "vz_mps")
    blind = {name: column for name, column in fields.items() if name not in doppler}
    without = np.array(answered(client, blind)["fixes"]["velocity_enu_mps"])
    assert np.abs(without[:, :2] - [10.0, 0.0]).max() > np.abs(velocity[:, :2] - [10.0, 0.0]).max()


@pytest.mark.parametrize(
    ("leave_out", "field"),
    [
        (("time",), "range_rate_mps"),
        (("vx_mps", "vy_mps", "vz_mps"), "range_rate_mps"),
        (("vz_mps",), "vx_mps"),
    ],
)
def test_range_rates_without_what_they_need_are_refused(
    client: TestClient, leave_out: tuple[str, ...], field: str
) -> None:
    fields = {name: column for name, column in driving(3).items() if name not in leave_out}
    if "time" in leave_out:
        fields = {name: column for name, column in fields.items() if name not in ("motion", "surroundings")}
        fields["satellite"] = [f"{name}-{k}" for k, name in enumerate(fields["satellite"])]
    refused(post(client, fields), field)
