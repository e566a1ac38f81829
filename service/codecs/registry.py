"""Which codec reads a body and which writes the answer. A new format is one file and one line here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from email.message import Message

from estimators import Trend
from service.codecs.columns import Columns
from service.codecs.csv import read_csv, write_csv
from service.codecs.figure import write_png, write_svg
from service.codecs.json import read_json, write_json
from service.errors import Problem, ProblemType
from service.schemas.options import AnswerFormat, AnswerQuery, FitArguments, TrendQuery

Read = Callable[[bytes, TrendQuery], tuple[Columns, FitArguments]]
Write = Callable[[Trend, Columns, AnswerQuery], bytes]


@dataclass(frozen=True, slots=True)
class Writer:
    """A format of answers.

    Attributes
    ----------
    name : str
        As in ``?format=``.
    media_type : str
        As in ``Accept``, without parameters.
    content_type : str
        As in the answer's ``Content-Type``.
    write : callable
    """

    name: AnswerFormat
    media_type: str
    content_type: str
    write: Write


READERS: dict[str, Read] = {"application/json": read_json, "text/csv": read_csv}

#: In the order of preference where the caller has none.
WRITERS: tuple[Writer, ...] = (
    Writer("json", "application/json", "application/json", write_json),
    Writer("csv", "text/csv", "text/csv; charset=utf-8; header=present", write_csv),
    Writer("svg", "image/svg+xml", "image/svg+xml", write_svg),
    Writer("png", "image/png", "image/png", write_png),
)


def choose_reader(content_type: str | None, content_encoding: str | None) -> Read:
    """Codec of a body.

    Parameters
    ----------
    content_type, content_encoding : str or None
        The request's headers.

    Raises
    ------
    Problem
        415, with the accepted media types, if there is none.
    """
    if content_encoding not in (None, "", "identity"):
        raise _unsupported("compressed bodies are not taken", {"Accept-Encoding": "identity"})
    if not content_type:
        raise _unsupported("say what the body is in Content-Type")
    header = Message()
    header["content-type"] = content_type
    reader = READERS.get(header.get_content_type())
    if reader is None:
        raise _unsupported("this media type is not taken")
    charset = header.get_content_charset("utf-8")
    if charset not in ("utf-8", "utf8", "us-ascii"):
        raise _unsupported("bodies are read as UTF-8 only")
    return reader


def choose_writer(accept: str | None, asked: AnswerFormat | None) -> Writer:
    """Format of the answer: ``?format=`` first, then ``Accept`` by quality (RFC 9110, 12.5.1).

    Raises
    ------
    Problem
        406, with the formats there are, if none is accepted.

    Examples
    --------
    >>> choose_writer("image/*;q=0.5, text/csv", None).name
    'csv'
    """
    if asked is not None:
        return next(writer for writer in WRITERS if writer.name == asked)
    if not accept or not accept.strip():
        return WRITERS[0]
    ranges = [_media_range(item) for item in accept.split(",")[:50]]
    scored = [(_quality(writer.media_type, ranges), -place) for place, writer in enumerate(WRITERS)]
    quality, place = max(scored)
    if quality <= 0:
        available = [writer.media_type for writer in WRITERS]
        raise Problem(
            ProblemType.not_acceptable,
            f"the answer comes as {', '.join(available)}",
            extra={"accepted": available},
        )
    return WRITERS[-place]


def _unsupported(why: str, headers: dict[str, str] | None = None) -> Problem:
    accepted = list(READERS)
    return Problem(
        ProblemType.unsupported_media_type,
        f"{why}; accepted: {', '.join(accepted)}",
        headers={"Accept-Post": ", ".join(accepted)} | (headers or {}),
        extra={"accepted": accepted},
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
