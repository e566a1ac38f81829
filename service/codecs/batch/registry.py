"""Which codec reads a batch and which writes its answer. A new format is one file and one line here."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from service.codecs.batch.answer import Answer
from service.codecs.batch.arrow import read_arrow
from service.codecs.batch.csv import read_csv
from service.codecs.batch.documents import GEOJSON, write_geojson, write_json, write_ndjson
from service.codecs.batch.json import read_json
from service.codecs.batch.parquet import read_parquet
from service.codecs.batch.rows import Batch, Reading
from service.codecs.batch.tables import write_arrow, write_csv, write_parquet
from service.codecs.negotiation import best_offer, media_type_of
from service.schemas.batch import BatchFormat

ARROW_STREAM = "application/vnd.apache.arrow.stream"
ARROW_FILE = "application/vnd.apache.arrow.file"
PARQUET = "application/vnd.apache.parquet"
NDJSON = "application/x-ndjson"

Read = Callable[[Any, Reading], Batch]
Write = Callable[[Answer], Iterator[bytes]]


@dataclass(frozen=True, slots=True)
class BatchWriter:
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
        Generator of bytes.
    is_streamed : bool
        Whether the answer begins before all series are fitted.
    """

    name: BatchFormat
    media_type: str
    content_type: str
    write: Write
    is_streamed: bool = False


READERS: dict[str, Read] = {
    "application/json": read_json,
    "text/csv": read_csv,
    ARROW_STREAM: read_arrow,
    ARROW_FILE: read_arrow,
    PARQUET: read_parquet,
}

#: In the order of preference where the caller has none.
WRITERS: tuple[BatchWriter, ...] = (
    BatchWriter("json", "application/json", "application/json", write_json),
    BatchWriter("csv", "text/csv", "text/csv; charset=utf-8; header=present", write_csv),
    BatchWriter("arrow", ARROW_STREAM, ARROW_STREAM, write_arrow),
    BatchWriter("parquet", PARQUET, PARQUET, write_parquet),
    BatchWriter("ndjson", NDJSON, NDJSON, write_ndjson, is_streamed=True),
    BatchWriter("geojson", GEOJSON, GEOJSON, write_geojson),
)


def choose_reader(content_type: str | None, content_encoding: str | None) -> Read:
    """Codec of a body (415 if there is none)."""
    return READERS[media_type_of(content_type, content_encoding, tuple(READERS))]


def choose_writer(accept: str | None, asked: BatchFormat | None) -> BatchWriter:
    """Format of the answer: ``?format=`` first, then ``Accept`` (406 if none is accepted).

    Examples
    --------
    >>> choose_writer("application/geo+json, text/csv;q=0.5", None).name
    'geojson'
    """
    if asked is not None:
        return next(writer for writer in WRITERS if writer.name == asked)
    wanted = best_offer(accept, [writer.media_type for writer in WRITERS])
    return next(writer for writer in WRITERS if writer.media_type == wanted)
