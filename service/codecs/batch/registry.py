"""Which codec reads a batch and which writes its answer. A new format is one file and one line here.

Codecs are named, and imported when a body or an answer asks for one: Arrow takes long to import, and who
sends single series never needs it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, cast

from service.codecs.negotiation import media_type_of
from service.codecs.offers import Offer, choose_offer
from service.schemas.batch import BatchFormat

if TYPE_CHECKING:
    from service.codecs.batch.answer import Answer
    from service.codecs.batch.rows import Batch, Reading

ARROW_STREAM = "application/vnd.apache.arrow.stream"
ARROW_FILE = "application/vnd.apache.arrow.file"
PARQUET = "application/vnd.apache.parquet"
NDJSON = "application/x-ndjson"
GEOJSON = "application/geo+json"


@dataclass(frozen=True, slots=True)
class BatchReader:
    """A format of bodies.

    Attributes
    ----------
    codec : str
        ``module:function`` in this package.
    """

    codec: str

    def read(self, source: Any, reading: Reading) -> Batch:
        """Batch of a body, as a seekable ``pyarrow.NativeFile``."""
        return cast("Callable[[Any, Reading], Batch]", _find(self.codec))(source, reading)


@dataclass(frozen=True, slots=True)
class BatchWriter(Offer[BatchFormat]):
    """A format of answers.

    Attributes
    ----------
    codec : str
        ``module:function`` in this package, a generator of bytes.
    is_streamed : bool
        Whether the answer begins before all series are fitted.
    """

    codec: str
    is_streamed: bool = False

    def write(self, answer: Answer) -> Iterator[bytes]:
        """Bytes of an answer, piece by piece."""
        return cast("Callable[[Answer], Iterator[bytes]]", _find(self.codec))(answer)


def _find(codec: str) -> Any:
    return resolve_name(f"service.codecs.batch.{codec}")


READERS: dict[str, BatchReader] = {
    "application/json": BatchReader("json:read_json"),
    "text/csv": BatchReader("csv:read_csv"),
    ARROW_STREAM: BatchReader("arrow:read_arrow"),
    ARROW_FILE: BatchReader("arrow:read_arrow"),
    PARQUET: BatchReader("parquet:read_parquet"),
}

#: In the order of preference where the caller has none.
WRITERS: tuple[BatchWriter, ...] = (
    BatchWriter("json", "application/json", "application/json", "documents:write_json"),
    BatchWriter("csv", "text/csv", "text/csv; charset=utf-8; header=present", "tables:write_csv"),
    BatchWriter("arrow", ARROW_STREAM, ARROW_STREAM, "tables:write_arrow"),
    BatchWriter("parquet", PARQUET, PARQUET, "tables:write_parquet"),
    BatchWriter("ndjson", NDJSON, NDJSON, "documents:write_ndjson", is_streamed=True),
    BatchWriter("geojson", GEOJSON, GEOJSON, "documents:write_geojson"),
)


def choose_reader(content_type: str | None, content_encoding: str | None) -> BatchReader:
    """Codec of a body (415 if there is none)."""
    return READERS[media_type_of(content_type, content_encoding, tuple(READERS))]


def choose_writer(accept: str | None, asked: BatchFormat | None) -> BatchWriter:
    """Format of the answer: ``?format=`` first, then ``Accept`` (406 if none is accepted).

    Examples
    --------
    >>> choose_writer("application/geo+json, text/csv;q=0.5", None).name
    'geojson'
    """
    return choose_offer(WRITERS, accept, asked)
