"""Answers kept on disk until the rows that they are about have their turn: :func:`open_spool`.

A track is cleaned in order of time, and devices one after the other. A file may have its rows in any order,
and what is written of the first row (whether there are heights) may depend on the last device.
"""

from __future__ import annotations

import itertools
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO, Any

import numpy as np
import numpy.typing as npt

from estimators.adapters.tracks.cleaned import Cleaned
from estimators.adapters.tracks.recording import Recording
from estimators.arrays import IntArray

PIECE_ROWS = 1 << 16
"""Rows that are read back at once."""
_OWN = ("lat", "lon", "height_m", "probability")


@contextmanager
def open_spool(size: int) -> Iterator[Spool]:
    """Open a spool in a temporary file that is gone with it.

    Parameters
    ----------
    size : int
        Rows of the recording.

    Raises
    ------
    OSError
        If there is no folder for temporary files.

    Examples
    --------
    >>> answer = Cleaned(np.array([2.0, 1.0]), np.zeros(2), reason=["spike", "ok"])
    >>> with open_spool(2) as spool:
    ...     spool.put(np.array([1, 0]), answer)
    ...     spool.take(slice(0, 2)).lat, spool.take(slice(0, 2)).reason
    (array([1., 2.]), ['ok', 'spike'])
    """
    with tempfile.TemporaryFile(prefix="plumbline-") as file:
        yield Spool(file, size)


class Spool:
    """What is said of every row of a recording, about 80 bytes each.

    Parameters
    ----------
    file : binary file
        Empty; is written, then read.
    size : int
        Rows of the recording. Every one is put once, before any is taken.
    """

    def __init__(self, file: IO[bytes], size: int) -> None:
        self._file = file
        # The smallest integers that tell all rows: for ten million they save 40 MB.
        self._places = np.zeros(size, dtype=np.min_scalar_type(max(size, 1)))
        self._written = 0
        self._words: dict[str, int] = {}
        self._record: np.dtype[Any] | None = None
        self._others: tuple[str, ...] = ()
        self._has_heights = False

    def put(self, rows: slice | IntArray, cleaned: Cleaned) -> None:
        """Keep what is said of some rows.

        Parameters
        ----------
        rows : slice or ndarray of int64, shape (k,)
        cleaned : Cleaned
            With as many entries, and the same others every time.

        Raises
        ------
        OSError
            If the temporary file cannot be written.
        """
        k = cleaned.lat.size
        record = self._record_of(cleaned)
        records = np.empty(k, dtype=record)
        records["lat"], records["lon"] = cleaned.lat, cleaned.lon
        records["height_m"] = np.nan if cleaned.height_m is None else cleaned.height_m
        records["probability"] = np.nan if cleaned.probability is None else cleaned.probability
        records["inlier"] = False if cleaned.inlier is None else cleaned.inlier
        reasons = cleaned.reason or [""] * k
        records["reason"] = [self._words.setdefault(word, len(self._words)) for word in reasons]
        for name in self._others:
            records[name] = cleaned.others[name]
        self._has_heights |= cleaned.height_m is not None
        self._places[rows] = np.arange(self._written, self._written + k)
        self._file.write(records.tobytes())
        self._written += k

    def take(self, rows: slice | IntArray) -> Cleaned:
        """Give what was said of some rows, in the order asked for."""
        if self._record is None:
            raise ValueError("nothing was put")
        places = self._places[rows].astype(np.int64)
        order = np.argsort(places)
        records = self._read(places[order], self._record)
        own = np.empty_like(records)
        own[order] = records
        words = list(self._words)
        columns: dict[str, Any] = {name: np.ascontiguousarray(own[name]) for name in (*_OWN, *self._others)}
        return Cleaned(
            columns["lat"],
            columns["lon"],
            height_m=columns["height_m"] if self._has_heights else None,
            inlier=np.ascontiguousarray(own["inlier"]),
            probability=columns["probability"],
            reason=[words[code] for code in own["reason"].tolist()],
            others={name: columns[name] for name in self._others},
        )

    def pairs(
        self, recording: Recording, order: IntArray | None = None
    ) -> Iterator[tuple[Recording, Cleaned]]:
        """Give all rows with what was said of them.

        Parameters
        ----------
        recording : Recording
        order : ndarray of int64, shape (size,), optional
            Default: as the recording has them.
        """
        for first in range(0, len(recording), PIECE_ROWS):
            part = slice(first, min(first + PIECE_ROWS, len(recording)))
            rows = part if order is None else order[part]
            yield recording.part(rows), self.take(rows)

    def _record_of(self, cleaned: Cleaned) -> np.dtype[Any]:
        if self._record is None:
            self._others = tuple(cleaned.others)
            numbers = [(name, np.float64) for name in (*_OWN, *self._others)]
            self._record = np.dtype([*numbers, ("inlier", np.bool_), ("reason", np.uint8)])
        return self._record

    def _read(self, places: IntArray, record: np.dtype[Any]) -> npt.NDArray[Any]:
        """Read records at ascending places, those on end at once."""
        records = np.empty(places.size, dtype=record)
        breaks = np.flatnonzero(np.diff(places) != 1) + 1
        edges = [0, *breaks.tolist(), places.size] if places.size else [0]
        for first, stop in itertools.pairwise(edges):
            self._file.seek(int(places[first]) * record.itemsize)
            kept = self._file.read((stop - first) * record.itemsize)
            records[first:stop] = np.frombuffer(kept, dtype=record)
        return records
