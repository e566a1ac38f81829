"""Arguments, validated by pydantic whatever format they came in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from service.errors import FieldError, Problem, ProblemType
from service.schemas.options import FitArguments

_EXPECTED = "Input should be "

Arguments = TypeVar("Arguments", bound=BaseModel)


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
    return validated(FitArguments, given)


def validated(model: type[Arguments], given: dict[str, Any]) -> Arguments:
    """Validate arguments.

    Raises
    ------
    Problem
        Naming every argument that is wrong.
    """
    try:
        return model.model_validate(given)
    except ValidationError as error:
        raise from_validation(error.errors(include_input=False, include_url=False)) from None


def refuse_absent(names: Sequence[str]) -> None:
    """Refuse a body without required columns, naming all of them."""
    if names:
        raise Problem(
            ProblemType.invalid_value,
            f"{', '.join(names)}: is required",
            errors=[FieldError(name, "is required") for name in names],
        )


def refuse_beside_json(names: Sequence[str]) -> None:
    """Refuse parameters of the query that a JSON body carries itself."""
    if names:
        raise Problem(
            ProblemType.unknown_field,
            "with a JSON body these belong into the body: " + ", ".join(names),
            errors=[FieldError(name, "belongs into the body") for name in names],
        )


def from_validation(found: Any, skip: int = 0) -> Problem:
    """Problem of pydantic's errors: fields and messages, without the input.

    Parameters
    ----------
    found : sequence of mapping
        ``ValidationError.errors()``, with keys ``loc``, ``type`` and ``msg``.
    skip : int
        Leading parts of each location to leave out (FastAPI puts ``"query"`` first).
    """
    messages: dict[str, list[str]] = {}
    for item in found[:20]:
        told = messages.setdefault(_field(item["loc"][skip:]), [])
        if _message(item) not in told:
            told.append(_message(item))
    errors = [FieldError(field, _alternatives(told)) for field, told in messages.items()]
    unknown = all(item["type"] == "extra_forbidden" for item in found)
    kind = ProblemType.unknown_field if unknown else ProblemType.invalid_value
    detail = "; ".join(f"{item.field}: {item.message}" for item in errors)
    return Problem(kind, detail, errors=errors)


def _field(place: Sequence[int | str]) -> str:
    """Name of the field at a place; below it stand entries, and pydantic's words for one of several types."""
    depth = 2 if place and place[0] == "options" else 1
    return ".".join(str(part)[:60] for part in place[:depth])


def _alternatives(messages: list[str]) -> str:
    """Sentence of all that a field may be, where it is none of it."""
    if not all(message.startswith(_EXPECTED) for message in messages):
        return "; ".join(messages)
    return _EXPECTED + " or ".join(message.removeprefix(_EXPECTED) for message in messages)


def _message(item: dict[str, Any]) -> str:
    return "is not known" if item["type"] == "extra_forbidden" else str(item["msg"])
