"""Inference on request, on the wire and on the command line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from typer.testing import CliRunner

from estimators import RobustOptions, fit_trend
from service.cli import app
from service.schemas.answers import TrendAnswer

RNG = np.random.default_rng(7)
TIME = np.arange(40.0)
VALUE = (3.0 + 0.2 * TIME + RNG.normal(size=40) + 20.0 * (np.arange(40) % 9 == 0)).round(4)
METHODS = ("effective-n", "hac", "bootstrap", "permutation")


def body(**fields: Any) -> dict[str, Any]:
    return {"time": TIME.tolist(), "value": VALUE.tolist(), **fields}


@pytest.mark.parametrize("uncertainty", METHODS)
def test_the_answer_is_that_of_the_library_and_fits_the_schema(client: TestClient, uncertainty: str) -> None:
    asked = body(uncertainty=uncertainty, options={"resamples": 99}, seed=3)
    answer = client.post("/v1/trends", json=asked).json()
    options = RobustOptions(resamples=99)
    trend = fit_trend(TIME, VALUE, uncertainty=uncertainty, options=options, seed=3)
    assert answer == json.loads(json.dumps(trend.to_dict()))
    TrendAnswer.model_validate(answer, strict=False)
    assert answer["uncertainty"]["method"] == uncertainty


def test_the_default_says_nothing_of_resamples(client: TestClient) -> None:
    answer = client.post("/v1/trends", json=body()).json()
    assert set(answer["uncertainty"]) == {"method", "level", "effective_n", "lag1", "dof"}


def test_csv_carries_the_method_in_the_query(client: TestClient) -> None:
    table = "time,value\n" + "".join(f"{a},{b}\n" for a, b in zip(TIME, VALUE, strict=True))
    response = client.post(
        "/v1/trends?uncertainty=permutation&options.resamples=99",
        content=table,
        headers={"Content-Type": "text/csv"},
    )
    assert response.status_code == 200, response.text
    assert response.json()["uncertainty"]["resamples"] == 99


@pytest.mark.parametrize(
    ("fields", "named"),
    [({"uncertainty": "guess"}, "uncertainty"), ({"options": {"resamples": 10}}, "options.resamples")],
)
def test_unknown_methods_and_too_few_resamples_are_named(
    client: TestClient, fields: dict[str, Any], named: str
) -> None:
    response = client.post("/v1/trends", json=body(**fields))
    assert response.status_code == 422
    assert response.headers["content-type"] == "application/problem+json"
    assert response.json()["errors"][0]["field"] == named


def test_the_command_line_takes_the_method_and_tells_of_the_resamples(tmp_path: Path) -> None:
    path = tmp_path / "series.csv"
    path.write_text("time,value\n" + "".join(f"{a},{b}\n" for a, b in zip(TIME, VALUE, strict=True)))
    result = CliRunner().invoke(app, ["fit", str(path), "--uncertainty", "bootstrap"])
    assert result.exit_code == 0, result.output
    told = " ".join(result.stdout.split())
    assert "bootstrap" in told
    assert "400 resamples in blocks of 6" in told
    assert "find the same structure" in told
