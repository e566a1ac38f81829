"""KML's gx:Track and gx:MultiTrack to a :class:`Recording`, plain or from a KMZ archive.

The tags are those of Google's extension of KML 2.2 and of OGC KML 2.3: ``when`` and ``coord`` in equal
number, in any order, and arrays of what else was measured (``SimpleArrayData``).
"""

from __future__ import annotations

from itertools import chain

import numpy as np

from estimators.adapters.tracks.assembly import assemble, code_names
from estimators.adapters.tracks.moments import parse_moments
from estimators.adapters.tracks.numbers import parse_numbers
from estimators.adapters.tracks.recording import FIELD, Recording
from estimators.arrays import InputError

_MEASURED = {
    "speed": "speed_mps",
    "bearing": "bearing_deg",
    "course": "bearing_deg",
    "heading": "bearing_deg",
    "accuracy": "accuracy_m",
    "satellites": "satellites",
    "hdop": "hdop",
}


class _Track:
    """One gx:Track while it is read."""

    def __init__(self, device: str) -> None:
        self.device = device
        self.when: list[str | None] = []
        self.coord: list[str] = []
        self.arrays: dict[str, list[str | None]] = {}


class KmlReader:
    """Collects the tracks of a document, element by element."""

    def __init__(self) -> None:
        self._tracks: list[_Track] = []
        self._open: _Track | None = None
        self._array: list[str | None] | None = None
        self._path: list[str] = []
        self._placemarks: list[str] = []

    def start(self, name: str, attributes: dict[str, str]) -> None:
        """Open an element."""
        self._path.append(name)
        if name == "Placemark":
            self._placemarks.append("")
        elif name == "Track":
            self._open = _Track(self._placemarks[-1] if self._placemarks else "")
            self._tracks.append(self._open)
        elif name == "SimpleArrayData" and self._open is not None:
            column = _MEASURED.get(attributes.get("name", "").lower())
            self._array = None if column is None else self._open.arrays.setdefault(column, [])

    def end(self, name: str, text: str) -> None:
        """Close an element."""
        self._path.pop()
        track = self._open
        if name == "Track":
            self._open = None
        elif name == "SimpleArrayData":
            self._array = None
        elif track is not None and name == "when":
            track.when.append(text)
        elif track is not None and name == "coord":
            track.coord.append(text)
        elif name == "value" and self._array is not None:
            self._array.append(text)
        elif name == "name" and self._path and self._path[-1] == "Placemark":
            self._placemarks[-1] = text.strip()

    def recording(self) -> Recording:
        """All points as columns.

        Raises
        ------
        InputError
            If there is no gx:Track, or its times and coordinates differ in number.
        """
        tracks = [track for track in self._tracks if track.coord or track.when]
        if not tracks:
            raise InputError(
                FIELD, "is KML without a gx:Track that has points; lines without times cannot be cleaned"
            )
        for track in tracks:
            if len(track.when) != len(track.coord):
                raise InputError(
                    FIELD, f"has a gx:Track with {len(track.when)} times and {len(track.coord)} coordinates"
                )
        cells = [text.split()[:3] for track in tracks for text in track.coord]
        lon, bad_lon = parse_numbers([cell[0] if cell else None for cell in cells])
        lat, bad_lat = parse_numbers([cell[1] if len(cell) > 1 else None for cell in cells])
        time, offsets, bad_time = parse_moments(list(chain.from_iterable(track.when for track in tracks)))
        measured = {"height_m": parse_numbers([cell[2] if len(cell) > 2 else None for cell in cells])[0]}
        for column in sorted(set().union(*(track.arrays for track in tracks))):
            values = [_filled(track, column) for track in tracks]
            measured[column] = parse_numbers(list(chain.from_iterable(values)))[0]
        sizes = [len(track.when) for track in tracks]
        device, devices = code_names(track.device for track in tracks)
        return assemble(
            "kml",
            time=time,
            lat=lat,
            lon=lon,
            time_unreadable=bad_time,
            position_unreadable=bad_lat | bad_lon,
            offsets=offsets,
            measured=measured,
            device=np.repeat(device, sizes),
            devices=devices if any(devices) else (),
            segment=np.repeat(np.arange(len(tracks), dtype=np.int64), sizes),
        )


def _filled(track: _Track, column: str) -> list[str | None]:
    """Fill an array of a track; as missing where its length is not the track's."""
    values = track.arrays.get(column, [])
    return values if len(values) == len(track.when) else [None] * len(track.when)
