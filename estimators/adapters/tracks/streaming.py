"""A cleaned recording written without ever being held as text: :func:`stream_track`, :func:`clean_file`.

A new format that is written piece by piece is a function and one row of :data:`STREAMS`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import IO

from estimators.adapters.tracks.cleaned import Cleaned
from estimators.adapters.tracks.cleaning import clean_recording
from estimators.adapters.tracks.csv_writer import stream_csv
from estimators.adapters.tracks.geojson_writer import stream_geojson_points
from estimators.adapters.tracks.gpx_writer import grouped_order, stream_gpx
from estimators.adapters.tracks.reading import read_track
from estimators.adapters.tracks.recording import Recording
from estimators.adapters.tracks.source import MOST_BYTES, Source
from estimators.adapters.tracks.table_writer import stream_arrow, stream_parquet
from estimators.adapters.tracks.times import TimeUnit
from estimators.adapters.tracks.written_columns import Layout, layout_of
from estimators.arrays import InputError, IntArray
from estimators.result import NoFit
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.pieces import TrackFacts


def _as_they_came(_recording: Recording) -> IntArray | None:
    return None


@dataclass(frozen=True, slots=True)
class Stream:
    """A format that is written piece by piece.

    Attributes
    ----------
    write : callable
        From rows with what is said of them, and the layout of the whole, to pieces of the file.
    order : callable
        From a recording to the order in which the format has its rows; None: as they came.
    """

    write: Callable[[Iterable[tuple[Recording, Cleaned]], Layout], Iterator[bytes]]
    order: Callable[[Recording], IntArray | None] = _as_they_came


STREAMS: Mapping[str, Stream] = MappingProxyType(
    {
        "csv": Stream(stream_csv),
        "geojson": Stream(stream_geojson_points),
        "gpx": Stream(stream_gpx, grouped_order),
        "parquet": Stream(stream_parquet),
        "arrow": Stream(stream_arrow),
    }
)
"""Formats that are written piece by piece."""


def stream_track(
    recording: Recording,
    cleaned: Iterable[tuple[Recording, Cleaned]],
    form: str,
    *,
    epoch: TimeUnit | None = None,
    method: str = "",
) -> Iterator[bytes]:
    """Write a recording with its answer, piece by piece.

    Parameters
    ----------
    recording : Recording
        The whole: it tells how many digits are written.
    cleaned : iterable
        Rows and what is said of them, in the order in which they are written: that of :func:`row_order`, if
        the file is to be the one that is made of the whole.
    form : str
        A key of :data:`STREAMS`.
    epoch : {"s", "ms", "us", "ns"}, optional
        Points in time are written as numbers of these since 1970; GPX has no numbers.
    method : str
        Noted in the metadata of Parquet and Arrow. Default: not.

    Returns
    -------
    iterator of bytes
        Pieces of the file.

    Raises
    ------
    InputError
        If the form is unknown, or cannot hold the recording.
    """
    stream = _stream_of(form)
    return stream.write(cleaned, layout_of(recording, epoch=epoch, method=method))


def row_order(recording: Recording, form: str) -> IntArray | None:
    """Order in which a format has the rows of a recording; None: as they came.

    Raises
    ------
    InputError
        If the form is unknown.
    """
    return _stream_of(form).order(recording)


def clean_file(
    source: Source,
    sink: IO[bytes],
    form: str = "csv",
    *,
    method: str = "auto",
    level: float = 0.95,
    options: TrackOptions | None = None,
    columns: Mapping[str, str] | None = None,
    time_unit: TimeUnit | None = None,
    most_bytes: int = MOST_BYTES,
) -> dict[str | None, TrackFacts | NoFit]:
    r"""Clean a track file into another.

    Parameters
    ----------
    source : bytes or Path
    sink : binary file
    form : str
        Of what is written: a key of :data:`STREAMS`. GeoJSON has a point per row.
    method, level, options
        As for :func:`estimators.clean_trajectory`.
    columns, time_unit, most_bytes
        As for :func:`read_track`.

    Returns
    -------
    dict
        By device: what holds of its track as a whole, or why there is none.

    Raises
    ------
    InputError
        As :func:`read_track` and :func:`stream_track`.

    Examples
    --------
    >>> import io
    >>> sink = io.BytesIO()
    >>> facts = clean_file(b"t,lat,lon\n0,50,7\n1,50,7.0001\n", sink)
    >>> sink.getvalue().decode().splitlines()[0]  # doctest: +ELLIPSIS
    'time,lat,lon,raw_lat,raw_lon,inlier,probability,reason,residual_m,sigma_m,speed_mps,speed_sigma_mps,...'
    """
    recording = read_track(source, columns=columns, time_unit=time_unit, most_bytes=most_bytes)
    cleaned = clean_recording(recording, method=method, level=level, options=options)
    pairs = cleaned.arranged(row_order(recording, form))
    for piece in stream_track(recording, pairs, form, method=method):
        sink.write(piece)
    return cleaned.facts


def _stream_of(form: str) -> Stream:
    if form not in STREAMS:
        raise InputError("form", f"{form[:40]!r} is not written piece by piece; choose {', '.join(STREAMS)}")
    return STREAMS[form]
