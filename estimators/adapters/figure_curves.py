"""Where a trend's curve is looked at so that its picture is true and small.

A season needs points in every cycle of its finest harmonic, or the picture shows another, slower wave. A
straight line needs two. So curves are computed finely first, and what a straight stroke says as well is then
left out (Ramer 1972; Douglas & Peucker 1973).
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from estimators.arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from estimators.trends.trend import Trend

STEPS_PER_CYCLE = 16
"""Points per cycle: strokes between them miss a sine by at most 2 % of its amplitude."""
MOST_STEPS = 100_000
CROWDED = 4
"""Points per column of pixels from which only the lowest and the highest of each column are drawn."""
TOLERANCE_PX = 0.2
"""Largest distance of a drawn stroke from the curve."""


def shortest_cycle(trend: Trend) -> float:
    """Cycle of the finest harmonic, in the internal unit of time; infinite where there is no season."""
    return min((season.period / season.harmonics for season in trend.seasons), default=math.inf)


def fine_times(trend: Trend, columns: int) -> FloatArray:
    """Lay out internal times over the span of the data and whatever is predicted.

    Parameters
    ----------
    trend : Trend
    columns : int
        Columns of pixels; each has a time at least.

    Returns
    -------
    ndarray of float64, shape (k,)
        Ascending; the first and the last time of the data are among them.
    """
    first, last = trend.geometry.span
    ends = [first, last]
    if trend.prediction is not None:
        asked = trend.axis.to_internal(trend.prediction.time)
        ends += asked[np.isfinite(asked)].tolist()
    whole = max(ends) - min(ends)
    if whole == 0.0:
        return np.array([first, last])
    cycles = whole / shortest_cycle(trend)
    steps = int(min(max(columns, math.ceil(STEPS_PER_CYCLE * cycles)), MOST_STEPS))

    def part(start: float, stop: float) -> FloatArray:
        share = (stop - start) / whole
        return np.linspace(start, stop, max(math.ceil(steps * share) + 1, 2))

    before = part(min(ends), first)[:-1] if min(ends) < first else np.empty(0)
    after = part(last, max(ends))[1:] if max(ends) > last else np.empty(0)
    return np.concatenate([before, part(first, last), after])


def drawn_rows(at: FloatArray, curves_px: FloatArray, span: tuple[float, float], columns: int) -> IntArray:
    """Choose the rows of finely computed curves that a picture needs.

    Parameters
    ----------
    at : ndarray of float64, shape (k,)
        Ascending times.
    curves_px : ndarray of float64, shape (c, k)
        Curves in pixels, the trend first.
    span : tuple of float
        First and last time of the data; both are kept.
    columns : int
        Columns of pixels.

    Returns
    -------
    ndarray of int64
        Ascending.
    """
    inside = np.flatnonzero((at >= span[0]) & (at <= span[1]))
    corners = np.unique([0, inside[0], inside[-1], at.size - 1])
    if at.size > CROWDED * columns:
        return np.union1d(corners, lowest_and_highest(at, curves_px[0], columns))
    known = curves_px[np.isfinite(curves_px).all(axis=1)]
    parts = [_strokes(at, known, int(a), int(b)) for a, b in pairwise(corners)]
    return np.unique(np.concatenate([corners, *parts]))


def lowest_and_highest(at: FloatArray, value: FloatArray, columns: int) -> IntArray:
    """Rows of the least and the largest value of every column of pixels."""
    share = (at - at[0]) / (at[-1] - at[0])
    column = np.minimum((share * columns).astype(np.int64), columns - 1)
    starts = np.flatnonzero(np.diff(column, prepend=-1))
    # Sorted by column, then by value: the ends of each column's run are its extremes.
    order = np.lexsort((value, column))
    ends = np.append(starts[1:], at.size) - 1
    return np.unique(np.concatenate([order[starts], order[ends]]))


def _strokes(at: FloatArray, curves_px: FloatArray, first: int, last: int) -> IntArray:
    """Rows at which strokes have to meet so that no curve is missed by more than the tolerance."""
    kept = [first, last]
    waiting = [(first, last)]
    while waiting:
        a, b = waiting.pop()
        if b - a < 2:
            continue
        share = (at[a + 1 : b] - at[a]) / (at[b] - at[a])
        chord = curves_px[:, a, None] + share * (curves_px[:, b] - curves_px[:, a])[:, None]
        off = np.abs(curves_px[:, a + 1 : b] - chord).max(axis=0)
        worst = int(np.argmax(off))
        if off[worst] > TOLERANCE_PX:
            middle = a + 1 + worst
            kept.append(middle)
            waiting += [(a, middle), (middle, b)]
    return np.array(kept, dtype=np.int64)
