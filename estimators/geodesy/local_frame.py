"""The local frame at a place: east, north and up, azimuth and elevation."""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.geodesy.ellipsoid import geodetic_of
from estimators.kernels import device


@device
def fill_enu_axes(x: float, y: float, z: float, out: FloatArray) -> None:
    """Write the unit vectors east, north and up, as rows, at a Cartesian position."""
    latitude, longitude, _ = geodetic_of(x, y, z)
    sin_lat, cos_lat = math.sin(latitude), math.cos(latitude)
    sin_lon, cos_lon = math.sin(longitude), math.cos(longitude)
    out[0, 0] = -sin_lon
    out[0, 1] = cos_lon
    out[0, 2] = 0.0
    out[1, 0] = -sin_lat * cos_lon
    out[1, 1] = -sin_lat * sin_lon
    out[1, 2] = cos_lat
    out[2, 0] = cos_lat * cos_lon
    out[2, 1] = cos_lat * sin_lon
    out[2, 2] = sin_lat


def enu_axes(latitude_deg: float, longitude_deg: float) -> FloatArray:
    """Find the unit vectors of a place.

    Parameters
    ----------
    latitude_deg, longitude_deg : float

    Returns
    -------
    ndarray of float64, shape (3, 3)
        Rows: east, north, up; multiplied with a Cartesian difference it gives the local one.

    Examples
    --------
    >>> enu_axes(0.0, 0.0).round(3).tolist()
    [[-0.0, 1.0, 0.0], [-0.0, -0.0, 1.0], [1.0, 0.0, 0.0]]
    """
    lat, lon = math.radians(latitude_deg), math.radians(longitude_deg)
    east = [-math.sin(lon), math.cos(lon), 0.0]
    north = [-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)]
    up = [math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)]
    return np.array([east, north, up])


def azimuth_elevation(enu: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Directions in degrees.

    Parameters
    ----------
    enu : ndarray of float64, shape (n, 3)
        Differences in the local frame; any unit.

    Returns
    -------
    azimuth_deg, elevation_deg : ndarray of float64, shape (n,)
        Azimuth clockwise from north, 0 to 360; elevation -90 to 90.

    Examples
    --------
    >>> azimuth, elevation = azimuth_elevation(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 2.0]]))
    >>> azimuth.tolist(), elevation.tolist()
    ([90.0, 0.0], [0.0, 90.0])
    """
    horizontal = np.hypot(enu[:, 0], enu[:, 1])
    azimuth = np.degrees(np.arctan2(enu[:, 0], enu[:, 1])) % 360.0
    return azimuth, np.degrees(np.arctan2(enu[:, 2], horizontal))
