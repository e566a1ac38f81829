"""Rows in order of time: how they are sorted, and which of them say the same twice.

A track that came in order, as nearly all do, needs no index: for ten million rows that is 80 MB.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray


def order_by_time(
    moved: FloatArray, latitude: FloatArray, longitude: FloatArray, filed: IntArray | None
) -> IntArray | None:
    """Order of times, ties by place, so that the answer does not depend on the order of the rows.

    Parameters
    ----------
    moved : ndarray, shape (m,)
        Seconds, finite.
    latitude, longitude : ndarray, shape (n,)
    filed : ndarray of int64, shape (m,), or None
        Row of each time; None: all of them.

    Returns
    -------
    ndarray of int64, shape (m,), or None
        None where they are in order.

    Examples
    --------
    >>> order_by_time(np.array([1.0, 0.0, 1.0]), np.array([5.0, 0.0, 4.0]), np.zeros(3), None).tolist()
    [1, 2, 0]
    """
    sorting = np.argsort(moved, kind="stable") if (moved[1:] < moved[:-1]).any() else None
    ordered = moved if sorting is None else moved[sorting]
    tied = np.zeros(moved.size, dtype=np.bool_)
    tied[1:] = ordered[1:] == ordered[:-1]
    tied[:-1] |= tied[1:]
    places = np.flatnonzero(tied)
    if places.size == 0:
        return sorting
    members = places if sorting is None else sorting[places]
    rows = members if filed is None else filed[members]
    by_place = members[np.lexsort((longitude[rows], latitude[rows], moved[members]))]
    if sorting is None and np.array_equal(by_place, members):
        return None
    sorting = np.arange(moved.size) if sorting is None else sorting
    sorting[places] = by_place
    return sorting


def find_twins(
    t: FloatArray, latitude: FloatArray, longitude: FloatArray, held: BoolArray, order: IntArray | None
) -> tuple[IntArray, IntArray]:
    """Rows of the same time and position as another.

    Parameters
    ----------
    t : ndarray, shape (m,)
        Ascending, ties by place.
    latitude, longitude : ndarray, shape (n,)
    held : ndarray of bool, shape (m,)
        Whether a row has a place.
    order : ndarray of int64, shape (m,), or None
        Row of each time.

    Returns
    -------
    duplicates, twins : ndarray of int64, shape (d,)
        Places in order of time: of the later rows, and of the first of each run of the same.
    """
    later = np.flatnonzero((t[1:] == t[:-1]) & held[1:] & held[:-1]) + 1
    now, before = (later, later - 1) if order is None else (order[later], order[later - 1])
    later = later[(latitude[now] == latitude[before]) & (longitude[now] == longitude[before])]
    begins = np.diff(later, prepend=-1) != 1
    firsts = later[begins] - 1
    return later, firsts[np.cumsum(begins) - 1]
