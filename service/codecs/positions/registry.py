"""Which codec reads ranges and which writes positions. A new format is one file and one line here.

Codecs are named, and imported when a body or an answer asks for one: Arrow takes long to import.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, cast

from service.codecs.batch.registry import ARROW_FILE, ARROW_STREAM, GEOJSON, PARQUET
from service.codecs.offers import Offer, choose_offer
from service.positions.prepared import Prepared, prepare_recording, prepare_table
from service.schemas.position_query import PositionAnswerQuery, PositionFormat, PositionQuery

if TYPE_CHECKING:
    from service.codecs.positions.columns import RangeColumns, Recording
    from service.codecs.sent import Sent
    from service.positions.located import Located
    from service.schemas.positions import PositionArguments, RecordingArguments

UPLOAD = "multipart/form-data"


@dataclass(frozen=True, slots=True)
class RangeReader:
    """A format of bodies.

    Attributes
    ----------
    codec : str
        ``module:function`` in this package.
    is_recording : bool
        Whether it holds the files of a receiver and no table.
    """

    codec: str
    is_recording: bool = False

    def read(self, sent: Sent[PositionQuery]) -> Prepared:
        """Ranges of a body, read and checked."""
        if self.is_recording:
            files = cast(
                "Callable[[Sent[PositionQuery]], tuple[Recording, RecordingArguments]]", _find(self.codec)
            )
            return prepare_recording(*files(sent), sent.limits, sent.check)
        table = cast(
            "Callable[[Sent[PositionQuery]], tuple[RangeColumns, PositionArguments]]", _find(self.codec)
        )
        return prepare_table(*table(sent), sent.limits)


@dataclass(frozen=True, slots=True)
class PositionWriter(Offer[PositionFormat]):
    """A format of answers.

    Attributes
    ----------
    codec : str
        ``module:function`` in this package.
    is_picture : bool
    """

    codec: str
    is_picture: bool = False

    def write(self, located: Located, query: PositionAnswerQuery) -> bytes:
        """Bytes of an answer."""
        return cast("Callable[[Located, PositionAnswerQuery], bytes]", _find(self.codec))(located, query)


def _find(codec: str) -> Any:
    return resolve_name(f"service.codecs.positions.{codec}")


READERS: dict[str, RangeReader] = {
    "application/json": RangeReader("read:read_json_ranges"),
    "text/csv": RangeReader("read:read_csv_ranges"),
    UPLOAD: RangeReader("upload:read_upload", is_recording=True),
    ARROW_STREAM: RangeReader("tables:read_arrow_ranges"),
    ARROW_FILE: RangeReader("tables:read_arrow_ranges"),
    PARQUET: RangeReader("tables:read_parquet_ranges"),
}

#: In the order of preference where the caller has none.
WRITERS: tuple[PositionWriter, ...] = (
    PositionWriter("json", "application/json", "application/json", "documents:write_json"),
    PositionWriter("csv", "text/csv", "text/csv; charset=utf-8; header=present", "text:write_csv"),
    PositionWriter("arrow", ARROW_STREAM, ARROW_STREAM, "binary:write_arrow"),
    PositionWriter("parquet", PARQUET, PARQUET, "binary:write_parquet"),
    PositionWriter("geojson", GEOJSON, GEOJSON, "documents:write_geojson"),
    PositionWriter("svg", "image/svg+xml", "image/svg+xml", "pictures:write_svg", is_picture=True),
    PositionWriter("png", "image/png", "image/png", "pictures:write_png", is_picture=True),
)


def choose_position_writer(accept: str | None, asked: str | None) -> PositionWriter:
    """Format of the answer: ``?format=`` first, then ``Accept`` (406 if none is accepted).

    Examples
    --------
    >>> choose_position_writer("application/geo+json, text/csv;q=0.5", None).name
    'geojson'
    """
    return choose_offer(WRITERS, accept, asked)
