"""A track as a receiver would hand it over, with the truth beside it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import BoolArray, FloatArray
from estimators.geodesy.ellipsoid import to_cartesian, to_geodetic
from estimators.geodesy.local_frame import enu_axes

GOOD, FAULTY, UNSCORED = 0, 1, -1


@dataclass(frozen=True, slots=True)
class Recording:
    """Rows in the order of the file.

    Attributes
    ----------
    name : str
    t_s, lat_deg, lon_deg : ndarray, shape (n,)
        As recorded.
    accuracy_m : ndarray, shape (n,), or None
        Radius of 68 %, where the receiver reports it.
    true_lat_deg, true_lon_deg : ndarray, shape (n,)
        At the stated times; NaN where there is no truth.
    label : ndarray of int8, shape (n,)
        ``GOOD``, ``FAULTY``, or ``UNSCORED``: a fault hidden by the noise, a tail that looks like a fault,
        or nobody knows.
    faulty : ndarray of bool, shape (n,)
        Rows with an injected fault, scored or not.
    sigma_m : ndarray, shape (n,)
        Of the error of a good fix, per axis.
    """

    name: str
    t_s: FloatArray
    lat_deg: FloatArray
    lon_deg: FloatArray
    accuracy_m: FloatArray | None
    true_lat_deg: FloatArray
    true_lon_deg: FloatArray
    label: np.ndarray[tuple[int], np.dtype[np.int8]]
    faulty: BoolArray
    sigma_m: FloatArray

    def __len__(self) -> int:
        return int(self.t_s.size)

    def error_m(self, lat_deg: FloatArray, lon_deg: FloatArray) -> FloatArray:
        """East and north from the truth, at the truth, shape (n, 2); NaN without one."""
        known = np.isfinite(self.true_lat_deg) & np.isfinite(lat_deg)
        error = np.full((len(self), 2), np.nan)
        gone = cartesian(lat_deg[known], lon_deg[known])
        gone -= cartesian(self.true_lat_deg[known], self.true_lon_deg[known])
        lat, lon = np.radians(self.true_lat_deg[known]), np.radians(self.true_lon_deg[known])
        east = np.stack([-np.sin(lon), np.cos(lon), np.zeros(lon.size)], axis=1)
        north = np.stack([-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)], axis=1)
        error[known, 0] = np.sum(east * gone, axis=1)
        error[known, 1] = np.sum(north * gone, axis=1)
        return error

    def plane_m(self, lat_deg: FloatArray, lon_deg: FloatArray) -> FloatArray:
        """East and north of the first known place of the truth, in the plane that touches there."""
        first = int(np.flatnonzero(np.isfinite(self.true_lat_deg))[0])
        origin = (float(self.true_lat_deg[first]), float(self.true_lon_deg[first]))
        gone = cartesian(lat_deg, lon_deg) - cartesian(np.array(origin[:1]), np.array(origin[1:]))
        return np.asarray(gone @ enu_axes(*origin)[:2].T)


def cartesian(lat_deg: FloatArray, lon_deg: FloatArray) -> FloatArray:
    """Earth-centred coordinates of places on the ellipsoid, shape (n, 3)."""
    return to_cartesian(np.stack([lat_deg, lon_deg, np.zeros(lat_deg.size)], axis=1))


def from_plane(plane_m: FloatArray, place: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
    """Latitudes and longitudes of points of the plane that touches the Earth at a place."""
    start = cartesian(np.array(place[:1]), np.array(place[1:]))
    geodetic = to_geodetic(np.ascontiguousarray(start + plane_m @ enu_axes(*place)[:2]))
    return geodetic[:, 0].copy(), geodetic[:, 1].copy()


def length_m(lat_deg: FloatArray, lon_deg: FloatArray) -> float:
    """Length of the line through places, those without numbers left out."""
    known = np.isfinite(lat_deg) & np.isfinite(lon_deg)
    steps = np.diff(cartesian(lat_deg[known], lon_deg[known]), axis=0)
    return float(np.sum(np.sqrt(np.sum(steps**2, axis=1))))
