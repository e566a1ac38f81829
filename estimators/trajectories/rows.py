"""The one door of tracks: rows in any order, some of them no use, become fixes in a plane in order of time.

What a row is known to be before anything is estimated is decided here; an index leads back to the caller's
rows. Behind this door there are no poles, no antimeridian and no NaN among what measures.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from estimators.arrays import ArrayLike, BoolArray, CodeArray, FloatArray, InputError, IntArray
from estimators.geodesy.ellipsoid import to_cartesian, to_geodetic
from estimators.geodesy.plane import Plane
from estimators.time_axis import TimeAxis, as_moments, as_times
from estimators.trajectories.clock import clock_shifts
from estimators.trajectories.columns import column_of, heights_of, on_earth, reported_radii, velocities_of
from estimators.trajectories.ordering import find_twins, order_by_time
from estimators.trajectories.projected import Projected
from estimators.trajectories.reasons import FixReason
from estimators.trajectories.stale import repeats
from estimators.trajectories.velocities import trusted_velocities

LONGEST_S = 1e10
"""Tracks span at most three hundred years; longer ones are in another unit."""
_NULL_ISLAND_DEG = 1e-7
_ELSEWHERE_M = 1e3
_MANY = 1 << 17
"""The centre of a track of more rows is that of so many of them."""
_AT_ONCE = 1 << 16
"""Rows for which intermediate results are held."""


@dataclass(frozen=True, slots=True)
class Rows:
    """A track behind the door; m rows have a time.

    Attributes
    ----------
    time : ndarray, shape (n,)
        The caller's times as numbers or datetime64[ns], in input order.
    axis : TimeAxis
    codes : ndarray of uint8, shape (n,)
        A :class:`FixReason` per input row, as far as it is known.
    lat_deg, lon_deg : ndarray, shape (n,)
        As they came, longitudes wrapped; NaN where invalid.
    order : ndarray of int64, shape (m,), or None
        Input rows in order of time; None: they came in it, each with a time.
    t : ndarray, shape (m,)
        Seconds since the first, ascending; clocks that were off put right.
    fixes : Projected
        East and north in the plane, metres, of any rows; 0 where a row has no place.
    measures : ndarray of bool, shape (m,)
        Whether a row measures something: neither invalid nor a duplicate nor a repeat.
    repeat : ndarray of bool, shape (m,)
        Rows that repeat the position before them.
    duplicates, twins : ndarray of int64, shape (d,)
        Places, in order of time, of the duplicates and of the rows that they repeat.
    shift : ndarray, shape (m,), or None
        Seconds that were added to put a clock right; None: none.
    reported : ndarray, shape (m,), or None
        Radii that hold 68 %.
    height : ndarray, shape (m,), or None
        NaN where there is none.
    velocity : ndarray, shape (m, 2), or None
        As reported, along the plane's axes, m/s; None if there is none to be trusted.
    velocity_variance : ndarray, shape (m,), or None
        Per axis; infinite where a velocity is not to be used.
    plane : Plane
    was_sorted : bool
    """

    time: npt.NDArray[Any]
    axis: TimeAxis
    codes: CodeArray
    lat_deg: FloatArray
    lon_deg: FloatArray
    order: IntArray | None
    t: FloatArray
    fixes: Projected
    measures: BoolArray
    repeat: BoolArray
    duplicates: IntArray
    twins: IntArray
    shift: FloatArray | None
    reported: FloatArray | None
    height: FloatArray | None
    velocity: FloatArray | None
    velocity_variance: FloatArray | None
    plane: Plane
    was_sorted: bool

    def inputs(self, part: slice) -> IntArray:
        """Input rows of a part of the rows in order of time."""
        if self.order is None:
            return np.arange(*part.indices(self.t.size), dtype=np.int64)
        return self.order[part]


def read_rows(
    t_s: ArrayLike,
    lat_deg: ArrayLike,
    lon_deg: ArrayLike,
    height_m: ArrayLike | None = None,
    accuracy_m: ArrayLike | None = None,
    speed_mps: ArrayLike | None = None,
    bearing_deg: ArrayLike | None = None,
) -> Rows:
    """Check a track and bring it into a plane; see :func:`estimators.clean_trajectory` for what it takes."""
    internal, axis, column = times_of(t_s)
    n = internal.size
    latitude = column_of(lat_deg, "lat_deg", n)
    longitude = column_of(lon_deg, "lon_deg", n)
    usable = on_earth(latitude, longitude)
    if (longitude > 180.0).any() or (longitude < -180.0).any():
        longitude = np.where(np.abs(longitude) > 180.0, (longitude + 180.0) % 360.0 - 180.0, longitude)
    filed = None if np.isfinite(internal).all() else np.flatnonzero(np.isfinite(internal))
    moved = internal if filed is None else internal[filed]
    if moved.size and float(moved.max() - moved.min()) > LONGEST_S:
        raise InputError("t_s", "the times span more than 300 years; give seconds, or points in time")
    shift: FloatArray | None = clock_shifts(moved)
    if shift is not None and shift.any():
        moved = moved + shift
    else:
        shift = None
    sorting = order_by_time(moved, latitude, longitude, filed)
    order = filed if sorting is None else sorting if filed is None else filed[sorting]
    plane = Plane(0.0, 0.0)
    if usable.any():
        plane = _centre(*_some(latitude, longitude, usable, order))
        usable &= ~_null_island(latitude, longitude, usable, plane)
    if usable.any():
        plane = _centre(*_some(latitude, longitude, usable, order))
    codes = np.full(n, FixReason.invalid, dtype=np.uint8)
    codes[usable if filed is None else usable & np.isfinite(internal)] = FixReason.ok
    if shift is not None:
        off = np.flatnonzero(shift) if filed is None else filed[np.flatnonzero(shift)]
        codes[off[usable[off]]] = FixReason.out_of_order
    t = moved if sorting is None else moved[sorting]
    if t.size and t[0] != 0.0:
        t = t - t[0]
    held = usable if order is None else usable[order]
    duplicates, twins = find_twins(t, latitude, longitude, held, order)
    alone = held.copy()
    alone[duplicates] = False
    codes[duplicates if order is None else order[duplicates]] = FixReason.duplicate
    repeat = np.zeros(t.size, dtype=np.bool_)
    repeat[alone] = repeats(*(_chosen(column, alone, order) for column in (latitude, longitude)))
    lat_known, lon_known = _where_usable(latitude, longitude, usable)
    fixes = Projected(plane, lat_known, lon_known, held, order)
    measures = alone & ~repeat
    velocity, velocity_variance = trusted_velocities(
        t, fixes, velocities_of(speed_mps, bearing_deg, plane, latitude, longitude, order), measures
    )
    return Rows(
        time=column,
        axis=axis,
        codes=codes,
        lat_deg=lat_known,
        lon_deg=lon_known,
        order=order,
        t=np.ascontiguousarray(t),
        fixes=fixes,
        measures=measures,
        repeat=repeat,
        duplicates=duplicates,
        twins=twins,
        shift=None if shift is None else shift if sorting is None else shift[sorting],
        reported=reported_radii(accuracy_m, n, order),
        height=heights_of(height_m, n, order),
        velocity=velocity,
        velocity_variance=velocity_variance,
        plane=plane,
        was_sorted=order is None or bool(np.all(order[1:] > order[:-1])),
    )


def times_of(t_s: ArrayLike) -> tuple[FloatArray, TimeAxis, npt.NDArray[Any]]:
    """Give times since the first, their axis, and the caller's times as numbers or datetime64[ns]."""
    array = np.asarray(t_s)
    try:
        if array.dtype.kind == "U" or (array.dtype.kind == "O" and _holds_text(array)):
            array = as_moments(array)
        return _of_moments(array) if array.dtype == "datetime64[ns]" and array.ndim == 1 else as_times(array)
    except InputError as error:
        raise InputError("t_s", error.message) from error


