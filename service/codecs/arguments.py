"""Arguments of the fit, validated by pydantic whatever format they came in."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from service.errors import FieldError, Problem, ProblemType
from service.schemas.options import FitArguments


def read_arguments(given: dict[str, Any]) -> FitArguments:
    """Validate the arguments of the fit.

    Parameters
    ----------
    given : dict
        As in a JSON body, without the columns.

    Raises
    ------
    Problem
        Naming every argument that is wrong.
    """
    try:
        return FitArguments.model_validate(given)
    except ValidationError as error:
        raise from_validation(error.errors(include_input=False, include_url=False)) from None


def from_validation(found: Any, skip: int = 0) -> Problem:
    """Problem of pydantic's errors: fields and messages, without the input.

    Parameters
    ----------
    found : sequence of mapping
        ``ValidationError.errors()``, with keys ``loc``, ``type`` and ``msg``.
    skip : int
        Leading parts of each location to leave out (FastAPI puts ``"query"`` first).
    """
    errors = [
        FieldError(".".join(str(part)[:60] for part in item["loc"][skip:]), _message(item))
        for item in found[:20]
    ]
    unknown = all(item["type"] == "extra_forbidden" for item in found)
    kind = ProblemType.unknown_field if unknown else ProblemType.invalid_value
    detail = "; ".join(f"{item.field}: {item.message}" for item in errors)
    return Problem(kind, detail, errors=errors)


def _message(item: dict[str, Any]) -> str:
    return "is not known" if item["type"] == "extra_forbidden" else str(item["msg"])
