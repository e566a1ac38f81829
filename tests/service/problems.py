"""What the tests of refusals ask of an answer."""

from __future__ import annotations

from typing import Any

from service.errors import ProblemType


def refused(response: Any, kind: ProblemType, field: str | None) -> dict[str, Any]:
    """Problem of an answer, which is of a kind and names a field."""
    problem: dict[str, Any] = response.json()
    assert response.status_code == kind.status, problem
    assert response.headers["content-type"] == "application/problem+json"
    assert (problem["type"], problem.get("field")) == (kind.uri, field)
    return problem
