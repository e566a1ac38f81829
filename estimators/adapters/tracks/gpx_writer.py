"""A cleaned track as GPX 1.1: :func:`write_gpx`.

A device is a track, a segment a segment. Positions are the cleaned ones; what the schema has no element for
stands in extensions of a namespace of our own, flags and recorded positions too, so that nothing is lost.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Generator, Iterable, Iterator
from dataclasses import replace
from typing import TypeAlias
from xml.sax.saxutils import escape

import numpy as np

from estimators.adapters.tracks.cleaned import Cleaned
from estimators.adapters.tracks.recording import Recording
from estimators.adapters.tracks.written_columns import (
    PIECE_ROWS,
    Column,
    Layout,
    positions,
    written_columns,
)
from estimators.arrays import InputError, IntArray

NAMESPACE = "urn:plumbline:track:1"
_HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<gpx version="1.1" creator="Plumbline" xmlns="http://www.topografix.com/GPX/1/1"'
    f' xmlns:pl="{NAMESPACE}">\n'
)
_ELEMENTS = {"height_m": "ele", "time": "time", "satellites": "sat", "hdop": "hdop"}
"""Columns that GPX has an element for, in the order that its schema asks for."""
_ABOVE = frozenset({"lat", "lon", "device", "segment"})
Place: TypeAlias = tuple[str | None, int]
"""Device and segment of a point."""
_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_gpx(recording: Recording, cleaned: Cleaned | None = None) -> Iterator[bytes]:
    r"""Write tracks, segments and points.

    Parameters
    ----------
    recording : Recording
    cleaned : Cleaned, optional
        Default: the recording as it is.

    Returns
    -------
    iterator of bytes
        Pieces of the file. Rows without a position to write are left out: a point of GPX must have one.

    Raises
    ------
    InputError
        If the recording's times are plain numbers, which GPX cannot hold.

    Examples
    --------
    >>> from estimators.adapters.tracks import read_track
    >>> track = read_track(b"time,lat,lon\n2021-07-28T09:19:04+02:00,48.83,2.44\n")
    >>> print(b"".join(write_gpx(track)).decode().splitlines()[4])
    <trkpt lat="48.8300000" lon="2.4400000"><time>2021-07-28T09:19:04+02:00</time></trkpt>
    """
    _refuse_numbers(recording)
    columns = written_columns(recording, cleaned)
    lat, lon, _ = positions(recording, cleaned)
    rows = np.flatnonzero(np.isfinite(lat) & np.isfinite(lon))
    order = grouped_order(recording.part(rows))
    return _pieces(recording, columns, rows if order is None else rows[order])


def stream_gpx(pairs: Iterable[tuple[Recording, Cleaned]], layout: Layout) -> Iterator[bytes]:
    """Write points as they come, a new track where the device changes and a new segment where that does.

    Raises
    ------
    InputError
        If the times are plain numbers, which GPX cannot hold.
    """
    layout = replace(layout, epoch=None)
    yield _HEAD.encode()
    last: Place | None = None
    for recording, cleaned in pairs:
        _refuse_numbers(recording)
        rows = np.flatnonzero(np.isfinite(cleaned.lat) & np.isfinite(cleaned.lon))
        last = yield from _track_points(recording, written_columns(recording, cleaned, layout), rows, last)
    yield _closing(last, closes_track=True) + b"</gpx>\n"


def grouped_order(recording: Recording) -> IntArray | None:
    """Rows by device and segment, in input order within them; None where they come so.

    Examples
    --------
    >>> track = Recording("csv", np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3, dtype=np.uint8))
    >>> grouped_order(track) is None, grouped_order(replace(track, segment=np.array([0, 1, 0]))).tolist()
    (True, [0, 2, 1])
    """
    keys = [key for key in (recording.segment, recording.device) if key is not None]
    descends = np.zeros(max(len(recording) - 1, 0), dtype=np.bool_)
    for key in keys:
        # The last key is the device, which goes before the segment.
        descends = (key[1:] < key[:-1]) | ((key[1:] == key[:-1]) & descends)
    return np.lexsort(keys) if descends.any() else None


def _track_points(
    recording: Recording, columns: dict[str, Column], rows: IntArray, last: Place | None
) -> Generator[bytes, None, Place | None]:
    """Write rows in the order given, after what was written last; returns where that leaves off."""
    device, segment = _keys(recording, rows)
    for start, stop in _runs(device, segment):
        name = recording.devices[device[start]] if recording.devices else None
        here = (name, int(segment[start]))
        if here != last:
            is_new = last is None or last[0] != name
            yield _closing(last, closes_track=is_new) + _opening(name, opens_track=is_new)
            last = here
        for at in range(start, stop, PIECE_ROWS):
            yield "".join(_points(columns, rows[at : min(at + PIECE_ROWS, stop)])).encode()
    return last


def _closing(last: Place | None, *, closes_track: bool) -> bytes:
    if last is None:
        return b""
    return b"</trkseg>\n</trk>\n" if closes_track else b"</trkseg>\n"


def _opening(name: str | None, *, opens_track: bool) -> bytes:
    if not opens_track:
        return b"<trkseg>\n"
    named = "" if name is None else f"<name>{_escaped(name)}</name>\n"
    return f"<trk>\n{named}<trkseg>\n".encode()


def _refuse_numbers(recording: Recording) -> None:
    if recording.time.dtype.kind != "M":
        raise InputError("time", "GPX needs points in time, and this track has plain numbers; write CSV")


def _keys(recording: Recording, rows: IntArray) -> tuple[IntArray, IntArray]:
    """Device and segment of rows."""
    device = np.zeros(rows.size, dtype=np.int64) if recording.device is None else recording.device[rows]
    segment = np.zeros(rows.size, dtype=np.int64) if recording.segment is None else recording.segment[rows]
    return device, segment


def _runs(device: IntArray, segment: IntArray) -> list[tuple[int, int]]:
    """First and last + 1 of rows on end of one device and segment."""
    changes = np.flatnonzero((np.diff(device) != 0) | (np.diff(segment) != 0)) + 1
    edges = [0, *changes.tolist(), device.size] if device.size else []
    return list(itertools.pairwise(edges))


def _pieces(recording: Recording, columns: dict[str, Column], rows: IntArray) -> Iterator[bytes]:
    yield _HEAD.encode()
    last = yield from _track_points(recording, columns, rows, None)
    yield _closing(last, closes_track=True) + b"</gpx>\n"


def _points(columns: dict[str, Column], rows: IntArray) -> Iterator[str]:
    inside = {name: columns[name].text(rows) for name in _ELEMENTS if name in columns}
    extra = {
        name: column.text(rows)
        for name, column in columns.items()
        if name not in _ABOVE and name not in _ELEMENTS
    }
    for row, (lat, lon) in enumerate(zip(columns["lat"].text(rows), columns["lon"].text(rows), strict=True)):
        body = "".join(
            f"<{tag}>{text}</{tag}>"
            for name, tag in _ELEMENTS.items()
            if name in inside and (text := inside[name][row]) is not None
        )
        more = "".join(
            f"<pl:{name}>{_escaped(text)}</pl:{name}>"
            for name, texts in extra.items()
            if (text := texts[row]) is not None
        )
        if more:
            body += f"<extensions>{more}</extensions>"
        yield f'<trkpt lat="{lat}" lon="{lon}">{body}</trkpt>\n'


def _escaped(text: str) -> str:
    """Text of an element; characters that XML 1.0 has no way to write are left out."""
    return escape(_NOT_XML.sub("", text))
