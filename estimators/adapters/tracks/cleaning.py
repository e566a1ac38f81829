"""A recording cleaned without ever being held as a whole answer: :func:`clean_recording`.

It gives pieces of the answer beside the rows that they are about, which
:mod:`estimators.adapters.tracks.streaming` writes.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np

from estimators.adapters.tracks.cleaned import Cleaned
from estimators.adapters.tracks.recording import Recording
from estimators.adapters.tracks.spool import Spool, open_spool
from estimators.arrays import FloatArray, IntArray
from estimators.result import NoFit
from estimators.trajectories.clean import clean_in_pieces
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.pieces import TrackFacts, TrackPiece, TrackPieces

Pairs: TypeAlias = Iterator[tuple[Recording, Cleaned]]
"""Rows of a recording, and what a cleaner says of them."""

OTHERS = ("residual_m", "sigma_m", "speed_mps", "speed_sigma_mps", "heading_deg", "heading_sigma_deg")
"""What is written of each fix beside its place and label."""
_PIECE_ROWS = 1 << 16


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
        self.method, self._level, self._options = method, level, options
        self.facts: dict[str | None, TrackFacts | NoFit] = {}

    def __iter__(self) -> Pairs:
        """Give rows with their answer: devices in order of first appearance, their rows in input order."""
        for device, rows in _devices_of(self._recording):
            own = self._recording.part(rows)
            answer = self._begin(device, own)
            if isinstance(answer, TrackPieces) and not answer.in_input_order:
                with open_spool(len(own)) as spool:
                    self._keep(device, slice(0, len(own)), answer, spool)
                    del answer  # It holds more than the file does.
                    yield from spool.pairs(own)
            else:
                for part, cleaned in self._said(device, answer):
                    yield own.part(part), cleaned

    def arranged(self, order: IntArray | None = None) -> Pairs:
        """Give rows with their answer in the order of the recording, or in another.

        Of several devices nothing is given before all of them have been cleaned; what is said of them is on
        disk until then. The same holds of rows in disorder.

        Parameters
        ----------
        order : ndarray of int64, shape (n,), optional
            All rows. Default: as the recording has them.

        Raises
        ------
        InputError
            While iterating, as :func:`estimators.clean_trajectory`.
        OSError
            While iterating, if the temporary file cannot be written.
        """
        if self._recording.device is None and order is None:
            return iter(self)
        return self._all(order)

    def _all(self, order: IntArray | None) -> Pairs:
        with open_spool(len(self._recording)) as spool:
            for device, rows in _devices_of(self._recording):
                self._keep(device, rows, self._begin(device, self._recording.part(rows)), spool)
            yield from spool.pairs(self._recording, order)

    def _begin(self, device: str | None, own: Recording) -> TrackPieces | NoFit:
        found = clean_in_pieces(
            own.time,
            own.lat,
            own.lon,
            height_m=own.height_m,
            accuracy_m=own.radius_m,
            speed_mps=own.speed_mps,
            bearing_deg=own.bearing_deg,
            method=self.method,
            level=self._level,
            options=self._options,
            piece_rows=_PIECE_ROWS,
        )
        if isinstance(found, NoFit):
            self.facts[device] = found
        return found

    def _said(
        self, device: str | None, found: TrackPieces | NoFit
    ) -> Iterator[tuple[slice | IntArray, Cleaned]]:
        """Rows of a device, as they have their turn, and what is said of them."""
        if isinstance(found, NoFit):
            yield slice(0, found.points.inlier.size), _nothing(found)
            return
        first = 0
        for piece in found:
            in_order = slice(first, first + len(piece))
            yield in_order if found.in_input_order else piece.rows, _cleaned(piece)
            first += len(piece)
        self.facts[device] = found.facts()

    def _keep(
        self, device: str | None, rows: slice | IntArray, found: TrackPieces | NoFit, spool: Spool
    ) -> None:
        for part, cleaned in self._said(device, found):
            spool.put(_among(rows, part), cleaned)


def clean_recording(
    recording: Recording,
    *,
    method: str = "auto",
    level: float = 0.95,
    options: TrackOptions | None = None,
) -> CleanedRecording:
    r"""Clean every device of a recording, piece by piece.

    What is held beside the recording is about 50 bytes per row of one device, and 24 more where it reports
    speeds. The answer of a device whose rows are in disorder, or lack times, waits in a temporary file, about
    80 bytes per row.

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


def _devices_of(recording: Recording) -> Iterator[tuple[str | None, slice | IntArray]]:
    """Name and rows of each device, in order of first appearance; a slice where they are on end."""
    if recording.device is None:
        yield recording.devices[0] if recording.devices else None, slice(0, len(recording))
        return
    devices = recording.device
    order = np.argsort(devices, kind="stable") if (devices[1:] < devices[:-1]).any() else None
    edges = np.searchsorted(devices, np.arange(len(recording.devices) + 1), sorter=order).tolist()
    for name, first, stop in zip(recording.devices, edges[:-1], edges[1:], strict=True):
        if stop > first:
            yield name, slice(first, stop) if order is None else order[first:stop]


def _among(rows: slice | IntArray, part: slice | IntArray) -> slice | IntArray:
    """Rows of a part of some rows."""
    if not isinstance(rows, slice):
        some: IntArray = rows[part]
        return some
    if isinstance(part, slice):
        return slice(rows.start + part.start, rows.start + part.stop)
    return part + int(rows.start)


def _cleaned(piece: TrackPiece) -> Cleaned:
    return Cleaned(
        piece.lat_deg,
        piece.lon_deg,
        piece.height_m,
        piece.points.inlier,
        piece.points.probability,
        piece.points.reason,
        {name: getattr(piece.points if name == "residual_m" else piece, name) for name in OTHERS},
    )


def _nothing(found: NoFit) -> Cleaned:
    """Rows of a device without a track: the reason why is that of the rows that are sound in themselves."""
    unknown: FloatArray = np.full(found.points.inlier.size, np.nan)
    reasons = [found.reason.value if word == "ok" else word for word in found.points.reason]
    others = dict.fromkeys(OTHERS, unknown)
    return Cleaned(unknown, unknown, None, found.points.inlier, unknown, reasons, others)
