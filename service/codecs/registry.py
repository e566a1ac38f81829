"""Which codec reads a body and which writes the answer. A new format is one file and one line here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from estimators import Trend
from service.codecs.columns import Columns
from service.codecs.csv import read_csv, write_csv
from service.codecs.figure import write_png, write_svg
from service.codecs.json import read_json, write_json
from service.codecs.negotiation import media_type_of
from service.codecs.offers import Offer, choose_offer
from service.schemas.fields import AnswerFormat
from service.schemas.options import AnswerQuery, FitArguments, TrendQuery

Read = Callable[[bytes, TrendQuery], tuple[Columns, FitArguments]]
Write = Callable[[Trend, Columns, AnswerQuery], bytes]


@dataclass(frozen=True, slots=True)
class Writer(Offer[AnswerFormat]):
    """A format of answers.

    Attributes
    ----------
    write : callable
    """

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
    return READERS[media_type_of(content_type, content_encoding, tuple(READERS))]


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
    return choose_offer(WRITERS, accept, asked)
