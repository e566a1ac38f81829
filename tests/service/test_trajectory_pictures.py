"""Maps and error plots of tracks over HTTP."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.errors import ProblemType
from tests.service.fixes import as_csv, two_walks, walk
from tests.service.problems import refused

URL = "/v1/trajectories"


def post(client: TestClient, fields: dict[str, Any], **params: Any) -> Any:
    return client.post(URL, json=fields, params={"format": "svg", **params})


@pytest.mark.parametrize("figure", ["map", "error"])
def test_a_picture_counts_the_fix_that_lies(client: TestClient, figure: str) -> None:
    response = post(client, walk(), figure=figure)
    assert response.headers["content-type"] == "image/svg+xml"
    assert "default-src 'none'" in response.headers["content-security-policy"]
    assert "spike (1)" in response.text


def test_the_accepted_media_type_asks_for_a_picture_of_a_file(client: TestClient) -> None:
    headers = {"content-type": "text/csv", "accept": "image/png"}
    response = client.post(URL, content=as_csv(walk()), headers=headers)
    assert response.headers["content-type"] == "image/png"
    assert response.content.startswith(b"\x89PNG")


def test_a_map_is_drawn_unless_errors_are_asked_for(client: TestClient) -> None:
    drawn = post(client, walk()).content
    assert drawn == post(client, walk(), figure="map").content
    assert drawn != post(client, walk(), figure="error").content


def test_size_theme_and_title_are_those_asked_for(client: TestClient) -> None:
    png = post(client, walk(), format="png", width_px=300, height_px=240, theme="dark").content
    assert (int.from_bytes(png[16:20]), int.from_bytes(png[20:24])) == (300, 240)
    assert "Round the lake" in post(client, walk(), title="Round the lake").text


def test_a_picture_of_the_only_device_is_drawn(client: TestClient) -> None:
    assert post(client, walk(device=["van"] * 60)).content == post(client, walk()).content


def test_a_picture_shows_one_track(client: TestClient) -> None:
    problem = refused(post(client, two_walks()), ProblemType.invalid_value, "format")
    assert "there are 2" in str(problem)


def test_fixes_without_a_track_have_no_picture(client: TestClient) -> None:
    fields = {"time": [0, 1], "lat": [None, None], "lon": [11.0, 11.0]}
    assert post(client, fields).json()["type"] == ProblemType.no_track.uri
    alone = {**fields, "device": ["van", "van"]}
    assert post(client, alone).json()["type"] == ProblemType.no_track.uri


@pytest.mark.parametrize(
    ("params", "field"),
    [({"figure": "sky"}, "figure"), ({"width_px": 10}, "width_px"), ({"theme": "sepia"}, "theme")],
)
def test_a_picture_that_there_is_not_is_refused(
    client: TestClient, params: dict[str, Any], field: str
) -> None:
    refused(post(client, walk(), **params), ProblemType.invalid_value, field)
