"""Columns of a track as callers give them: checked, brought into order of time, cleared of nonsense."""

from __future__ import annotations

import numpy as np

from estimators.arrays import ArrayLike, BoolArray, FloatArray, InputError, IntArray, as_vector
from estimators.geodesy.plane import Plane
from estimators.trajectories.velocities import velocities

HEIGHT_M = 1e7
_ACCURACY_M = (0.1, 1e4)
_FASTEST_MPS = 1e4


def column_of(values: ArrayLike, field: str, n: int) -> FloatArray:
    """One number per time; anything else is the caller's mistake."""
    column = as_vector(values, field)
    if column.size != n:
        raise InputError(field, f"{column.size} values for {n} times; give one value per time")
    return column


def on_earth(latitude: FloatArray, longitude: FloatArray) -> BoolArray:
    """Whether degrees name a place."""
    return (latitude >= -90.0) & (latitude <= 90.0) & (longitude >= -360.0) & (longitude <= 360.0)


def reported_radii(accuracy_m: ArrayLike | None, n: int, order: IntArray | None) -> FloatArray | None:
    """Radii in order of time, the median where one is of no use; None if all are."""
    if accuracy_m is None:
        return None
    radii = _ordered(column_of(accuracy_m, "accuracy_m", n), order)
    known = np.isfinite(radii) & (radii > 0.0)
    if not known.any():
        return None
    return np.ascontiguousarray(np.clip(np.where(known, radii, np.median(radii[known])), *_ACCURACY_M))


def heights_of(height_m: ArrayLike | None, n: int, order: IntArray | None) -> FloatArray | None:
    """Heights in order of time, NaN where one is of no use; None if all are."""
    if height_m is None:
        return None
    heights = _ordered(column_of(height_m, "height_m", n), order)
    with np.errstate(invalid="ignore"):
        heights = np.where(np.abs(heights) <= HEIGHT_M, heights, np.nan)
    return heights if np.isfinite(heights).any() else None


def velocities_of(
    speed_mps: ArrayLike | None,
    bearing_deg: ArrayLike | None,
    plane: Plane,
    latitude: FloatArray,
    longitude: FloatArray,
    order: IntArray | None,
) -> FloatArray | None:
    """Give reported velocities in order of time; what no receiver means is left out."""
    n = latitude.size
    speed = None if speed_mps is None else _ordered(column_of(speed_mps, "speed_mps", n), order)
    bearing = None if bearing_deg is None else _ordered(column_of(bearing_deg, "bearing_deg", n), order)
    if speed is None:
        return None
    latitude, longitude = _ordered(latitude, order), _ordered(longitude, order)
    if bearing is None:
        bearing = np.full(latitude.size, np.nan)
    with np.errstate(invalid="ignore"):
        usable = on_earth(latitude, longitude) & (speed >= 0.0) & (speed <= _FASTEST_MPS)
    # What is repeated to the last digit was not measured again: the receiver's speed has frozen.
    usable[1:] &= ~((speed[1:] == speed[:-1]) & ((bearing[1:] == bearing[:-1]) | np.isnan(bearing[1:])))
    velocity = np.full((latitude.size, 2), np.nan)
    bearing = np.where(np.isfinite(bearing), bearing, np.nan) % 360.0
    velocity[usable] = velocities(plane, latitude[usable], longitude[usable], speed[usable], bearing[usable])
    return velocity if np.isfinite(velocity).any() else None


def _ordered(column: FloatArray, order: IntArray | None) -> FloatArray:
    return column if order is None else column[order]
