"""Sky, residuals and the Stanford diagram over HTTP."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import pytest
from fastapi.testclient import TestClient

from estimators import Fix, locate
from service.codecs.positions.pictures import write_svg
from service.errors import Problem, ProblemType
from service.positions.located import Located
from service.schemas.position_query import PositionAnswerQuery
from tests.service.ranges import NAMES, epoch, epochs

TRUTH = {"truth_lat_deg": 52.5, "truth_lon_deg": 13.4, "truth_height_m": 80.0}


def post(client: TestClient, fields: dict[str, Any], **params: Any) -> Any:
    return client.post("/v1/positions", json=fields, params={"format": "svg", **params})


@pytest.mark.parametrize("figure", ["sky", "residuals"])
def test_pictures_of_one_epoch_name_every_satellite(client: TestClient, figure: str) -> None:
    response = post(client, epoch(), figure=figure, title="")
    assert response.headers["content-type"] == "image/svg+xml"
    assert "default-src 'none'" in response.headers["content-security-policy"]
    assert all(name in response.text for name in NAMES)


def test_the_two_pictures_of_an_epoch_are_different(client: TestClient) -> None:
    assert post(client, epoch(), figure="sky").content != post(client, epoch(), figure="residuals").content


def test_the_same_request_gives_the_same_bytes(client: TestClient) -> None:
    assert (
        post(client, epoch(), figure="residuals").content == post(client, epoch(), figure="residuals").content
    )


@pytest.mark.parametrize("fields", [epoch(), epochs()], ids=["one epoch", "three epochs"])
def test_errors_of_a_known_place_are_drawn_against_protection_levels(
    client: TestClient, fields: dict[str, Any]
) -> None:
    count = 3 if "time" in fields else 1
    text = post(client, fields, figure="stanford", **TRUTH).text
    assert f"0 of {count} errors exceed their level" in text


def test_errors_beyond_their_level_are_counted(client: TestClient) -> None:
    elsewhere = TRUTH | {"truth_lat_deg": 52.6}
    text = post(client, epoch(), figure="stanford", **elsewhere).text
    assert "1 of 1 errors exceed their level" in text


def test_size_theme_and_title_are_those_asked_for(client: TestClient) -> None:
    asked = {"width_px": 300, "height_px": 240, "theme": "dark"}
    png = post(client, epoch(), format="png", figure="residuals", **asked).content
    assert (int.from_bytes(png[16:20]), int.from_bytes(png[20:24])) == (300, 240)
    assert "Where they stand" in post(client, epoch(), title="Where they stand").text


@pytest.mark.parametrize(
    ("fields", "params", "field"),
    [
        (epochs(), {"figure": "residuals"}, "figure"),
        (epoch(), {"figure": "stanford"}, "truth_lat_deg"),
        (epoch(), {"figure": "stanford", "truth_lat_deg": 52.5, "truth_lon_deg": 13.4}, "truth_height_m"),
        (epoch(), {"figure": "stars"}, "figure"),
        (epoch(), {"figure": "stanford", **TRUTH, "truth_lat_deg": 91}, "truth_lat_deg"),
        (epoch(), {"width_px": 10}, "width_px"),
    ],
)
def test_what_cannot_be_drawn_is_refused(
    client: TestClient, fields: dict[str, Any], params: dict[str, Any], field: str
) -> None:
    problem = post(client, fields, **params).json()
    assert (problem["type"], problem["field"]) == (ProblemType.invalid_value.uri, field)


def test_without_any_finite_level_there_is_no_diagram() -> None:
    fields = epoch()
    rows = list(zip(fields["x_m"], fields["y_m"], fields["z_m"], strict=True))
    fix = locate(rows, fields["pseudorange_m"])
    assert isinstance(fix, Fix)
    unbounded = dataclasses.replace(fix, integrity=dataclasses.replace(fix.integrity, hpl_m=math.inf))
    with pytest.raises(Problem) as refused:
        write_svg(Located(unbounded), PositionAnswerQuery(figure="stanford", **TRUTH))
    assert refused.value.kind is ProblemType.no_position
