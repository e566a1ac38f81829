"""A slice of series made ready for compiled code: usable points of all of them, one after the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from estimators.arrays import FloatArray, InputError, IntArray
from estimators.series import Series, as_series
from estimators.trends.batch.group import bounds_of
from estimators.trends.batch.orderly import place_integers, place_numbers
from estimators.trends.batch.source import Source


@dataclass(frozen=True, slots=True)
class Ready:
    """Series of a slice that hold at least two different times.

    Attributes
    ----------
    series : ndarray of int64, shape (m,)
        Their numbers in the table.
    offsets : ndarray of int64, shape (m + 1,)
        Into the columns below.
    t, y : ndarray of float64, shape (points,)
        Times since the first of each series, values.
    weights : ndarray of float64, shape (points,), or None
        Precisions with mean 1 in each series.
    rows : slice, or ndarray of int64, shape (points,)
        The caller's rows; a slice where every one of them is a point.
    origin : ndarray, shape (m,)
        The caller's time at internal time 0: float64, int64 or datetime64[ns].
    checked : mapping of int to Series
        By position in ``series``: what came through :func:`as_series`.
    """

    series: IntArray
    offsets: IntArray
    t: FloatArray
    y: FloatArray
    weights: FloatArray | None
    rows: slice | IntArray
    origin: np.ndarray[Any, Any]
    checked: dict[int, Series]


def make_ready(source: Source, first: int, last: int) -> tuple[Ready, IntArray]:
    """Make a slice ready.

    Returns
    -------
    ready : Ready
    left : ndarray of int64
        Numbers of the series that cannot be fitted, whatever the reason.
    """
    absolute = source.offsets[first : last + 1]
    start, stop = int(absolute[0]), int(absolute[-1])
    offsets = absolute - start
    internal = np.empty(stop - start)
    orderly = _place(source, first, last, offsets, internal)
    lengths = np.diff(offsets)
    usable = orderly & (lengths >= 2)
    if usable.all():
        return Ready(
            np.arange(first, last, dtype=np.int64),
            offsets,
            internal,
            source.values[start:stop],
            None,
            slice(start, stop),
            _origins(source, np.arange(first, last)),
            {},
        ), np.empty(0, dtype=np.int64)
    return _gather(source, first, offsets, internal, orderly)


def _place(source: Source, first: int, last: int, offsets: IntArray, internal: FloatArray) -> Any:
    """Fill the times of a slice and tell which series are in order; weighted ones are never said to be."""
    orderly = np.zeros(last - first, dtype=np.bool_)
    kind = source.times.dtype.kind
    if source.weights is not None or kind == "O" or source.times.dtype == np.uint64:
        return orderly
    a, b = int(source.offsets[first]), int(source.offsets[last])
    values = source.values[a:b]
    times = source.times if source.shared else source.times[a:b]
    starts = np.zeros(last - first, dtype=np.int64) if source.shared else offsets[:-1]
    if kind == "f":
        place_numbers(offsets, starts, times, values, internal, orderly)
    elif kind == "M":
        place_integers(offsets, starts, times.view(np.int64), values, 1e9, True, internal, orderly)
    else:
        place_integers(
            offsets, starts, times.astype(np.int64, copy=False), values, 1.0, False, internal, orderly
        )
    return orderly


def _origins(source: Source, series: IntArray) -> np.ndarray[Any, Any]:
    """First times of series that are in order."""
    if source.shared:
        return np.repeat(source.times[:1], series.size)
    return source.times[source.offsets[series]]


def _gather(
    source: Source, first: int, offsets: IntArray, internal: FloatArray, orderly: Any
) -> tuple[Ready, IntArray]:
    """Put the usable points of all series side by side, some as they are, some through :func:`as_series`."""
    start = int(source.offsets[first])
    weighted = source.weights is not None
    dated = source.times.dtype.kind == "M"
    series: list[int] = []
    left: list[int] = []
    origins: list[Any] = []
    checked: dict[int, Series] = {}
    pieces: list[tuple[Any, Any, Any, Any]] = []
    for j, in_order in enumerate(orderly.tolist()):
        a, b = int(offsets[j]), int(offsets[j + 1])
        if in_order:
            if b - a < 2:
                left.append(first + j)
                continue
            times = source.times if source.shared else source.times[start + a :]
            rows = np.arange(start + a, start + b, dtype=np.int64)
            pieces.append((internal[a:b], source.values[start + a : start + b], None, rows))
            origins.append(times[0])
        else:
            try:
                one = as_series(*source.columns(first + j))
            except InputError:
                left.append(first + j)
                continue
            if one.n < 2 or one.t[0] == one.t[-1]:
                left.append(first + j)
                continue
            rows = np.arange(one.n, dtype=np.int64) if one.rows is None else one.rows
            checked[len(series)] = one
            pieces.append((one.t, one.y, one.weights, rows + (start + a)))
            origins.append(one.axis.origin)
        series.append(first + j)
    ready = Ready(
        np.array(series, dtype=np.int64),
        bounds_of(np.array([piece[0].size for piece in pieces], dtype=np.int64)),
        _joined([piece[0] for piece in pieces], np.float64),
        _joined([piece[1] for piece in pieces], np.float64),
        _joined([piece[2] for piece in pieces], np.float64) if weighted else None,
        _joined([piece[3] for piece in pieces], np.int64),
        np.array(origins, dtype="datetime64[ns]") if dated else np.array([float(o) for o in origins]),
        checked,
    )
    return ready, np.array(left, dtype=np.int64)


def _joined(pieces: list[Any], dtype: Any) -> Any:
    return np.concatenate(pieces) if pieces else np.empty(0, dtype=dtype)
