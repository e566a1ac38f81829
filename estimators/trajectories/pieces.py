"""The answer of a track piece by piece: :class:`TrackPieces`, for those who cannot hold the whole."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.notices import Notice
from estimators.trajectories.rows import Rows
from estimators.trajectories.track import Distance, Stretch, TrackNoise, TrackPoints


@dataclass(frozen=True, slots=True)
class TrackPiece:
    """Columns of the answer for some of the rows; as those of :class:`~estimators.Track`.

    Attributes
    ----------
    rows : ndarray of int64, shape (k,)
        Input rows, in order of time.
    points : TrackPoints
    lat_deg, lon_deg : ndarray, shape (k,)
    height_m : ndarray, shape (k,), or None
    variance_m2, variance_up_m2 : ndarray, shape (k,)
        Of the smoothed position: per horizontal axis, and upward.
    speed_mps, speed_sigma_mps, heading_deg, heading_sigma_deg : ndarray, shape (k,)
    """

    rows: IntArray
    points: TrackPoints
    lat_deg: FloatArray
    lon_deg: FloatArray
    height_m: FloatArray | None
    variance_m2: FloatArray
    variance_up_m2: FloatArray
    speed_mps: FloatArray
    speed_sigma_mps: FloatArray
    heading_deg: FloatArray
    heading_sigma_deg: FloatArray

    def __len__(self) -> int:
        return int(self.rows.size)

    @property
    def sigma_m(self) -> FloatArray:
        """Standard deviation of the smoothed position, per horizontal axis, shape (k,)."""
        return np.sqrt(self.variance_m2)

    def columns(self) -> dict[str, np.ndarray]:
        """Columns by name, those of ``points`` among them; without ``rows`` and without heights if none."""
        own = {field.name: getattr(self, field.name) for field in fields(self)[2:]}
        points = {field.name: getattr(self.points, field.name) for field in fields(self.points)}
        return points | {name: column for name, column in own.items() if column is not None}

    def part(self, rows: slice | IntArray) -> TrackPiece:
        """Give some of the rows."""
        return _made(self.rows[rows], {name: column[rows] for name, column in self.columns().items()})


@dataclass(frozen=True, slots=True)
class TrackFacts:
    """What is said of a track as a whole; as in :class:`~estimators.Track`.

    Attributes
    ----------
    method : str
    rows, inliers : int
    noise : TrackNoise
    distance : Distance
    stretches : tuple of Stretch
    level : float
    notices : tuple of Notice
    """

    method: str
    rows: int
    inliers: int
    noise: TrackNoise
    distance: Distance
    stretches: tuple[Stretch, ...]
    level: float
    notices: tuple[Notice, ...]


class TrackPieces:
    """The answer of :func:`estimators.clean_in_pieces`: columns to iterate over once, facts afterwards.

    Parameters
    ----------
    rows : Rows
    blocks : iterator of TrackPiece
    conclude : callable
        Gives the facts, once all blocks have been made.
    piece_rows : int
    """

    def __init__(
        self,
        rows: Rows,
        blocks: Iterator[TrackPiece],
        conclude: Callable[[], TrackFacts],
        piece_rows: int,
    ) -> None:
        self._rows = rows
        self._pieces = _recut(blocks, piece_rows)
        self._conclude = conclude

    @property
    def size(self) -> int:
        """Rows in, and out."""
        return int(self._rows.codes.size)

    @property
    def in_input_order(self) -> bool:
        """Whether the pieces come in the order of the input: its times ascend, and none is missing."""
        return self._rows.order is None

    def inputs(self) -> tuple[np.ndarray, FloatArray, FloatArray]:
        """Give times as they came, and latitudes and longitudes, NaN where invalid; each of shape (size,)."""
        return self._rows.time, self._rows.lat_deg, self._rows.lon_deg

    def __iter__(self) -> Iterator[TrackPiece]:
        """Give the pieces in order of time; rows without a time come last."""
        return self._pieces

    def facts(self) -> TrackFacts:
        """Give what is said of the whole track; pieces that were not taken yet are passed over."""
        for _ in self._pieces:
            pass
        return self._conclude()


def join_pieces(pieces: Sequence[TrackPiece]) -> TrackPiece:
    """Pieces on end as one."""
    if len(pieces) == 1:
        return pieces[0]
    parts = [piece.columns() for piece in pieces]
    joined = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return _made(np.concatenate([piece.rows for piece in pieces]), joined)


def _made(rows: IntArray, columns: dict[str, np.ndarray]) -> TrackPiece:
    points = TrackPoints(**{field.name: columns.pop(field.name) for field in fields(TrackPoints)})
    return TrackPiece(rows, points, height_m=columns.pop("height_m", None), **columns)


def _recut(blocks: Iterator[TrackPiece], piece_rows: int) -> Iterator[TrackPiece]:
    """Cut blocks into pieces of a length; the last is shorter."""
    held: list[TrackPiece] = []
    size = 0
    for block in blocks:
        held.append(block)
        size += len(block)
        if size < piece_rows:
            continue
        joined = join_pieces(held)
        whole = size - size % piece_rows
        for first in range(0, whole, piece_rows):
            yield joined.part(slice(first, first + piece_rows))
        held, size = ([joined.part(slice(whole, size))], size - whole) if size > whole else ([], 0)
    if held:
        yield join_pieces(held)
