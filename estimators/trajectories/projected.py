"""Fixes of a track in its plane: held where they are few, made when asked for where they are many."""

from __future__ import annotations

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.geodesy.plane import Plane

_MANY = 1 << 17
"""Rows above which fixes are not held: 16 bytes each, against a tenth of a microsecond to make one."""


class Projected:
    """East and north, in metres, of rows in order of time; 0 where a row has no place.

    Parameters
    ----------
    plane : Plane
    latitude_deg, longitude_deg : ndarray, shape (n,)
        Of the input rows.
    held : ndarray of bool, shape (m,)
        Whether a row has a place.
    order : ndarray of int64, shape (m,), or None
        Input rows in order of time; None: all, as they came.

    Examples
    --------
    >>> places = np.array([48.0, np.nan, 48.0])
    >>> fixes = Projected(Plane(48.0, 11.0), places, np.full(3, 11.0), np.isfinite(places), None)
    >>> fixes[1:].shape, bool(np.abs(fixes[:]).max() < 1e-6)
    ((2, 2), True)
    """

    def __init__(
        self,
        plane: Plane,
        latitude_deg: FloatArray,
        longitude_deg: FloatArray,
        held: BoolArray,
        order: IntArray | None,
    ) -> None:
        self._plane, self._held, self._order = plane, held, order
        self._latitude, self._longitude = latitude_deg, longitude_deg
        self._made: FloatArray | None = None
        if held.size <= _MANY:
            self._made = self._make(slice(0, held.size))

    def __getitem__(self, rows: slice | IntArray) -> FloatArray:
        """Give the fixes of some rows, shape (k, 2)."""
        return self._make(rows) if self._made is None else self._made[rows]

    def _make(self, rows: slice | IntArray) -> FloatArray:
        inside = self._held[rows]
        inputs = rows if self._order is None else self._order[rows]
        latitude, longitude = self._latitude[inputs], self._longitude[inputs]
        if inside.all():
            return self._plane.project(latitude, longitude)
        fixes = np.zeros((inside.size, 2))
        fixes[inside] = self._plane.project(latitude[inside], longitude[inside])
        return fixes
