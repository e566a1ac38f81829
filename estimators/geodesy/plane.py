r"""A plane for a track: azimuthal equidistant about a point of it, exact there and back.

Places are projected by the direction of their chord from the centre and by the length of the arc over it, on
a sphere of the mean radius of curvature at the centre. It is built on Cartesian coordinates, so that poles
and the antimeridian are places like any other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import types

from estimators.arrays import FloatArray
from estimators.geodesy.ellipsoid import FLATTENING, SEMI_MAJOR_M, cartesian_of, to_cartesian
from estimators.geodesy.local_frame import enu_axes
from estimators.kernels import device, kernel, ro

_E2 = FLATTENING * (2.0 - FLATTENING)
_STEPS = 8
_NEAR_M = 1e-7
"""The way back is found when it leads back to within this."""


@device
def _to_plane(
    latitude: float, longitude: float, centre: FloatArray, axes: FloatArray, radius: float
) -> tuple[float, float]:
    """East and north of a place in radians."""
    x, y, z = cartesian_of(latitude, longitude, 0.0)
    dx, dy, dz = x - centre[0], y - centre[1], z - centre[2]
    east = axes[0, 0] * dx + axes[0, 1] * dy + axes[0, 2] * dz
    north = axes[1, 0] * dx + axes[1, 1] * dy + axes[1, 2] * dz
    up = axes[2, 0] * dx + axes[2, 1] * dy + axes[2, 2] * dz
    level = math.hypot(east, north)
    if level == 0.0:
        return east, north
    arc = 2.0 * radius * math.asin(min(1.0, math.hypot(level, up) / (2.0 * radius)))
    return east * arc / level, north * arc / level


@device
def _on_sphere(east: float, north: float, axes: FloatArray, radius: float) -> tuple[float, float]:
    """Place, in radians, of the equidistant projection of a sphere of geodetic normals."""
    distance = math.hypot(east, north)
    share = math.sin(distance / radius) / distance if distance > 0.0 else 0.0
    height = math.cos(distance / radius)
    x = share * (east * axes[0, 0] + north * axes[1, 0]) + height * axes[2, 0]
    y = share * (east * axes[0, 1] + north * axes[1, 1]) + height * axes[2, 1]
    z = share * (east * axes[0, 2] + north * axes[1, 2]) + height * axes[2, 2]
    return math.atan2(z, math.hypot(x, y)), math.atan2(y, x)


@kernel(
    types.void(
        ro(types.float64),
        ro(types.float64),
        ro(types.float64),
        ro(types.float64, 2),
        types.float64,
        types.float64[:, ::1],
    )
)
def _fill_plane(
    latitude: FloatArray,
    longitude: FloatArray,
    centre: FloatArray,
    axes: FloatArray,
    radius: float,
    out: FloatArray,
) -> None:
    for i in range(latitude.size):
        lat, lon = math.radians(latitude[i]), math.radians(longitude[i])
        out[i, 0], out[i, 1] = _to_plane(lat, lon, centre, axes, radius)


@kernel(
    types.void(
        ro(types.float64, 2),
        ro(types.float64),
        ro(types.float64, 2),
        types.float64,
        types.float64[::1],
        types.float64[::1],
    )
)
def _fill_places(
    wanted: FloatArray,
    centre: FloatArray,
    axes: FloatArray,
    radius: float,
    latitude: FloatArray,
    longitude: FloatArray,
) -> None:
    for i in range(wanted.shape[0]):
        east, north = wanted[i, 0], wanted[i, 1]
        lat, lon = _on_sphere(east, north, axes, radius)
        for _ in range(_STEPS):
            east_now, north_now = _to_plane(lat, lon, centre, axes, radius)
            off_east, off_north = wanted[i, 0] - east_now, wanted[i, 1] - north_now
            if math.hypot(off_east, off_north) < _NEAR_M:
                break
            east, north = east + off_east, north + off_north
            lat, lon = _on_sphere(east, north, axes, radius)
        latitude[i], longitude[i] = math.degrees(lat), math.degrees(lon)


@dataclass(frozen=True, slots=True)
class Plane:
    """East and north, in metres, about a centre.

    Parameters
    ----------
    latitude_deg, longitude_deg : float
        Of the centre.

    Examples
    --------
    >>> plane = Plane(48.0, 180.0)
    >>> lat, lon = plane.locate(np.array([[0.0, 0.0], [1000.0, 0.0]]))
    >>> lon.round(4).tolist()
    [180.0, -179.9866]
    """

    latitude_deg: float
    longitude_deg: float

    @property
    def radius_m(self) -> float:
        """Gaussian radius of curvature at the centre."""
        sine = math.sin(math.radians(self.latitude_deg))
        return SEMI_MAJOR_M * math.sqrt(1.0 - _E2) / (1.0 - _E2 * sine * sine)

    def project(self, latitude_deg: FloatArray, longitude_deg: FloatArray) -> FloatArray:
        """East and north of places.

        Parameters
        ----------
        latitude_deg, longitude_deg : ndarray, shape (n,)

        Returns
        -------
        ndarray, shape (n, 2)
        """
        latitude = np.ascontiguousarray(latitude_deg, dtype=np.float64)
        longitude = np.ascontiguousarray(longitude_deg, dtype=np.float64)
        out = np.empty((latitude.size, 2))
        _fill_plane(latitude, longitude, *self._frame(), self.radius_m, out)
        return out

    def locate(self, east_north_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places of points of the plane; :meth:`project` is undone.

        Parameters
        ----------
        east_north_m : ndarray, shape (n, 2)

        Returns
        -------
        latitude_deg, longitude_deg : ndarray, shape (n,)
        """
        wanted = np.ascontiguousarray(np.atleast_2d(east_north_m), dtype=np.float64)
        latitude, longitude = np.empty(len(wanted)), np.empty(len(wanted))
        _fill_places(wanted, *self._frame(), self.radius_m, latitude, longitude)
        return latitude, longitude

    def _frame(self) -> tuple[FloatArray, FloatArray]:
        centre = to_cartesian(np.array([self.latitude_deg, self.longitude_deg, 0.0]))
        return centre, np.ascontiguousarray(enu_axes(self.latitude_deg, self.longitude_deg))
