"""Where a series changes its regime: robust segmented regression on the time axis.

PEaRL on a chain (METHODS.md 8): lines from windows are proposed, the cheapest path chooses among them by
exact dynamic programming, lines are fitted to their pieces again, and pieces are joined greedily. The price
of a change is that of its three numbers (when, level, slope) by Schwarz's criterion, raised for robustness
and for serial correlation (a reading that repeats its neighbour is no news).
"""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.noise.differences import interquartile_difference_scale
from estimators.options import RobustOptions
from estimators.trends.regimes.path import cheapest_path, runs_of
from estimators.trends.regimes.pieces import LEAST_READINGS, Piece, cheapest_break, piece_of, settle
from estimators.trends.regimes.proposals import propose_lines
from estimators.trends.regimes.readings import CUT, Readings

PRICE = 4.0
"""Loss that a change must save, in units of ln n; 3 would be Schwarz's criterion for clean readings."""
SAME = 3.0
"""Likewise for a second line where the changes are paid for; 2 would be Schwarz's for two numbers."""
MOST_READINGS = 1000
"""Longer series are looked at with a stride; every break is then placed among all readings."""
_ROUNDS = 5
_CONSISTENT = 0.97335
"""Variance of a standard normal variable within the cut of 3."""
_NOTABLE = 2.0
"""Standard errors from which a serial correlation counts."""
_CAUTION = 1.5
"""Standard errors by which it is then raised."""
_MOST_CORRELATION = 0.98


