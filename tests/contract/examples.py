"""Request and answer pairs in ``openapi/examples``: reading, asking, comparing."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx2
from fastapi.testclient import TestClient

EXAMPLES = Path(__file__).parents[2] / "openapi" / "examples"
TOLERANCE = 1e-9


def load(path: Path) -> dict[str, Any]:
    """An example."""
    example: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return example


def ask(client: TestClient, request: dict[str, Any]) -> httpx2.Response:
    """Send a request of an example; a body that is text is sent as it is, any other as JSON."""
    body = request.get("body")
    content = body if isinstance(body, str) or body is None else json.dumps(body)
    return client.request(request["method"], request["path"], headers=request.get("headers"), content=content)


def content_of(response: httpx2.Response) -> Any:
    """Body of an answer as an example holds it: JSON as it is, CSV as a list of rows."""
    media_type = response.headers["content-type"].partition(";")[0]
    if media_type.endswith("json"):
        return response.json()
    if media_type == "text/csv":
        return [[_cell(cell) for cell in line.split(",")] for line in response.text.splitlines()]
    raise ValueError(f"examples hold JSON and CSV, not {media_type}")


def differences(found: Any, expected: Any, place: str = "body") -> Iterator[str]:
    """Where two bodies differ; numbers may differ by one part in 1e9."""
    if isinstance(expected, dict) and isinstance(found, dict):
        for key in sorted(found.keys() ^ expected.keys()):
            yield f"{place}.{key}: only in one of them"
        for key in found.keys() & expected.keys():
            yield from differences(found[key], expected[key], f"{place}.{key}")
    elif isinstance(expected, list) and isinstance(found, list):
        if len(found) != len(expected):
            yield f"{place}: {len(found)} entries, expected {len(expected)}"
        for row, (one, other) in enumerate(zip(found, expected, strict=False)):
            yield from differences(one, other, f"{place}[{row}]")
    elif _is_number(found) and _is_number(expected):
        if not math.isclose(found, expected, rel_tol=TOLERANCE, abs_tol=TOLERANCE):
            yield f"{place}: {found!r}, expected {expected!r}"
    elif type(found) is not type(expected) or found != expected:
        yield f"{place}: {found!r}, expected {expected!r}"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _cell(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text
