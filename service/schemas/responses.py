"""What the routes that compute answer with, as OpenAPI describes it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from service.errors import ProblemType
from service.schemas.problems import problem_responses

_PROBLEMS = (
    ProblemType.malformed_body,
    ProblemType.empty_body,
    ProblemType.not_acceptable,
    ProblemType.request_timeout,
    ProblemType.body_too_large,
    ProblemType.too_many_points,
    ProblemType.unsupported_media_type,
    ProblemType.invalid_value,
    ProblemType.unknown_field,
    ProblemType.busy,
    ProblemType.not_ready,
    ProblemType.deadline_exceeded,
)
"""What can go wrong wherever a body is read and computed with."""


def computed_responses(
    model: Any,
    description: str,
    content: Mapping[str, Any],
    *problems: ProblemType,
    timing: str = "Milliseconds of the phases parse, queue, fit and encode.",
) -> dict[int | str, dict[str, Any]]:
    """Describe the answers of a route that reads a body and computes.

    Parameters
    ----------
    model : type
        Of the JSON answer.
    description : str
    content : mapping
        Schemas of the other forms, by media type.
    *problems : ProblemType
        Those that the other routes have not.
    timing : str
        What the header ``Server-Timing`` holds.

    Returns
    -------
    dict
        For ``responses=`` of a route.
    """
    return {
        200: {
            "model": model,
            "description": description,
            "content": dict(content),
            "headers": {"Server-Timing": {"description": timing, "schema": {"type": "string"}}},
        },
        **problem_responses(*_PROBLEMS, *problems),
    }
