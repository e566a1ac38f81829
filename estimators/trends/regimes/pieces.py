"""Pieces of a series, and what tells a regime from an excursion and from chance.

The cheapest path cuts generously. Here pieces are joined again wherever one line explains both nearly as
well (backward elimination), what lies between two parts of one line becomes an excursion from it, and
pieces too short or too scattered to carry a line of their own go to their neighbours.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import betainc

from estimators.arrays import FloatArray, IntArray
from estimators.trends.regimes.readings import CUT, FittedLine, Readings, polish

LEAST_READINGS = 10
"""A regime has at least so many readings."""
LEAST_CHANGE = 1.0
"""Noise scales by which lines are apart, on average over either piece; less changes nothing for anybody."""
_OBVIOUS_SHARE = 0.8
"""Of readings within the cut; from here on nobody needs a test to see the line."""

_VISITED_SHARE = 0.25
"""Of a piece's followers; so many readings on a neighbour's line say that it has not been left."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of the series and its line.

    Attributes
    ----------
    start, stop : int
        Readings of the stretch.
    own : ndarray of int64
        Readings of the stretch less those of excursions in it.
    fitted : FittedLine
        On ``own``.
    """

    start: int
    stop: int
    own: IntArray
    fitted: FittedLine


def piece_of(readings: Readings, start: int, stop: int, line: FloatArray) -> Piece:
    """Piece without excursions, its line polished."""
    own = np.arange(start, stop)
    return Piece(start, stop, own, polish(readings, own, line))


def is_regime(readings: Readings, piece: Piece) -> bool:
    """Whether a piece is long enough and its line no accident.

    Most readings within the cut are beyond doubt. Among scattered readings some line always passes near a
    few: the expected number of lines with as many followers, pairs times places times the binomial tail of
    a band of the cut, must stay below one (the a-contrario test of Moisan and Stival 2004; METHODS.md 3.5).
    """
    m = piece.own.size
    if m < LEAST_READINGS:
        return False
    scores = readings.scores(piece.fitted.line, piece.own)
    followers = int(np.count_nonzero(np.abs(scores) <= CUT))
    if followers >= _OBVIOUS_SHARE * m:
        return True
    if followers < 3:
        return False
    ordered = np.sort(scores)
    # The central nine tenths, stretched to the whole, so that a gross error does not widen the range.
    spread = float(ordered[(19 * m) // 20] - ordered[m // 20]) / 0.9
    band = min(1.0, 2.0 * CUT / spread)
    tail = float(betainc(followers - 2, m - followers + 1, band))
    return 0.5 * m * (m - 1) * readings.n * tail < 1.0


def _is_visited(readings: Readings, pieces: Sequence[Piece], place: int) -> bool:
    """Whether readings of a piece keep following the line of a larger neighbour: that regime goes on."""
    piece = pieces[place]
    follows = np.abs(readings.scores(piece.fitted.line, piece.own)) <= CUT
    for neighbour in (*pieces[max(place - 1, 0) : place], *pieces[place + 1 : place + 2]):
        if neighbour.own.size <= piece.own.size:
            continue
        visits = np.abs(readings.scores(neighbour.fitted.line, piece.own)) <= CUT
        if np.count_nonzero(visits & ~follows) >= _VISITED_SHARE * np.count_nonzero(follows):
            return True
    return False


def joined(readings: Readings, one: Piece, other: Piece) -> tuple[float, Piece]:
    """Loss that one line instead of two adds, and the piece it makes; between them are no own readings."""
    own = np.concatenate((one.own, other.own))
    starts = [one.fitted.line, other.fitted.line]
    across = _across(readings, one, other)
    if across is not None:
        starts.append(across)
    fitted = min((polish(readings, own, start) for start in starts), key=lambda fit: fit.loss)
    return fitted.loss - one.fitted.loss - other.fitted.loss, Piece(one.start, other.stop, own, fitted)


def _across(readings: Readings, one: Piece, other: Piece) -> FloatArray | None:
    """Line through the middles of two pieces."""
    (t0, y0), (t1, y1) = (_middle(readings, piece) for piece in (one, other))
    if t1 <= t0:
        return None
    slope = (y1 - y0) / (t1 - t0)
    return np.array([y0 - slope * t0, slope])


def _middle(readings: Readings, piece: Piece) -> tuple[float, float]:
    t = float(np.median(readings.t[piece.own]))
    line = piece.fitted.line
    return t, float(line[0] + line[1] * t)


def settle(readings: Readings, pieces: Sequence[Piece], price: float, same: float) -> list[Piece]:
    """Join pieces, forgive excursions and dissolve the weak until every piece is a regime.

    Parameters
    ----------
    readings : Readings
    pieces : sequence of Piece
        In order, without gaps.
    price : float
        Loss that a change must save.
    same : float
        Loss up to which two pieces apart from each other follow the same line.

    Returns
    -------
    list of Piece
    """
    left = list(pieces)
    known: dict[tuple[int, int, int, int], tuple[float, Piece]] = {}

    def join(first: int, second: int) -> tuple[float, Piece]:
        one, other = left[first], left[second]
        key = (one.start, one.stop, other.start, other.stop)
        if key not in known:
            known[key] = joined(readings, one, other)
        return known[key]

    while len(left) > 1:
        added, first = min((_worth(readings, left, place, join), place) for place in range(len(left) - 1))
        if added < price:
            left[first : first + 2] = [join(first, first + 1)[1]]
            continue
        returns = [pair for pair in _candidates(left) if join(*pair)[0] < same]
        if returns:
            first, second = returns[0]
            left[first : second + 1] = [join(first, second)[1]]
            continue
        weak = [
            place
            for place, piece in enumerate(left)
            if not is_regime(readings, piece) or _is_visited(readings, left, place)
        ]
        if not weak:
            break
        _dissolve(readings, left, min(weak, key=lambda place: left[place].own.size))
    return left


def _worth(
    readings: Readings, pieces: Sequence[Piece], place: int, join: Callable[[int, int], tuple[float, Piece]]
) -> float:
    """Loss that parting a piece from the next one saves; nothing where their lines are hardly apart."""
    one, other = pieces[place], pieces[place + 1]
    apart = other.fitted.line - one.fitted.line
    nearest = min(
        float(np.mean(np.abs(apart[0] + apart[1] * readings.t[piece.own]))) for piece in (one, other)
    )
    return 0.0 if nearest < LEAST_CHANGE * readings.sigma else join(place, place + 1)[0]


def _candidates(pieces: Sequence[Piece]) -> list[tuple[int, int]]:
    """Pairs of pieces that enclose fewer readings than they have, those that enclose fewest first."""
    enclosed: list[tuple[int, int, int]] = []
    for first, one in enumerate(pieces):
        for second in range(first + 2, len(pieces)):
            other = pieces[second]
            between = other.start - one.stop
            if between < one.own.size + other.own.size:
                enclosed.append((between, first, second))
    return [(first, second) for _, first, second in sorted(enclosed)]


def _dissolve(readings: Readings, pieces: list[Piece], place: int) -> None:
    """Give the readings of a piece to its neighbours, divided where that costs least."""
    weak = pieces[place]
    before = pieces[place - 1] if place > 0 else None
    after = pieces[place + 1] if place + 1 < len(pieces) else None
    if before is None or after is None:
        cut = weak.start if before is None else weak.stop
    else:
        cut = cheapest_break(readings, before.fitted.line, after.fitted.line, weak.start, weak.stop)
    grown: list[Piece] = []
    if before is not None:
        own = np.concatenate((before.own, np.arange(weak.start, cut)))
        grown.append(Piece(before.start, cut, own, polish(readings, own, before.fitted.line)))
    if after is not None:
        own = np.concatenate((np.arange(cut, weak.stop), after.own))
        grown.append(Piece(cut, after.stop, own, polish(readings, own, after.fitted.line)))
    pieces[max(place - 1, 0) : place + 2] = grown


def cheapest_break(readings: Readings, before: FloatArray, after: FloatArray, start: int, stop: int) -> int:
    """First reading, from ``start`` to ``stop``, of the later of two lines."""
    rows = slice(start, stop)
    saved = readings.losses(before, rows) - readings.losses(after, rows)
    # Loss of a break before each reading and after the last one, up to a constant; the earliest of equals.
    return start + int(np.argmin(np.concatenate(([0.0], np.cumsum(saved)))))
