"""Exponentials on the wire and on the command line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from fastapi.testclient import TestClient
from typer.testing import CliRunner

from estimators import fit_trend
from service.cli import app
from service.schemas.answers import TrendAnswer
from tests.trends.growing import growing


def post(client: TestClient, fields: dict[str, Any], query: str = "") -> Any:
    return client.post(f"/v1/trends{query}", json=fields)


def body(noise: str = "multiplicative", **fields: Any) -> dict[str, Any]:
    t, y, _ = growing(noise, n=60)
    return {"time": t.tolist(), "value": y.tolist(), "model": "exponential", **fields}


def nearly_level(**fields: Any) -> dict[str, Any]:
    t = np.arange(60)
    y = 100.0 * np.exp(0.001 * t) + np.random.default_rng(3).normal(size=60)
    return {"time": t.tolist(), "value": y.tolist(), "model": "exponential", **fields}


def test_the_answer_is_the_dict_of_the_library_and_fits_the_schema(client: TestClient) -> None:
    fields = body()
    answer = post(client, fields).json()
    trend = fit_trend(fields["time"], fields["value"], model="exponential")
    assert answer == json.loads(json.dumps(trend.to_dict()))
    TrendAnswer.model_validate(answer, strict=False)
    assert answer["noise"]["domain"] == "multiplicative"
    assert answer["derived"]["doubling_time"]["value"] > 0.0


def test_a_line_says_nothing_of_noise_domains(client: TestClient) -> None:
    answer = post(client, body(model="line")).json()
    assert {"noise", "derived", "alternative"}.isdisjoint(answer)


def test_the_noise_can_be_asked_for(client: TestClient) -> None:
    assert post(client, body()).json()["noise"]["selection"] == "selected"
    asked = post(client, {**body(), "noise": "additive"}).json()
    assert asked["noise"] == {"domain": "additive", "selection": "given", "margin": None}


def test_both_answers_of_an_undetermined_noise_keep_the_form_of_the_times(client: TestClient) -> None:
    fields = nearly_level(time_unit="s", predict=[100])
    answer = post(client, fields).json()
    other = answer["alternative"]
    TrendAnswer.model_validate(answer, strict=False)
    assert answer["noise"]["selection"] == "undetermined"
    assert other["origin"] == answer["origin"] == 0
    assert other["prediction"]["time"] == [100]


def test_contradictory_arguments_are_a_422_that_names_the_field(client: TestClient) -> None:
    response = post(client, body(threshold=1.0))
    assert response.status_code == 422
    assert response.json()["errors"][0]["field"] == "threshold"


def test_a_series_of_zeros_is_a_422_with_its_reason(client: TestClient) -> None:
    response = post(client, {"time": [0, 1, 2], "value": [0, 0, 0], "model": "exponential"})
    assert response.status_code == 422
    assert response.json()["reason"] == "no_consensus"


def test_csv_carries_the_noise_in_the_query_and_the_labels_in_the_rows(client: TestClient) -> None:
    t, y, _ = growing("multiplicative", n=60)
    y[4] = -1.0
    table = "time,value\n" + "".join(f"{a},{b}\n" for a, b in zip(t, y, strict=True))
    response = client.post(
        "/v1/trends?model=exponential&noise=multiplicative&format=csv",
        content=table,
        headers={"Content-Type": "text/csv"},
    )
    assert response.status_code == 200, response.text
    assert response.text.splitlines()[5].endswith(",invalid")


def test_a_picture_is_drawn_with_the_rate_in_its_title(client: TestClient) -> None:
    response = post(client, body(), "?format=svg")
    assert response.status_code == 200
    assert "Rate 0.0" in response.text


def test_the_command_line_takes_the_noise_and_tells_what_follows(tmp_path: Path) -> None:
    t, y, _ = growing("additive", n=60)
    path = tmp_path / "growth.csv"
    path.write_text("time,value\n" + "".join(f"{a},{b}\n" for a, b in zip(t, y, strict=True)))
    result = CliRunner().invoke(app, ["fit", str(path), "--model", "exponential", "--noise", "additive"])
    assert result.exit_code == 0, result.output
    assert "value = " in result.stdout
    assert "· exp(0.0" in result.stdout
    assert "doubling time" in result.stdout
    assert "as asked for" in result.stdout
