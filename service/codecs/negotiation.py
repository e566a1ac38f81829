"""Which offered media type a request means: ``Content-Type`` and ``Accept`` (RFC 9110, 8.3 and 12.5.1)."""

from __future__ import annotations

from collections.abc import Sequence
from email.message import Message

from service.errors import Problem, ProblemType


def media_type_of(content_type: str | None, content_encoding: str | None, taken: Sequence[str]) -> str:
    """Media type of a body, one of those that are taken.

    Parameters
    ----------
    content_type, content_encoding : str or None
        The request's headers.
    taken : sequence of str
        Media types without parameters.

    Raises
    ------
    Problem
        415, with the accepted media types, if it is none of them.
    """
    if content_encoding not in (None, "", "identity"):
        raise _unsupported("compressed bodies are not taken", taken, {"Accept-Encoding": "identity"})
    if not content_type:
        raise _unsupported("say what the body is in Content-Type", taken)
    header = Message()
    header["content-type"] = content_type
    found = header.get_content_type()
    if found not in taken:
        raise _unsupported("this media type is not taken", taken)
    if header.get_content_charset("utf-8") not in ("utf-8", "utf8", "us-ascii"):
        raise _unsupported("bodies are read as UTF-8 only", taken)
    return found


def best_offer(accept: str | None, offered: Sequence[str]) -> str:
    """Offered media type that ``Accept`` likes best; of equals, the one offered first.

    Raises
    ------
    Problem
        406, with the formats there are, if none is accepted.

    Examples
    --------
    >>> best_offer("image/*;q=0.5, text/csv", ["application/json", "image/png", "text/csv"])
    'text/csv'
    """
    if not accept or not accept.strip():
        return offered[0]
    ranges = [_media_range(item) for item in accept.split(",")[:50]]
    scored = [(_quality(media_type, ranges), -place) for place, media_type in enumerate(offered)]
    quality, place = max(scored)
    if quality <= 0:
        raise Problem(
            ProblemType.not_acceptable,
            f"the answer comes as {', '.join(offered)}",
            extra={"accepted": list(offered)},
        )
    return offered[-place]


def _unsupported(why: str, taken: Sequence[str], headers: dict[str, str] | None = None) -> Problem:
    listed = ", ".join(taken)
    return Problem(
        ProblemType.unsupported_media_type,
        f"{why}; accepted: {listed}",
        headers={"Accept-Post": listed} | (headers or {}),
        extra={"accepted": list(taken)},
    )


def _media_range(text: str) -> tuple[str, float]:
    """Split a media range from its quality; a quality that cannot be read counts as 0."""
    name, *parameters = (part.strip().lower() for part in text.split(";"))
    for parameter in parameters:
        if parameter.startswith("q="):
            try:
                quality = float(parameter[2:])
            except ValueError:
                return name, 0.0
            return name, quality if 0 <= quality <= 1 else 0.0
    return name, 1.0


def _quality(media_type: str, ranges: list[tuple[str, float]]) -> float:
    """Quality of a media type: that of the most specific range that covers it."""
    family = f"{media_type.partition('/')[0]}/*"
    for covering in (media_type, family, "*/*"):
        found = [quality for name, quality in ranges if name == covering]
        if found:
            return max(found)
    return 0.0
