"""RFC 9457 problems as pydantic models, and the responses of an operation for the OpenAPI document."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from service.errors import PROBLEM_MEDIA_TYPE, ProblemType
from service.schemas.answers import NoFitReason, NoPositionReason, NoticeAnswer, RowReason


class FieldErrorAnswer(BaseModel):
    """One thing that is wrong with a request."""

    model_config = ConfigDict(extra="forbid")

    field: Annotated[str, Field(description="Key of the body (dots for nesting) or query parameter.")]
    message: str
    row: Annotated[int | None, Field(description="Row of a column, counted from 0.")] = None


class NoFitPoints(BaseModel):
    """What became of every row."""

    model_config = ConfigDict(extra="forbid")

    reason: list[RowReason]


class ProblemAnswer(BaseModel):
    """An error, as RFC 9457 has it. The caller's data are never repeated in it."""

    model_config = ConfigDict(extra="forbid")

    type: Annotated[str, Field(description="Stable reference that names the kind of problem.")]
    title: str
    status: int
    detail: Annotated[str, Field(description="What is wrong this time and how to mend it.")]
    request_id: Annotated[str, Field(description="The same as in the header `X-Request-Id`.")]
    field: str | None = None
    row: int | None = None
    errors: list[FieldErrorAnswer] | None = None
    accepted: Annotated[list[str] | None, Field(description="406, 415: media types there are.")] = None
    limit: Annotated[int | None, Field(description="413: bytes or rows that are taken.")] = None
    reason: Annotated[
        NoFitReason | NoPositionReason | None,
        Field(description="no-fit, no-position, no-track: why there is none."),
    ] = None
    points: Annotated[
        NoFitPoints | None, Field(description="no-fit, no-position, no-track: what became of every row.")
    ] = None
    notices: Annotated[
        list[NoticeAnswer] | None, Field(description="no-fit, no-position, no-track: typed warnings.")
    ] = None


def problem_responses(*kinds: ProblemType) -> dict[int | str, dict[str, Any]]:
    """Entry of ``responses`` in a route for the problems it can answer.

    Parameters
    ----------
    *kinds : ProblemType

    Returns
    -------
    dict
        By status; a status with several kinds names them all.
    """
    by_status: dict[int | str, dict[str, Any]] = {}
    for kind in kinds:
        entry = by_status.setdefault(
            kind.status,
            {
                "description": "",
                "content": {PROBLEM_MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/ProblemAnswer"}}},
            },
        )
        line = f"`{kind.uri}`: {kind.title}."
        entry["description"] = f"{entry['description']} {line}".strip()
    return by_status
