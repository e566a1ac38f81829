"""GPX 1.0 and 1.1 to a :class:`Recording`: track points, their segments, and usual extensions.

The formats are Topografix' schemas of 2002 and 2004. Routes and waypoints are plans and places, not tracks,
and are passed over. Speed and course stand in the point in 1.0, and in extensions in 1.1, under names that
Garmin's TrackPointExtension, Android loggers and our own writer use.
"""

from __future__ import annotations

import numpy as np

from estimators.adapters.tracks.assembly import assemble, code_names
from estimators.adapters.tracks.moments import parse_moments
from estimators.adapters.tracks.numbers import parse_numbers
from estimators.adapters.tracks.recording import FIELD, Recording
from estimators.arrays import InputError, IntArray

MEASURED = {
    "ele": "height_m",
    "hdop": "hdop",
    "sat": "satellites",
    "speed": "speed_mps",
    "speed_mps": "speed_mps",
    "course": "bearing_deg",
    "bearing": "bearing_deg",
    "bearing_deg": "bearing_deg",
    "accuracy": "accuracy_m",
    "hacc": "accuracy_m",
    "accuracy_m": "accuracy_m",
    "ellipse_major_m": "ellipse_major_m",
    "ellipse_minor_m": "ellipse_minor_m",
    "ellipse_bearing_deg": "ellipse_bearing_deg",
}
"""Elements of a point in GPX, and the columns they fill."""


class GpxReader:
    """Collects the track points of a document, element by element."""

    def __init__(self) -> None:
        self._lat: list[str | None] = []
        self._lon: list[str | None] = []
        self._time: list[str | None] = []
        self._segment: list[int] = []
        self._device: list[int] = []
        self._names: list[str] = []
        self._measured: dict[str, dict[int, str]] = {}
        self._in_point = False
        self._in_track = False
        self._pieces = 0
        self._passed_over: set[str] = set()
        self._path: list[str] = []

    def start(self, name: str, attributes: dict[str, str]) -> None:
        """Open an element."""
        self._path.append(name)
        if name == "trkpt" and self._in_track:
            self._in_point = True
            self._lat.append(attributes.get("lat"))
            self._lon.append(attributes.get("lon"))
            self._time.append(None)
            self._segment.append(self._pieces)
            self._device.append(len(self._names) - 1)
        elif name == "trkseg":
            self._pieces += 1
        elif name == "trk":
            self._in_track = True
            self._names.append("")
        elif name in {"rtept", "wpt"}:
            self._passed_over.add({"rtept": "routes", "wpt": "waypoints"}[name])

    def end(self, name: str, text: str) -> None:
        """Close an element."""
        self._path.pop()
        if name == "trkpt":
            self._in_point = False
        elif name == "trk":
            self._in_track = False
        elif self._in_point:
            if name == "time" and self._time[-1] is None:
                self._time[-1] = text
            elif name in MEASURED:
                # The first wins: a point's own element comes before its extensions.
                self._measured.setdefault(MEASURED[name], {}).setdefault(len(self._lat) - 1, text)
        elif name == "name" and self._in_track and self._path[-1] == "trk":
            self._names[-1] = text.strip()

    def recording(self) -> Recording:
        """All points as columns.

        Raises
        ------
        InputError
            If there is no track point, or none has a time.
        """
        n = len(self._lat)
        if n == 0:
            only = " and ".join(sorted(self._passed_over))
            instead = f"only {only}, which are no tracks" if only else "no track points"
            raise InputError(FIELD, f"is GPX that holds {instead}; export the recorded track (trk, trkpt)")
        lat, bad_lat = parse_numbers(self._lat)
        lon, bad_lon = parse_numbers(self._lon)
        time, offsets, bad_time = parse_moments(self._time)
        measured = {}
        for column, found in self._measured.items():
            values = np.full(n, np.nan)
            values[list(found)] = parse_numbers(list(found.values()))[0]
            measured[column] = values
        device, devices = self._devices()
        return assemble(
            "gpx",
            time=time,
            lat=lat,
            lon=lon,
            time_unreadable=bad_time,
            position_unreadable=bad_lat | bad_lon,
            offsets=offsets,
            measured=measured,
            device=device,
            devices=devices,
            segment=np.unique(np.array(self._segment, dtype=np.int64), return_inverse=True)[1],
        )

    def _devices(self) -> tuple[IntArray, tuple[str, ...]]:
        """Tracks as devices; where there are several, those without a name are told by their number."""
        used = sorted(set(self._device))
        if len(used) == 1 and not self._names[used[0]]:
            return np.zeros(len(self._device), dtype=np.int64), ()
        return code_names(self._names[place] or f"track {place + 1}" for place in self._device)
