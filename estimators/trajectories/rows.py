"""The one door of tracks: rows in any order, some of them no use, become fixes in a plane in order of time.

What a row is known to be before anything is estimated is decided here; an index leads back to the caller's
rows. Behind this door there are no poles, no antimeridian and no NaN among what measures.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from estimators.arrays import ArrayLike, BoolArray, CodeArray, FloatArray, InputError, IntArray, as_vector
from estimators.geodesy.ellipsoid import to_cartesian, to_geodetic
from estimators.geodesy.plane import Plane
from estimators.time_axis import TimeAxis, as_moments, as_times
from estimators.trajectories.clock import clock_shifts
from estimators.trajectories.reasons import FixReason
from estimators.trajectories.stale import repeats
from estimators.trajectories.velocities import velocities

LONGEST_S = 1e10
"""Tracks span at most three hundred years; longer ones are in another unit."""
_NULL_ISLAND_DEG = 1e-7
_ELSEWHERE_M = 1e3
_ACCURACY_M = (0.1, 1e4)
HEIGHT_M = 1e7
_FASTEST_MPS = 1e4


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
    order : ndarray of int64, shape (m,)
        Input rows in order of time.
    t : ndarray, shape (m,)
        Seconds since the first, ascending; clocks that were off put right.
    fixes : ndarray, shape (m, 2)
        East and north in the plane, metres; 0 where a row has no place.
    measures : ndarray of bool, shape (m,)
        Whether a row measures something: neither invalid nor a duplicate nor a repeat.
    repeat : ndarray of bool, shape (m,)
        Rows that repeat the position before them.
    twin : ndarray of int64, shape (m,)
        Place, in order of time, of the row that a duplicate repeats; its own for others.
    shift : ndarray, shape (m,)
        Seconds that were added to put a clock right; mostly 0.
    reported : ndarray, shape (m,), or None
        Radii that hold 68 %.
    height : ndarray, shape (m,), or None
        NaN where there is none.
    velocity : ndarray, shape (m, 2), or None
        As reported, along the plane's axes, m/s; NaN where there is none.
    plane : Plane
    was_sorted : bool
    """

    time: npt.NDArray[Any]
    axis: TimeAxis
    codes: CodeArray
    lat_deg: FloatArray
    lon_deg: FloatArray
    order: IntArray
    t: FloatArray
    fixes: FloatArray
    measures: BoolArray
    repeat: BoolArray
    twin: IntArray
    shift: FloatArray
    reported: FloatArray | None
    height: FloatArray | None
    velocity: FloatArray | None
    plane: Plane
    was_sorted: bool


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
    longitude = np.where(np.abs(longitude) > 180.0, (longitude + 180.0) % 360.0 - 180.0, longitude)
    timed = np.isfinite(internal)
    with np.errstate(invalid="ignore"):
        if timed.any() and np.ptp(internal[timed]) > LONGEST_S:
            raise InputError("t_s", "the times span more than 300 years; give seconds, or points in time")
    plane = Plane(0.0, 0.0)
    if usable.any():
        plane = _centre(latitude[usable], longitude[usable])
        usable &= ~_null_island(latitude, longitude, usable, plane)
    if usable.any():
        plane = _centre(latitude[usable], longitude[usable])
    codes = np.where(usable & timed, FixReason.ok, FixReason.invalid).astype(np.uint8)
    filed = np.flatnonzero(timed)
    shifts = clock_shifts(internal[filed])
    moved = internal[filed] + shifts
    codes[filed[(shifts != 0.0) & usable[filed]]] = FixReason.out_of_order
    # Ties in time are ordered by place, so that the answer does not depend on the order of the rows.
    sorting = np.lexsort((longitude[filed], latitude[filed], moved))
    order, t = filed[sorting], moved[sorting]
    t = t - (t[0] if order.size else 0.0)
    held = usable[order]
    fixes = np.zeros((order.size, 2))
    fixes[held] = plane.project(latitude[order][held], longitude[order][held])
    twin = _twins(t, latitude[order], longitude[order], held)
    alone = held & (twin == np.arange(order.size))
    codes[order[held & ~alone]] = FixReason.duplicate
    repeat = np.zeros(order.size, dtype=np.bool_)
    repeat[alone] = repeats(latitude[order][alone], longitude[order][alone])
    return Rows(
        time=column,
        axis=axis,
        codes=codes,
        lat_deg=np.where(usable, latitude, np.nan),
        lon_deg=np.where(usable, longitude, np.nan),
        order=order,
        t=np.ascontiguousarray(t),
        fixes=fixes,
        measures=alone & ~repeat,
        repeat=repeat,
        twin=twin,
        shift=shifts[sorting],
        reported=_reported(accuracy_m, n, order),
        height=_heights(height_m, n, order),
        velocity=_velocities(speed_mps, bearing_deg, plane, latitude, longitude, order),
        plane=plane,
        was_sorted=bool(np.all(np.diff(order) > 0)),
    )


