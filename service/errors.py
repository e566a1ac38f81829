"""Every error the service answers: RFC 9457 problems, one row per type.

Code raises :class:`Problem`; nothing else decides how an error looks. A problem names the field and the
row and says how to mend it; it never repeats what the caller sent.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import orjson
from starlette.responses import Response

PROBLEM_MEDIA_TYPE = "application/problem+json"


class ProblemType(Enum):
    """Problem types: name on the wire, status, title, and what the caller can do about it."""

    malformed_body = (
        "malformed-body",
        400,
        "The body cannot be read",
        "The body is not valid for its media type: broken JSON or CSV, invalid UTF-8, nested too deep.",
    )
    empty_body = ("empty-body", 400, "The body is empty", "Send a series in the body.")
    authentication_required = (
        "authentication-required",
        401,
        "An API key is required",
        "Send a key as 'Authorization: Bearer KEY' or 'X-API-Key: KEY'.",
    )
    not_found = ("not-found", 404, "There is nothing at this address", "The paths are listed at /docs.")
    method_not_allowed = (
        "method-not-allowed",
        405,
        "This address does not take this method",
        "The header Allow lists the methods.",
    )
    not_acceptable = (
        "not-acceptable",
        406,
        "No answer in an accepted format",
        "The schema of the operation lists its formats, JSON among them; ask for one in Accept or ?format=.",
    )
    request_timeout = (
        "request-timeout",
        408,
        "The body did not arrive in time",
        "Send the body faster or make it smaller.",
    )
    body_too_large = (
        "body-too-large",
        413,
        "The body is too large",
        "Send fewer rows; an operator can raise PLUMBLINE_MAX_BODY_BYTES.",
    )
    too_many_points = (
        "too-many-points",
        413,
        "The series has too many rows",
        "Send fewer rows; an operator can raise PLUMBLINE_MAX_POINTS.",
    )
    too_many_series = (
        "too-many-series",
        413,
        "The batch has too many series",
        "Send the series in several batches; an operator can raise PLUMBLINE_MAX_SERIES.",
    )
    unsupported_media_type = (
        "unsupported-media-type",
        415,
        "The media type of the body is not supported",
        "Send one of the media types that the detail lists, text in UTF-8, not compressed.",
    )
    invalid_value = (
        "invalid-value",
        422,
        "A value cannot be used",
        "The field, and for columns the row (counted from 0), say which; the detail says how to mend it.",
    )
    unknown_field = (
        "unknown-field",
        422,
        "A field is not known",
        "The fields are listed in the schema; check the spelling.",
    )
    no_fit = (
        "no-fit",
        422,
        "The data do not determine a trend",
        "The reason says why; points.reason tells what became of every row.",
    )
    no_position = (
        "no-position",
        422,
        "The ranges do not determine a position",
        "The reason says why; points.reason tells what became of every row.",
    )
    no_track = (
        "no-track",
        422,
        "The fixes do not determine a track",
        "The reason says why; points.reason tells what became of every row.",
    )
    internal_error = (
        "internal-error",
        500,
        "The service failed",
        "This is a fault of the service. Report the request id to its operator.",
    )
    not_installed = (
        "not-installed",
        501,
        "The service lacks what reads this",
        "An operator can install the extra that the detail names.",
    )
    busy = (
        "busy",
        503,
        "The service is busy",
        "Ask again after the seconds in Retry-After.",
    )
    not_ready = (
        "not-ready",
        503,
        "The service is starting",
        "Compiled code is being loaded; ask again after the seconds in Retry-After.",
    )
    deadline_exceeded = (
        "deadline-exceeded",
        504,
        "The answer took too long",
        "Send fewer rows; an operator can raise PLUMBLINE_DEADLINE_SECONDS.",
    )

    @property
    def slug(self) -> str:
        """Name on the wire."""
        return self.value[0]

    @property
    def uri(self) -> str:
        """The problem's ``type``: stable, and an address of this service that explains it."""
        return f"/problems/{self.slug}"

    @property
    def status(self) -> int:
        """HTTP status."""
        return self.value[1]

    @property
    def title(self) -> str:
        """One sentence that is the same for every problem of the type."""
        return self.value[2]

    @property
    def remedy(self) -> str:
        """What the caller can do about it."""
        return self.value[3]


@dataclass(frozen=True, slots=True)
class FieldError:
    """One thing that is wrong with a request.

    Attributes
    ----------
    field : str
        Where: a key of the body with dots for nesting, a query parameter, or a CSV column's role.
    message : str
        What is wrong and how to mend it.
    row : int or None
        Row of a column, counted from 0; a CSV header is not counted.
    """

    field: str
    message: str
    row: int | None = None

    def to_dict(self) -> dict[str, Any]:
        """JSON form; the row only where there is one."""
        found: dict[str, Any] = {"field": self.field, "message": self.message}
        return found if self.row is None else found | {"row": self.row}


class Problem(Exception):  # noqa: N818  (RFC 9457 calls it so)
    """An error to be answered as ``application/problem+json``.

    Parameters
    ----------
    kind : ProblemType
    detail : str, optional
        What is wrong this time; default the type's remedy.
    errors : sequence of FieldError
        The fields at fault; the first also appears as ``field`` and ``row``.
    headers : mapping of str to str
        Response headers that belong to the status (``Allow``, ``Retry-After``, ...).
    extra : mapping
        Further members of the problem (RFC 9457, 3.2).
    """

    def __init__(
        self,
        kind: ProblemType,
        detail: str | None = None,
        *,
        errors: Sequence[FieldError] = (),
        headers: Mapping[str, str] | None = None,
        extra: Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(kind.slug)
        self.kind = kind
        self.detail = kind.remedy if detail is None else detail
        self.errors = tuple(errors)
        self.headers = dict(headers or {})
        self.extra = dict(extra or {})

    def to_dict(self, request_id: str) -> dict[str, Any]:
        """JSON form."""
        body: dict[str, Any] = {
            "type": self.kind.uri,
            "title": self.kind.title,
            "status": self.kind.status,
            "detail": self.detail,
            "request_id": request_id,
        }
        if self.errors:
            first = self.errors[0]
            body["field"] = first.field
            if first.row is not None:
                body["row"] = first.row
            body["errors"] = [item.to_dict() for item in self.errors]
        return body | self.extra

    def to_response(self, request_id: str) -> Response:
        """Answer with this problem."""
        return Response(
            orjson.dumps(self.to_dict(request_id), option=orjson.OPT_SERIALIZE_NUMPY),
            status_code=self.kind.status,
            headers=self.headers,
            media_type=PROBLEM_MEDIA_TYPE,
        )


def invalid_value(field: str, message: str, row: int | None = None) -> Problem:
    """Problem of one value: the commonest error of all."""
    place = field if row is None else f"{field}, row {row}"
    return Problem(ProblemType.invalid_value, f"{place}: {message}", errors=[FieldError(field, message, row)])


def unknown_fields(fields: Sequence[str], known: Sequence[str], where: str) -> Problem:
    """Problem of keys or parameters that mean nothing here; names are cut, so that no body comes back."""
    message = f"not a field of {where}; its fields are: {', '.join(known)}"
    names = [field[:60] for field in fields[:20]]
    return Problem(
        ProblemType.unknown_field,
        f"{', '.join(names)}: {message}",
        errors=[FieldError(name, message) for name in names],
    )