def find_changes(
    t: FloatArray,
    residual: FloatArray,
    weights: FloatArray | None,
    floor: float,
    sigma: float | None,
    options: RobustOptions,
) -> list[int]:
    """First reading of every regime.

    Parameters
    ----------
    t : ndarray of float64, shape (n,)
        Ascending.
    residual : ndarray of float64, shape (n,)
        Values less the trend of the whole series.
    weights : ndarray of float64, shape (n,), or None
        Precisions with mean 1.
    floor : float
        Smallest noise scale that the values can show.
    sigma : float or None
        Noise scale, where it is given.
    options : RobustOptions

    Returns
    -------
    list of int
        Starts with 0; ``[0]`` alone where the series has one regime.
    """
    n = t.size
    if n < 2 * LEAST_READINGS or t[0] == t[-1]:
        return [0]
    root = None if weights is None else np.sqrt(weights)
    half = 0.5 * float(t[-1] - t[0])
    frame = (t - 0.5 * float(t[-1] + t[0])) / half
    whole = Readings(frame, residual, root, 1.0)
    rows = np.arange(0, n, -(-n // MOST_READINGS))
    seen = _rows_of(whole, rows)
    pilot = interquartile_difference_scale(seen.y, None if seen.root is None else seen.root**2)
    scale = max(pilot, floor) if sigma is None else sigma
    lines = propose_lines(seen, floor, options)
    widen = 1.0
    pieces: list[Piece] = []
    for _ in range(_ROUNDS):
        seen = dataclasses.replace(seen, sigma=scale)
        before, pieces = pieces, _segment(seen, lines, widen)
        wider, wander = _correlation(seen, pieces) if options.correct_serial_correlation else (1.0, 0.0)
        wider = max(widen, wider)
        refined = max(_scale_of(seen, pieces), wander, floor) if sigma is None else sigma
        settled = [piece.start for piece in before] == [piece.start for piece in pieces]
        if settled and abs(refined - scale) <= 0.1 * scale and wider <= 1.1 * widen:
            break
        scale, widen = refined, wider
        # Joint lines stand where no window had them; the next path may use them.
        lines = np.vstack([lines, *(piece.fitted.line for piece in pieces)])
    whole = dataclasses.replace(whole, sigma=seen.sigma)
    return [0, *(_place(whole, rows, one, other) for one, other in itertools.pairwise(pieces))]


def _rows_of(readings: Readings, rows: IntArray) -> Readings:
    root = None if readings.root is None else readings.root[rows]
    return Readings(readings.t[rows], readings.y[rows], root, readings.sigma)


def _segment(readings: Readings, lines: FloatArray, widen: float) -> list[Piece]:
    """Pieces of the series at a given noise scale."""
    price = PRICE * math.log(readings.n) * widen
    same = SAME * math.log(readings.n) * widen
    loss = np.column_stack([readings.losses(line) for line in lines])
    path = cheapest_path(loss, price)
    pieces = [piece_of(readings, start, stop, lines[path[start]]) for start, stop in runs_of(path)]
    return settle(readings, pieces, price, same)


def _scale_of(readings: Readings, pieces: list[Piece]) -> float:
    """Noise scale of the readings that follow their lines: a fixed point of the cut-off variance."""
    scores = np.concatenate([readings.scores(piece.fitted.line, piece.own) for piece in pieces])
    squares = np.sort(scores * scores)
    sums = np.cumsum(squares)
    variance = 1.0
    for _ in range(50):
        within = int(np.searchsorted(squares, CUT * CUT * variance, side="right"))
        free = within - 2 * len(pieces)
        if free <= 0:
            break
        refined = float(sums[within - 1]) / (free * _CONSISTENT)
        if abs(refined - variance) <= 1e-3 * variance:
            break
        variance = refined
    return readings.sigma * math.sqrt(variance)


def _correlation(readings: Readings, pieces: list[Piece]) -> tuple[float, float]:
    """How many correlated readings are worth one, and the noise scale that their differences tell.

    The first is 1 + 2 w rho / (1 - rho) (METHODS_TRENDS: "Interval"), w the share of followers whose
    neighbour follows as well. Lines that follow the wander of
    correlated noise take its correlation and some of its scale away with them; differences hardly notice
    lines. Of first-order autoregressive noise those over one step have the variance 2 sigma^2 (1 - rho),
    those over two 1 + rho times as much.

    Returns
    -------
    tuple of float
        1 and 0 where the readings show no correlation.
    """
    steps, leaps, followers = np.zeros(2), np.zeros(2), 0
    for piece in pieces:
        scores = readings.scores(piece.fitted.line, piece.own)
        scores = np.where(np.abs(scores) <= CUT, scores, np.nan)
        steps += _squares(scores[1:] - scores[:-1])
        leaps += _squares(scores[2:] - scores[:-2])
        followers += int(np.count_nonzero(np.isfinite(scores)))
    (step, pairs), (leap, triples) = steps.tolist(), leaps.tolist()
    if min(pairs, triples) < LEAST_READINGS or step <= 0.0:
        return 1.0, 0.0
    lag1 = min((leap / triples) / (step / pairs) - 1.0, _MOST_CORRELATION)
    if lag1 <= _NOTABLE / math.sqrt(pairs):
        return 1.0, 0.0
    scale = readings.sigma * math.sqrt(0.5 * step / pairs / (1.0 - lag1))
    # The number is convex in the correlation, and a price that is too low makes changes out of wander.
    cautious = min(lag1 + _CAUTION * math.sqrt((1.0 - lag1 * lag1) / pairs), _MOST_CORRELATION)
    return 1.0 + 2.0 * (pairs / followers) * cautious / (1.0 - cautious), scale


def _squares(differences: FloatArray) -> FloatArray:
    """Sum and number of the squares that are known."""
    known = differences[np.isfinite(differences)]
    return np.array([float(np.dot(known, known)), known.size])


def _place(whole: Readings, rows: IntArray, one: Piece, other: Piece) -> int:
    """Place a break among all readings, between the middles of the pieces that it parts."""
    first = int(rows[int(one.own[one.own.size // 2])])
    last = int(rows[int(other.own[other.own.size // 2])])
    return cheapest_break(whole, one.fitted.line, other.fitted.line, first, last)
