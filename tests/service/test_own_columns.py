"""The caller's own columns on the wire: JSON, CSV, and what is said of those that cannot be used."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from estimators import fit_trend
from tests.service.series import CSV

ROWS = np.arange(40)
HEAT = np.sin(1.7 * ROWS)
VALUE = 3.0 + 0.5 * ROWS + 2.0 * HEAT + 0.1 * np.random.default_rng(2).normal(size=40)
SERIES: dict[str, Any] = {"time": ROWS.tolist(), "value": VALUE.tolist(), "model": "linear"}
TABLE = "time,value,heat,other\n" + "".join(
    f"{t},{y!r},{h!r},{t % 5}\n" for t, y, h in zip(ROWS, VALUE.tolist(), HEAT.tolist(), strict=True)
)


def test_columns_are_fitted_as_the_library_does_and_predicted_at_their_means(client: TestClient) -> None:
    asked = SERIES | {"columns": {"heat": HEAT.tolist()}, "predict": [50]}
    answer = client.post("/v1/trends", json=asked).json()
    trend = fit_trend(ROWS, VALUE, model="linear", columns={"heat": HEAT}, predict=[50])
    assert answer == json.loads(json.dumps(trend.to_dict()))
    assert answer["parameters"]["heat"]["value"] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("query", ["columns=heat&columns=other", "columns=heat,other"])
def test_csv_names_them_in_the_query(client: TestClient, query: str) -> None:
    response = client.post(f"/v1/trends?model=linear&{query}", content=TABLE, headers=CSV)
    asked = SERIES | {"columns": {"heat": HEAT.tolist(), "other": (ROWS % 5).tolist()}}
    assert response.json() == client.post("/v1/trends", json=asked).json()


@pytest.mark.parametrize(
    ("fields", "field", "message"),
    [
        ({"columns": {"heat": [1.0, 2.0]}}, "columns.heat", "2 entries for 40 times"),
        ({"columns": {"heat": ["warm"] * 40}}, "columns.heat", "expected a number"),
        ({"columns": {"heat": [None, *HEAT.tolist()[1:]]}}, "columns", "heat: an entry is missing"),
        ({"columns": {"": HEAT.tolist()}}, "columns", "a name has 1 to 100 printable characters"),
        ({"columns": [HEAT.tolist()]}, "columns", "must be an object"),
        ({"columns": {f"c{k}": HEAT.tolist() for k in range(9)}}, "columns", "at most 8"),
        ({"columns": {"slope": HEAT.tolist()}}, "columns", "slope is the name of a parameter"),
        (
            {"columns": {"heat": HEAT.tolist()}, "model": "line"},
            "columns",
            "has no meaning for the model line",
        ),
    ],
)
def test_columns_that_cannot_be_used_are_refused_by_their_name(
    client: TestClient, fields: dict[str, Any], field: str, message: str
) -> None:
    response = client.post("/v1/trends", json=SERIES | fields)
    assert response.status_code == 422
    (error,) = response.json()["errors"]
    assert error["field"] == field
    assert message in error["message"]


def test_a_column_that_is_given_twice_is_refused(client: TestClient) -> None:
    text = json.dumps(SERIES | {"columns": {"heat": HEAT.tolist(), "cold": HEAT.tolist()}})
    response = client.post(
        "/v1/trends", content=text.replace('"cold"', '"heat"'), headers={"content-type": "application/json"}
    )
    assert response.status_code == 422
    assert response.json()["errors"] == [{"field": "columns.heat", "message": "is given twice; give it once"}]


@pytest.mark.parametrize("query", ["columns=cold", "columns=heat,heat"])
def test_csv_names_of_no_or_two_columns_are_refused(client: TestClient, query: str) -> None:
    response = client.post(f"/v1/trends?model=linear&{query}", content=TABLE, headers=CSV)
    assert response.status_code == 422
    assert response.json()["errors"][0]["field"] == "columns"
