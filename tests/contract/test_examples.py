from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from service.main import create_app
from service.settings import Settings
from tests.contract.examples import EXAMPLES, ask, content_of, differences, load


@pytest.fixture(scope="module")
def client() -> Iterator[TestClient]:
    with TestClient(create_app(Settings(log_level="error"))) as opened:
        yield opened


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.json")), ids=lambda path: path.stem)
def test_the_service_answers_as_the_example_says(client: TestClient, path: Path) -> None:
    example = load(path)
    response = ask(client, example["request"])
    expected = example["response"]
    assert response.status_code == expected["status"]
    assert {name: response.headers[name] for name in expected["headers"]} == expected["headers"]
    assert list(differences(content_of(response), expected["body"])) == []


def test_every_operation_has_an_example(client: TestClient) -> None:
    shown = {
        (example["request"]["method"], example["request"]["path"].partition("?")[0])
        for example in map(load, EXAMPLES.glob("*.json"))
    }
    offered = {
        (method.upper(), path)
        for path, operations in client.get("/openapi.json").json()["paths"].items()
        for method in operations
    }
    # What these answer is different every time.
    assert offered - shown == {("GET", "/metrics"), ("GET", "/readyz")}


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (1.0, 1.0 + 1e-6),
        (1.0, "1.0"),
        (True, 1),
        (None, 0.0),
        ([1.0], [1.0, 2.0]),
        ({"a": 1}, {"b": 1}),
        ({"a": {"b": [1.0, 2.0]}}, {"a": {"b": [1.0, 2.1]}}),
    ],
)
def test_the_comparison_sees_what_differs(found: object, expected: object) -> None:
    assert list(differences(found, expected))
