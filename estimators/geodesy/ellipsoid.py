"""Cartesian (Earth-centred, Earth-fixed) and geodetic coordinates on the WGS 84 ellipsoid.

From Cartesian to geodetic by Bowring's iteration on the reduced latitude, which reaches the last bits in a
few steps between the Earth's centre and the navigation satellites (Bowring 1976, "Transformation from
spatial to geographical coordinates", Survey Review 23). Compiled and array code run the same functions.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import FloatArray
from estimators.kernels import device, kernel, ro

SEMI_MAJOR_M = 6378137.0
FLATTENING = 1 / 298.257223563
"""WGS 84 (NIMA TR8350.2)."""
_E2 = FLATTENING * (2 - FLATTENING)
_SEMI_MINOR_M = SEMI_MAJOR_M * (1 - FLATTENING)
_EP2 = _E2 / (1 - _E2)
_STEPS = 6
"""Bowring's map contracts by about e2 squared near the ground and never slower than by e2."""


@device
def geodetic_of(x: float, y: float, z: float) -> tuple[float, float, float]:
    """Latitude and longitude in radians, height in metres; at the Earth's axis the longitude is 0."""
    p = math.hypot(x, y)
    if p == 0.0 and z == 0.0:
        return 0.0, 0.0, -SEMI_MAJOR_M
    beta = math.atan2(z * SEMI_MAJOR_M, p * _SEMI_MINOR_M)
    latitude = 0.0
    for _ in range(_STEPS):
        latitude = math.atan2(
            z + _EP2 * _SEMI_MINOR_M * math.sin(beta) ** 3, p - _E2 * SEMI_MAJOR_M * math.cos(beta) ** 3
        )
        beta = math.atan2((1.0 - FLATTENING) * math.sin(latitude), math.cos(latitude))
    sine, cosine = math.sin(latitude), math.cos(latitude)
    # The distance along the normal from the ellipsoid: well-conditioned at the equator and at the poles.
    height = p * cosine + z * sine - SEMI_MAJOR_M * math.sqrt(1.0 - _E2 * sine * sine)
    return latitude, math.atan2(y, x), height


@device
def cartesian_of(latitude: float, longitude: float, height: float) -> tuple[float, float, float]:
    """Cartesian coordinates in metres of radians and metres."""
    sine, cosine = math.sin(latitude), math.cos(latitude)
    normal = SEMI_MAJOR_M / math.sqrt(1.0 - _E2 * sine * sine)
    return (
        (normal + height) * cosine * math.cos(longitude),
        (normal + height) * cosine * math.sin(longitude),
        (normal * (1.0 - _E2) + height) * sine,
    )


@kernel(types.void(ro(types.float64, 2), types.float64[:, ::1]))
def _fill_geodetic(cartesian: FloatArray, out: FloatArray) -> None:
    for i in range(cartesian.shape[0]):
        latitude, longitude, height = geodetic_of(cartesian[i, 0], cartesian[i, 1], cartesian[i, 2])
        out[i, 0] = math.degrees(latitude)
        out[i, 1] = math.degrees(longitude)
        out[i, 2] = height


@kernel(types.void(ro(types.float64, 2), types.float64[:, ::1]))
def _fill_cartesian(geodetic: FloatArray, out: FloatArray) -> None:
    for i in range(geodetic.shape[0]):
        x, y, z = cartesian_of(math.radians(geodetic[i, 0]), math.radians(geodetic[i, 1]), geodetic[i, 2])
        out[i, 0] = x
        out[i, 1] = y
        out[i, 2] = z


def to_geodetic(cartesian_m: FloatArray) -> FloatArray:
    """Latitude and longitude in degrees and height above the ellipsoid in metres.

    Parameters
    ----------
    cartesian_m : ndarray of float64, shape (n, 3) or (3,)
        Earth-centred, Earth-fixed.

    Returns
    -------
    ndarray of float64, same shape
        Latitude, longitude (-180 to 180), height.

    Examples
    --------
    >>> to_geodetic(np.array([6378137.0, 0.0, 0.0])).tolist()
    [0.0, 0.0, 0.0]
    """
    rows = np.ascontiguousarray(np.atleast_2d(cartesian_m), dtype=np.float64)
    out = np.empty_like(rows)
    _fill_geodetic(rows, out)
    return out.reshape(np.shape(cartesian_m))


def to_cartesian(geodetic: FloatArray) -> FloatArray:
    """Earth-centred, Earth-fixed coordinates in metres.

    Parameters
    ----------
    geodetic : ndarray of float64, shape (n, 3) or (3,)
        Latitude and longitude in degrees, height above the ellipsoid in metres.

    Returns
    -------
    ndarray of float64, same shape

    Examples
    --------
    >>> to_cartesian(np.array([0.0, 0.0, 100.0])).tolist()
    [6378237.0, 0.0, 0.0]
    """
    rows = np.ascontiguousarray(np.atleast_2d(geodetic), dtype=np.float64)
    out = np.empty_like(rows)
    _fill_cartesian(rows, out)
    return out.reshape(np.shape(geodetic))
