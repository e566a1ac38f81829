"""Which codec reads fixes and which writes tracks. A new format is one file and one line here.

Codecs are named, and imported when a body or an answer asks for one: Arrow takes long to import.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, cast

from service.codecs.batch.registry import ARROW_FILE, ARROW_STREAM, GEOJSON, PARQUET
from service.codecs.offers import Offer, choose_offer
from service.errors import invalid_value
from service.schemas.trajectories import TrackAnswerQuery, TrackFormat, TrackQuery

if TYPE_CHECKING:
    from service.codecs.sent import Sent
    from service.schemas.trajectories import TrackArguments
    from service.trajectories.cleaned import CleanedTracks
    from service.trajectories.recorded import Recorded

UPLOAD = "multipart/form-data"
GPX = "application/gpx+xml"


@dataclass(frozen=True, slots=True)
class TrackReader:
    """A format of bodies.

    Attributes
    ----------
    codec : str
        ``module:function`` in this package.
    """

    codec: str

    def read(self, sent: Sent[TrackQuery]) -> tuple[Recorded, TrackArguments]:
        """Read and check the fixes of a body, and the arguments."""
        reader = cast("Callable[[Sent[TrackQuery]], tuple[Recorded, TrackArguments]]", _find(self.codec))
        return reader(sent)


@dataclass(frozen=True, slots=True)
class TrackWriter(Offer[TrackFormat]):
    """A format of answers.

    Attributes
    ----------
    codec : str
        ``module:function`` in this package.
    needs_moments : bool
        Whether times have to be points in time.
    is_picture : bool
        Whether it shows one track.
    """

    codec: str
    needs_moments: bool = False
    is_picture: bool = False

    def write(self, cleaned: CleanedTracks, query: TrackAnswerQuery) -> Iterator[bytes]:
        """Bytes of an answer, piece by piece."""
        writer = cast("Callable[[CleanedTracks, TrackAnswerQuery], Iterator[bytes]]", _find(self.codec))
        return writer(cleaned, query)

    def check(self, recorded: Recorded) -> None:
        """Refuse before the work what cannot be written after it.

        Raises
        ------
        Problem
            422 if the format needs points in time and there are plain numbers, or is a picture and there are
            several tracks.
        """
        tracks = len(recorded.recording.devices)
        if self.is_picture and tracks > 1:
            raise invalid_value(
                "format", f"{self.name} shows one track and there are {tracks}; send one, or ask for another"
            )
        if self.needs_moments and recorded.time.dtype.kind != "M":
            raise invalid_value(
                "format",
                f"{self.name} needs points in time and these are plain numbers; say their time_unit, or ask "
                "for another format",
            )


def _find(codec: str) -> Any:
    return resolve_name(f"service.codecs.trajectories.{codec}")


_FILE = TrackReader("files:read_body_file")

#: The content of a file tells what it is; its media type only that it is a file.
READERS: dict[str, TrackReader] = {
    "application/json": TrackReader("columns:read_json_fixes"),
    "text/csv": _FILE,
    GPX: _FILE,
    "application/vnd.google-earth.kml+xml": _FILE,
    "application/vnd.google-earth.kmz": _FILE,
    GEOJSON: _FILE,
    "application/vnd.ant.fit": _FILE,
    "application/vnd.nmea": _FILE,
    ARROW_STREAM: _FILE,
    ARROW_FILE: _FILE,
    PARQUET: _FILE,
    "application/octet-stream": _FILE,
    UPLOAD: TrackReader("files:read_upload"),
}

#: In the order of preference where the caller has none.
WRITERS: tuple[TrackWriter, ...] = (
    TrackWriter("json", "application/json", "application/json", "documents:write_json"),
    TrackWriter("geojson", GEOJSON, GEOJSON, "files_out:write_geojson"),
    TrackWriter("gpx", GPX, GPX, "files_out:write_gpx", needs_moments=True),
    TrackWriter("csv", "text/csv", "text/csv; charset=utf-8; header=present", "files_out:write_csv"),
    TrackWriter("arrow", ARROW_STREAM, ARROW_STREAM, "binary:write_arrow"),
    TrackWriter("parquet", PARQUET, PARQUET, "binary:write_parquet"),
    TrackWriter("svg", "image/svg+xml", "image/svg+xml", "pictures:write_svg", is_picture=True),
    TrackWriter("png", "image/png", "image/png", "pictures:write_png", is_picture=True),
)


def choose_track_writer(accept: str | None, asked: str | None) -> TrackWriter:
    """Format of the answer: ``?format=`` first, then ``Accept`` (406 if none is accepted).

    Examples
    --------
    >>> choose_track_writer("application/gpx+xml, text/csv;q=0.5", None).name
    'gpx'
    """
    return choose_offer(WRITERS, accept, asked)
