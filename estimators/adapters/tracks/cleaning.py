"""A recording cleaned and written without ever being held as text or as a whole answer.

:func:`clean_recording` gives pieces of the answer beside the rows that they are about, :func:`stream_track`
writes such pieces in any format of :data:`STREAMS`, and :func:`clean_file` does both from file to file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import IO

import numpy as np

from estimators.adapters.tracks.cleaned import Cleaned
from estimators.adapters.tracks.csv_writer import stream_csv
from estimators.adapters.tracks.geojson_writer import stream_geojson_points
from estimators.adapters.tracks.gpx_writer import stream_gpx
from estimators.adapters.tracks.reading import read_track
from estimators.adapters.tracks.recording import Recording
from estimators.adapters.tracks.source import MOST_BYTES, Source
from estimators.adapters.tracks.table_writer import stream_arrow, stream_parquet
from estimators.adapters.tracks.times import TimeUnit
from estimators.adapters.tracks.written_columns import Precision, precision_of
from estimators.arrays import FloatArray, InputError, IntArray
from estimators.result import NoFit
from estimators.trajectories.clean import clean_in_pieces
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.pieces import TrackFacts, TrackPiece, TrackPieces, join_pieces
from estimators.trajectories.reasons import FixReason

Pairs = Iterator[tuple[Recording, Cleaned]]
"""Rows of a recording, and what a cleaner says of them."""

STREAMS: Mapping[str, Callable[[Iterable[tuple[Recording, Cleaned]], Precision], Iterator[bytes]]] = (
    MappingProxyType(
        {
            "csv": stream_csv,
            "geojson": stream_geojson_points,
            "gpx": stream_gpx,
            "parquet": stream_parquet,
            "arrow": stream_arrow,
        }
    )
)
"""Formats that are written piece by piece."""

_PIECE_ROWS = 1 << 16
_NAMES = [reason.name for reason in FixReason]


class CleanedRecording:
    """A recording that is cleaned as one iterates over it, device by device.

    Attributes
    ----------
    facts : dict
        By device (None: the file names none): what holds of its track as a whole, or why there is none.
        Complete after the last piece.
    """

    def __init__(
        self,
        recording: Recording,
        method: str = "auto",
        level: float = 0.95,
        options: TrackOptions | None = None,
    ) -> None:
        self._recording = recording
        self._method, self._level, self._options = method, level, options
        self.facts: dict[str | None, TrackFacts | NoFit] = {}

    def __iter__(self) -> Pairs:
        """Give rows with their answer: devices in order of first appearance, their rows in input order."""
        recording = self._recording
        if recording.device is None:
            yield from self._one(recording.devices[0] if recording.devices else None, recording)
            return
        for place, name in enumerate(recording.devices):
            yield from self._one(name, recording.part(np.flatnonzero(recording.device == place)))

    def _one(self, device: str | None, own: Recording) -> Pairs:
        found = clean_in_pieces(
            own.time,
            own.lat,
            own.lon,
            height_m=own.height_m,
            accuracy_m=own.accuracy_m,
            method=self._method,
            level=self._level,
            options=self._options,
            piece_rows=_PIECE_ROWS,
        )
        if isinstance(found, NoFit):
            self.facts[device] = found
            yield own, _nothing(found)
            return
        first = 0
        for piece in found if found.in_input_order else _in_input_order(found):
            yield own.part(slice(first, first + len(piece))), _cleaned(piece)
            first += len(piece)
        self.facts[device] = found.facts()


def clean_recording(
    recording: Recording,
    *,
    method: str = "auto",
    level: float = 0.95,
    options: TrackOptions | None = None,
) -> CleanedRecording:
    r"""Clean every device of a recording, piece by piece.

    What is held beside the recording is about 50 bytes per row of one device, if its times ascend; the answer
    of a device whose rows are in disorder, or lack times, is held as a whole.

    Parameters
    ----------
    recording : Recording
    method, level, options
        As for :func:`estimators.clean_trajectory`.

    Returns
    -------
    CleanedRecording
        To iterate over once.

    Raises
    ------
    InputError
        While iterating, as :func:`estimators.clean_trajectory`.

    Examples
    --------
    >>> from estimators.adapters.tracks import read_track
    >>> cleaned = clean_recording(read_track(b"t,lat,lon\n0,50,7\n1,50.0001,7\n2,95,7\n"))
    >>> [answer.reason for _, answer in cleaned]
    [['ok', 'ok', 'invalid']]
    >>> cleaned.facts[None].inliers
    2
    """
    return CleanedRecording(recording, method, level, options)


def stream_track(
    recording: Recording, cleaned: Iterable[tuple[Recording, Cleaned]], form: str
) -> Iterator[bytes]:
    """Write a recording with its answer, piece by piece.

    Parameters
    ----------
    recording : Recording
        The whole: it tells how many digits are written.
    cleaned : iterable
        As :func:`clean_recording` gives it.
    form : str
        A key of :data:`STREAMS`.

    Returns
    -------
    iterator of bytes
        Pieces of the file.

    Raises
    ------
    InputError
        If the form is unknown, or cannot hold the recording.
    """
    if form not in STREAMS:
        raise InputError("form", f"{form[:40]!r} is not written piece by piece; choose {', '.join(STREAMS)}")
    return STREAMS[form](cleaned, precision_of(recording))


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
    >>> sink.getvalue().decode().splitlines()[0]
    'time,lat,lon,raw_lat,raw_lon,inlier,probability,reason,residual_m,sigma_m,speed_mps,heading_deg'
    """
    recording = read_track(source, columns=columns, time_unit=time_unit, most_bytes=most_bytes)
    cleaned = clean_recording(recording, method=method, level=level, options=options)
    for piece in stream_track(recording, cleaned, form):
        sink.write(piece)
    return cleaned.facts


def _cleaned(piece: TrackPiece) -> Cleaned:
    others: dict[str, FloatArray] = {
        "residual_m": piece.points.residual_m,
        "sigma_m": piece.sigma_m,
        "speed_mps": piece.speed_mps,
        "heading_deg": piece.heading_deg,
    }
    return Cleaned(
        piece.lat_deg,
        piece.lon_deg,
        piece.height_m,
        piece.points.inlier,
        piece.points.probability,
        piece.points.reason,
        others,
    )


def _nothing(found: NoFit) -> Cleaned:
    n = found.points.inlier.size
    unknown: FloatArray = np.full(n, np.nan)
    others = dict.fromkeys(("residual_m", "sigma_m", "speed_mps", "heading_deg"), unknown)
    return Cleaned(unknown, unknown, None, found.points.inlier, unknown, found.points.reason, others)


def _in_input_order(found: TrackPieces) -> Iterator[TrackPiece]:
    """Put a track in disorder back into its order, for which it is held as a whole."""
    whole = join_pieces(list(found))
    places: IntArray = np.argsort(whole.rows)
    for first in range(0, found.size, _PIECE_ROWS):
        yield whole.part(places[first : first + _PIECE_ROWS])