def _of_moments(
    moments: npt.NDArray[np.datetime64],
) -> tuple[FloatArray, TimeAxis, npt.NDArray[np.datetime64]]:
    """Seconds since the first of many points in time, with intermediate results for some at a time."""
    known = [
        part[~np.isnat(part)].min(initial=np.datetime64(np.iinfo(np.int64).max, "ns"))
        for part in _parts(moments)
    ]
    if not any(part < np.datetime64(np.iinfo(np.int64).max, "ns") for part in known):
        return as_times(moments)
    axis = TimeAxis("datetime", min(known))
    seconds = np.empty(moments.size)
    for part, out in zip(_parts(moments), _parts(seconds), strict=True):
        out[:] = axis.to_internal(part)
    return seconds, axis, moments


def _parts(column: npt.NDArray[Any]) -> list[npt.NDArray[Any]]:
    return [column[first : first + _AT_ONCE] for first in range(0, column.size, _AT_ONCE)]


def _holds_text(array: npt.NDArray[Any]) -> bool:
    return any(isinstance(value, str) for value in array.ravel())


def _some(
    latitude: FloatArray, longitude: FloatArray, usable: BoolArray, order: IntArray | None
) -> tuple[FloatArray, FloatArray]:
    """Places that show where a track is: all of a short one, of a long one some, evenly spread in time."""
    if usable.size > _MANY:
        rows = np.linspace(0, (usable.size if order is None else order.size) - 1, _MANY).astype(np.int64)
        rows = rows if order is None else order[rows]
        rows = rows[usable[rows]]
        if rows.size:
            return latitude[rows], longitude[rows]
    return latitude[usable], longitude[usable]


def _chosen(column: FloatArray, chosen: BoolArray, order: IntArray | None) -> FloatArray:
    """Values of the chosen rows in order of time."""
    if order is None:
        return column if chosen.all() else column[chosen]
    return column[order[chosen]]


def _where_usable(
    latitude: FloatArray, longitude: FloatArray, usable: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Places as they came, NaN where they are of no use; the columns themselves where all are of use."""
    if usable.all():
        return latitude, longitude
    return np.where(usable, latitude, np.nan), np.where(usable, longitude, np.nan)


def _centre(latitude: FloatArray, longitude: FloatArray) -> Plane:
    """Plane about the median of the places, taken on Cartesian coordinates."""
    places = to_cartesian(np.column_stack([latitude, longitude, np.zeros(latitude.size)]))
    middle = np.median(places, axis=0)
    if not np.linalg.norm(middle) > 1e6:
        middle = places[0]
    place = to_geodetic(middle)
    return Plane(float(place[0]), float(place[1]))


def _null_island(latitude: FloatArray, longitude: FloatArray, usable: BoolArray, plane: Plane) -> BoolArray:
    """Mark fixes at (0, 0) of a track that is elsewhere: what receivers write that know nothing."""
    zero = usable & (latitude < _NULL_ISLAND_DEG) & (latitude > -_NULL_ISLAND_DEG)
    zero &= (longitude < _NULL_ISLAND_DEG) & (longitude > -_NULL_ISLAND_DEG)
    if not zero.any() or zero.sum() == usable.sum():
        return np.zeros(usable.size, dtype=np.bool_)
    others = usable & ~zero
    place = _centre(latitude[others], longitude[others]) if 2 * zero.sum() >= usable.sum() else plane
    far = np.hypot(*place.project(np.zeros(1), np.zeros(1))[0]) > _ELSEWHERE_M
    return zero if far else np.zeros(usable.size, dtype=np.bool_)