def times_of(t_s: ArrayLike) -> tuple[FloatArray, TimeAxis, npt.NDArray[Any]]:
    """Give times since the first, their axis, and the caller's times as numbers or datetime64[ns]."""
    array = np.asarray(t_s)
    try:
        if array.dtype.kind == "U" or (array.dtype.kind == "O" and _holds_text(array)):
            array = as_moments(array)
        return as_times(array)
    except InputError as error:
        raise InputError("t_s", error.message) from error


def _holds_text(array: npt.NDArray[Any]) -> bool:
    return any(isinstance(value, str) for value in array.ravel())


def column_of(values: ArrayLike, field: str, n: int) -> FloatArray:
    """One number per time; anything else is the caller's mistake."""
    column = as_vector(values, field)
    if column.size != n:
        raise InputError(field, f"{column.size} values for {n} times; give one value per time")
    return column


def on_earth(latitude: FloatArray, longitude: FloatArray) -> BoolArray:
    """Whether degrees name a place."""
    return (np.abs(latitude) <= 90.0) & (np.abs(longitude) <= 360.0)


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
    zero = usable & (np.abs(latitude) < _NULL_ISLAND_DEG) & (np.abs(longitude) < _NULL_ISLAND_DEG)
    if not zero.any() or zero.sum() == usable.sum():
        return np.zeros(usable.size, dtype=np.bool_)
    others = usable & ~zero
    place = _centre(latitude[others], longitude[others]) if 2 * zero.sum() >= usable.sum() else plane
    far = np.hypot(*place.project(np.zeros(1), np.zeros(1))[0]) > _ELSEWHERE_M
    return zero if far else np.zeros(usable.size, dtype=np.bool_)


def _twins(t: FloatArray, latitude: FloatArray, longitude: FloatArray, held: BoolArray) -> IntArray:
    """Place of the first row of the same time and position; rows are sorted by all three."""
    same = np.zeros(t.size, dtype=np.bool_)
    same[1:] = (
        (t[1:] == t[:-1])
        & (latitude[1:] == latitude[:-1])
        & (longitude[1:] == longitude[:-1])
        & held[1:]
        & held[:-1]
    )
    return np.asarray(np.maximum.accumulate(np.where(same, 0, np.arange(t.size))), dtype=np.int64)


def _reported(accuracy_m: ArrayLike | None, n: int, order: IntArray) -> FloatArray | None:
    if accuracy_m is None:
        return None
    radii = column_of(accuracy_m, "accuracy_m", n)[order]
    known = np.isfinite(radii) & (radii > 0.0)
    if not known.any():
        return None
    return np.ascontiguousarray(np.clip(np.where(known, radii, np.median(radii[known])), *_ACCURACY_M))


def _heights(height_m: ArrayLike | None, n: int, order: IntArray) -> FloatArray | None:
    if height_m is None:
        return None
    heights = column_of(height_m, "height_m", n)[order]
    with np.errstate(invalid="ignore"):
        heights = np.where(np.abs(heights) <= HEIGHT_M, heights, np.nan)
    return heights if np.isfinite(heights).any() else None


def _velocities(
    speed_mps: ArrayLike | None,
    bearing_deg: ArrayLike | None,
    plane: Plane,
    latitude: FloatArray,
    longitude: FloatArray,
    order: IntArray,
) -> FloatArray | None:
    """Give reported velocities in order of time; what no receiver means is left out."""
    n = latitude.size
    speed = None if speed_mps is None else column_of(speed_mps, "speed_mps", n)[order]
    bearing = None if bearing_deg is None else column_of(bearing_deg, "bearing_deg", n)[order]
    if speed is None:
        return None
    if bearing is None:
        bearing = np.full(order.size, np.nan)
    with np.errstate(invalid="ignore"):
        usable = on_earth(latitude[order], longitude[order]) & (speed >= 0.0) & (speed <= _FASTEST_MPS)
    # What is repeated to the last digit was not measured again: the receiver's speed has frozen.
    usable[1:] &= ~((speed[1:] == speed[:-1]) & ((bearing[1:] == bearing[:-1]) | np.isnan(bearing[1:])))
    velocity = np.full((order.size, 2), np.nan)
    bearing = np.where(np.isfinite(bearing), bearing, np.nan) % 360.0
    places = latitude[order][usable], longitude[order][usable]
    velocity[usable] = velocities(plane, *places, speed[usable], bearing[usable])
    return velocity if np.isfinite(velocity).any() else None
