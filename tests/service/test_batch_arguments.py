"""What a fit can be asked, asked of a batch: every argument, and the columns that answer it."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from estimators import RobustOptions, Trend, fit_trend
from service.schemas.batch import BatchAnswer, BatchQuery
from service.schemas.options import FitArguments, TrendOptions
from tests.service.series import JSON
from tests.service.tables import ENDPOINT

ROWS = np.arange(60.0)
NOISE = np.random.default_rng(3).normal(size=60)
SHAPES: dict[str, np.ndarray] = {
    "line": 5.0 + 0.5 * ROWS + NOISE,
    "growth": np.exp(0.1 * ROWS + 0.05 * NOISE),
    "season": 0.2 * ROWS + 4.0 * np.sin(2.0 * np.pi * ROWS / 12.0) + 0.3 * NOISE,
    "bent": np.where(ROWS < 30, ROWS, 60.0 - ROWS) + 0.5 * NOISE,
}


def body(names: tuple[str, ...], times: Callable[[int], Any] = float, **fields: object) -> bytes:
    table = {
        "series": [name for name in names for _ in ROWS],
        "time": [times(row) for _ in names for row in range(ROWS.size)],
        "value": [float(value) for name in names for value in SHAPES[name]],
    }
    return json.dumps(table | fields).encode()


def ask(client: TestClient, query: str, content: bytes) -> dict[str, list[Any]]:
    response = client.post(ENDPOINT + query, content=content, headers=JSON)
    assert response.status_code == 200, response.text
    BatchAnswer.model_validate_json(response.content, strict=True)
    columns: dict[str, list[Any]] = response.json()["columns"]
    return columns


def test_the_query_offers_every_argument_and_option() -> None:
    offered = {field.alias or name for name, field in BatchQuery.model_fields.items()}
    options = {f"options.{name}" for name in TrendOptions.model_fields}
    assert (set(FitArguments.model_fields) - {"options"}) | options | {"horizon"} <= offered


@pytest.mark.parametrize(
    ("name", "query", "arguments"),
    [
        ("growth", "model=exponential&noise=additive", {"model": "exponential", "noise": "additive"}),
        ("season", "seasonal=12&harmonics=1", {"seasonal": [12.0], "harmonics": 1}),
        ("season", "model=constant&seasonal=auto", {"model": "constant", "seasonal": "auto"}),
        ("bent", "model=linear&degree=4", {"model": "linear", "degree": 4}),
        ("bent", "regime=last", {"regime": "last"}),
        ("line", "uncertainty=hac", {"uncertainty": "hac"}),
        (
            "line",
            "uncertainty=bootstrap&options.resamples=99",
            {"uncertainty": "bootstrap", "options": RobustOptions(resamples=99)},
        ),
        ("growth", "model=auto", {"model": "auto"}),
    ],
)
def test_a_row_is_the_trend_of_the_series_alone(
    client: TestClient, name: str, query: str, arguments: dict[str, Any]
) -> None:
    columns = ask(client, f"?{query}", body((name,)))
    trend = fit_trend(ROWS, SHAPES[name], **arguments)
    assert isinstance(trend, Trend)
    assert columns["model"] == [trend.model]
    assert columns["p_value"] == [trend.p_value]
    for parameter, estimate in trend.parameters.items():
        for part, title in (("value", ""), ("stderr", "_stderr"), ("low", "_low"), ("high", "_high")):
            assert columns[parameter + title] == [getattr(estimate, part)]


def test_with_auto_each_row_tells_its_shape_and_has_the_parameters_of_that_shape_alone(
    client: TestClient,
) -> None:
    columns = ask(client, "?model=auto", body(("line", "growth")))
    assert columns["model"] == ["line", "exponential"]
    assert [value is None for value in columns["slope"]] == [False, True]
    assert [value is None for value in columns["rate"]] == [True, False]
    assert columns["noise"] == [None, "multiplicative"]


def test_the_present_regime_has_its_start_in_the_row(client: TestClient) -> None:
    columns = ask(client, "?regime=last", body(("bent", "line")))
    trend = fit_trend(ROWS, SHAPES["bent"], regime="last")
    assert isinstance(trend, Trend)
    assert columns["regimes"] == [len(trend.regimes), 1]
    assert columns["regime_start"] == [trend.regimes[-1].start, 0.0]
    assert trend.regimes[-1].start > 0


def test_values_to_reach_are_answered_in_the_row(client: TestClient) -> None:
    columns = ask(client, "?reach=90,0&horizon=200", body(("line",)))
    trend = fit_trend(ROWS, SHAPES["line"], reach=[90.0, 0.0], horizon=200.0)
    assert isinstance(trend, Trend)
    for place, crossing in enumerate(trend.crossings, start=1):
        for part in ("value", "direction", "status", "time", "low", "high"):
            assert columns[f"crossing_{place}_{part}"] == [getattr(crossing, part)]
        assert columns[f"crossing_{place}_probability"] == [crossing.probability]
    assert columns["crossing_1_status"] == ["crosses"]


@pytest.mark.parametrize(
    ("times", "query", "crossed"),
    [
        (lambda row: f"2024-01-01T{row // 60:02d}:{row % 60:02d}:00Z", "", "2024-01-01T02:"),
        (lambda row: 1_704_067_200 + 60 * row, "&time_unit=s", "17040"),
    ],
)
def test_a_crossing_is_told_in_the_form_of_the_times(
    client: TestClient, times: Callable[[int], Any], query: str, crossed: str
) -> None:
    columns = ask(client, f"?reach=80{query}", body(("line",), times))
    assert str(columns["crossing_1_time"][0]).startswith(crossed)


def test_a_series_that_a_question_does_not_suit_has_the_reason_and_the_others_are_answered(
    client: TestClient,
) -> None:
    short = {"series": "short", "time": 0.0, "value": 1.0}
    table = json.loads(body(("season",)))
    for step in range(8):
        for key, value in short.items():
            table[key].append(value if key == "series" else value + step)
    content = json.dumps(table).encode()
    columns = ask(client, "?seasonal=12", content)
    assert columns["fitted"] == [True, False]
    assert columns["reason"] == [None, "invalid_input"]
    assert columns["message"][1].startswith("seasonal: a period of 12 is longer than the series")
    columns = ask(client, "?reach=90&horizon=20", content)
    assert columns["fitted"] == [False, True]
    assert columns["message"][0] == "horizon: must not lie before the last time of the data"


@pytest.mark.parametrize(
    ("query", "field"),
    [
        ("?reach=5&horizon=2020-01-01", "horizon"),
        ("?horizon=5", "horizon"),
        ("?reach=x", "reach"),
        ("?seasonal=fortnight", "seasonal"),
        ("?harmonics=2", "harmonics"),
        ("?degree=2", "degree"),
        ("?options.resamples=1", "options.resamples"),
        ("?uncertainty=certain", "uncertainty"),
    ],
)
def test_a_question_that_makes_no_sense_is_refused_by_its_name(
    client: TestClient, query: str, field: str
) -> None:
    response = client.post(ENDPOINT + query, content=body(("line",)), headers=JSON)
    assert response.status_code == 422
    assert [error["field"] for error in response.json()["errors"]] == [field]


def test_every_slice_of_a_batch_has_the_same_columns(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.batches.SLICE_ROWS", 60)
    query = "?model=auto&seasonal=auto&reach=1&regime=last&format=ndjson"
    content = body(("line", "season", "growth"))
    lines = client.post(ENDPOINT + query, content=content, headers=JSON).text.splitlines()
    keys = [list(json.loads(line)) for line in lines]
    assert len(keys) == 3
    assert keys[0] == keys[1] == keys[2]
    assert {"season_3_peak", "rate", "power_2", "crossing_1_low", "regimes", "noise"} <= set(keys[0])
