from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from pydantic import SecretStr

from service.main import create_app
from service.openapi import write
from service.settings import Settings

COMMITTED = Path(__file__).parents[2] / "openapi" / "openapi.json"


@pytest.fixture(scope="module")
def served() -> dict[str, Any]:
    document: dict[str, Any] = TestClient(create_app(Settings(log_level="error"))).get("/openapi.json").json()
    return document


def operations(document: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for path, methods in document["paths"].items():
        for operation in methods.values():
            yield path, operation


def references(part: Any) -> Iterator[str]:
    if isinstance(part, dict):
        for key, value in part.items():
            if key == "$ref":
                yield value
            else:
                yield from references(value)
    elif isinstance(part, list):
        for item in part:
            yield from references(item)


def test_the_committed_document_is_the_one_that_is_served(served: dict[str, Any]) -> None:
    assert json.loads(COMMITTED.read_text(encoding="utf-8")) == served


def test_writing_the_document_gives_the_committed_bytes(tmp_path: Path) -> None:
    write(tmp_path / "openapi.json")
    assert (tmp_path / "openapi.json").read_bytes() == COMMITTED.read_bytes()


def test_settings_do_not_change_the_document(served: dict[str, Any]) -> None:
    other = Settings(
        log_level="error", workers=1, max_points=10, host="0.0.0.0", api_keys=SecretStr("a-key-long-enough")
    )
    assert TestClient(create_app(other)).get("/openapi.json").json() == served


def test_every_reference_leads_somewhere_and_every_schema_is_used(served: dict[str, Any]) -> None:
    defined = {f"#/components/schemas/{name}" for name in served["components"]["schemas"]}
    assert set(references(served)) == defined


def test_every_error_is_documented_as_a_problem(served: dict[str, Any]) -> None:
    for _, operation in operations(served):
        for status, answer in operation["responses"].items():
            if status != "200":
                assert list(answer["content"]) == ["application/problem+json"]


def test_every_guarded_operation_says_so(served: dict[str, Any]) -> None:
    for path, operation in operations(served):
        is_probe = path in ("/healthz", "/readyz")
        assert ("401" in operation["responses"]) is not is_probe
        assert ("security" in operation) is not is_probe


def test_a_fit_takes_json_and_csv_and_answers_in_four_formats(served: dict[str, Any]) -> None:
    operation = served["paths"]["/v1/trends"]["post"]
    assert list(operation["requestBody"]["content"]) == ["application/json", "text/csv"]
    assert set(operation["responses"]["200"]["content"]) == {
        "application/json",
        "text/csv",
        "image/svg+xml",
        "image/png",
    }
