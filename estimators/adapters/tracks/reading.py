"""A track file of any known format to a :class:`Recording`, told apart by its content: :func:`read_track`."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from pathlib import Path

from estimators.adapters.tracks.csv_reader import read_csv
from estimators.adapters.tracks.fit_reader import SIGNATURE, read_fit
from estimators.adapters.tracks.geojson_reader import read_geojson
from estimators.adapters.tracks.gpx_reader import GpxReader
from estimators.adapters.tracks.kml_reader import KmlReader
from estimators.adapters.tracks.nmea_reader import SENTENCE, read_nmea
from estimators.adapters.tracks.recording import FIELD, Recording
from estimators.adapters.tracks.source import MOST_BYTES, Source, open_track
from estimators.adapters.tracks.table_reader import ARROW_FILE, ARROW_STREAM, PARQUET, read_table
from estimators.adapters.tracks.times import TimeUnit
from estimators.adapters.tracks.xml_stream import read_xml
from estimators.arrays import InputError

_HEAD_BYTES = 1 << 14
_NOT_TRACKS = {
    b"%PDF": "a PDF document",
    b"\x89PNG": "a picture",
    b"\xff\xd8\xff": "a picture; its place in Exif data is one fix, not a track",
    b"\xd0\xcf\x11\xe0": "an old Excel workbook; save the sheet as CSV",
    b"SQLite format 3": "a database; export the track",
}
_MARK = b"\xef\xbb\xbf"


def read_track(
    source: Source,
    *,
    columns: Mapping[str, str] | None = None,
    time_unit: TimeUnit | None = None,
    most_bytes: int = MOST_BYTES,
    check: Callable[[], object] | None = None,
) -> Recording:
    r"""Read a recorded track.

    Parameters
    ----------
    source : bytes or Path
        GPX 1.0 or 1.1, GeoJSON, KML with gx:Track (or KMZ), FIT, NMEA 0183, CSV, Parquet or Arrow, each also
        packed by gzip. The content tells which.
    columns : mapping of str to str, optional
        For tables: names in the file of ``time``, ``lat``, ``lon``, ``device``, ``height_m``, ... where they
        are not the usual ones.
    time_unit : {"s", "ms", "us", "ns"}, optional
        For tables: times are numbers of these since 1970. Default: finer units than seconds are told by their
        size; seconds stay plain numbers.
    most_bytes : int
        Unpacked size above which a file is refused. Default: 1 GiB.
    check : callable, optional
        Called between pieces of the file; it may raise to end the reading.

    Returns
    -------
    Recording
        One row per fix of the file, in its order; ``fault`` tells which could not be read.

    Raises
    ------
    InputError
        If the file is of no known format, damaged, or holds no track with times; of the subclass
        :class:`~estimators.adapters.tracks.source.TooLargeError` if it is too large.

    Examples
    --------
    >>> rows = b"2021-07-28T09:19:04+02:00,48.83,2.44\n2021-07-28T09:19:05+02:00,91,2.44\n"
    >>> track = read_track(b"time,lat,lon\n" + rows)
    >>> track.form, track.lat, track.fault, track.utc_offset_minutes
    ('csv', array([48.83,   nan]), array([0, 2], dtype=uint8), array([120, 120], dtype=int16))
    """
    with open_track(source, most_bytes, check) as stream:
        head = stream.peek(_HEAD_BYTES)[:_HEAD_BYTES]
        form = _form_of(head)
        if form == "xml":
            return _read_xml(stream)
        if form == "geojson":
            return read_geojson(stream)
        if form == "fit":
            return read_fit(stream)
        if form == "nmea":
            return read_nmea(stream)
        if form == "table":
            path = source if isinstance(source, Path) else None
            return read_table(stream, columns=columns, time_unit=time_unit, most_bytes=most_bytes, path=path)
        return read_csv(stream, columns=columns, time_unit=time_unit)


def _form_of(head: bytes) -> str:
    if head.startswith((PARQUET, ARROW_FILE, ARROW_STREAM)):
        return "table"
    if head[8:12] == SIGNATURE:
        return "fit"
    what = next((what for magic, what in _NOT_TRACKS.items() if head.startswith(magic)), None)
    if what is not None:
        raise InputError(FIELD, f"is {what}")
    wide = head[:2] in {b"\xff\xfe", b"\xfe\xff"}
    text = head.replace(b"\0", b"") if wide else head
    text = text.removeprefix(_MARK).removeprefix(b"\xff\xfe").removeprefix(b"\xfe\xff").lstrip()
    if not text:
        raise InputError(FIELD, "is empty")
    if text.startswith(b"<"):
        return "xml"
    if b"\0" in text:
        raise InputError(FIELD, "is of no known format; send GPX, GeoJSON, KML, FIT, NMEA, CSV or Parquet")
    if text.startswith((b"{", b"[")):
        return "geojson"
    return "nmea" if SENTENCE.search(text.decode("latin-1")) else "csv"


def _read_xml(stream: io.BufferedReader) -> Recording:
    document = _Document()
    read_xml(stream, document)
    if document.format is None:
        raise InputError(FIELD, "has no elements")
    return document.format.recording()


class _Document:
    """Hands the elements of an XML document to the reader of its outermost one."""

    def __init__(self) -> None:
        self.format: GpxReader | KmlReader | None = None

    def start(self, name: str, attributes: dict[str, str]) -> None:
        """Open an element."""
        if self.format is None:
            readers: dict[str, type[GpxReader] | type[KmlReader]] = {"gpx": GpxReader, "kml": KmlReader}
            if name not in readers:
                known = (
                    "TCX; export it as GPX or FIT"
                    if name == "TrainingCenterDatabase"
                    else "neither GPX nor KML"
                )
                raise InputError(FIELD, f"is XML but {known}")
            self.format = readers[name]()
        self.format.start(name, attributes)

    def end(self, name: str, text: str) -> None:
        """Close an element."""
        if self.format is not None:
            self.format.end(name, text)
