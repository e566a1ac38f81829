"""Ionosphere and troposphere on the ways to satellites, as seen from places that are known roughly."""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import FloatArray, IntArray
from estimators.geodesy.ellipsoid import geodetic_of
from estimators.geodesy.local_frame import fill_enu_axes
from estimators.gnss.corrections.klobuchar import klobuchar_of
from estimators.gnss.corrections.saastamoinen import saastamoinen_of
from estimators.gnss.snapshot.linearise import EARTH_RATE, SPEED_OF_LIGHT
from estimators.kernels import device, kernel, ro


@device
def fill_corrections(
    satellites: FloatArray,
    rotated: bool,
    place: FloatArray,
    second: float,
    coefficients: FloatArray,
    ionosphere_gain: FloatArray,
    troposphere: bool,
    azimuth: FloatArray,
    elevation: FloatArray,
    ionosphere: FloatArray,
    wet_and_dry: FloatArray,
) -> None:
    """Write directions in radians and delays in metres of the satellites of one epoch, seen from a place."""
    axes = np.empty((3, 3))
    fill_enu_axes(place[0], place[1], place[2], axes)
    latitude, longitude, height = geodetic_of(place[0], place[1], place[2])
    for i in range(azimuth.size):
        dx, dy, dz = satellites[i, 0], satellites[i, 1], satellites[i, 2]
        if not rotated:
            way = math.sqrt((dx - place[0]) ** 2 + (dy - place[1]) ** 2 + (dz - place[2]) ** 2)
            angle = EARTH_RATE * way / SPEED_OF_LIGHT
            dx, dy = math.cos(angle) * dx + math.sin(angle) * dy, math.cos(angle) * dy - math.sin(angle) * dx
        dx, dy, dz = dx - place[0], dy - place[1], dz - place[2]
        east = axes[0, 0] * dx + axes[0, 1] * dy + axes[0, 2] * dz
        north = axes[1, 0] * dx + axes[1, 1] * dy + axes[1, 2] * dz
        up = axes[2, 0] * dx + axes[2, 1] * dy + axes[2, 2] * dz
        azimuth[i] = math.atan2(east, north)
        elevation[i] = math.atan2(up, math.hypot(east, north))
        ionosphere[i] = 0.0
        wet_and_dry[i] = 0.0
        if ionosphere_gain[i] > 0.0:
            ionosphere[i] = ionosphere_gain[i] * klobuchar_of(
                second, latitude, longitude, azimuth[i], elevation[i], coefficients
            )
        if troposphere:
            wet_and_dry[i] = saastamoinen_of(latitude, height, elevation[i])


@kernel(
    types.void(
        ro(types.float64, 2),
        ro(types.int64),
        types.boolean,
        ro(types.float64, 2),
        ro(types.float64),
        ro(types.float64),
        ro(types.float64),
        types.boolean,
        types.float64[::1],
        types.float64[::1],
        types.float64[::1],
        types.float64[::1],
    )
)
def fill_atmosphere(
    satellites: FloatArray,
    offsets: IntArray,
    rotated: bool,
    places: FloatArray,
    seconds: FloatArray,
    coefficients: FloatArray,
    ionosphere_gain: FloatArray,
    troposphere: bool,
    azimuth: FloatArray,
    elevation: FloatArray,
    ionosphere: FloatArray,
    wet_and_dry: FloatArray,
) -> None:
    """Correct epochs seen from known places.

    Parameters
    ----------
    satellites : ndarray, one row per satellite and epoch
    offsets : ndarray of int64, shape (epochs + 1,)
    rotated : bool
        Whether satellite positions are in the frame of reception.
    places, seconds : ndarray, shape (epochs, 3) and (epochs,)
        Where the receiver was, and the second of GPS time.
    coefficients : ndarray, shape (8,)
        Alpha and beta of Klobuchar.
    ionosphere_gain : ndarray, one row per satellite and epoch
        (L1 / f)^2; 0 leaves the ionosphere alone.
    troposphere : bool
    azimuth, elevation, ionosphere, wet_and_dry : ndarray, one row per satellite and epoch
        Out: radians and metres.
    """
    for e in range(offsets.size - 1):
        a, b = offsets[e], offsets[e + 1]
        fill_corrections(
            satellites[a:b],
            rotated,
            places[e],
            seconds[e],
            coefficients,
            ionosphere_gain[a:b],
            troposphere,
            azimuth[a:b],
            elevation[a:b],
            ionosphere[a:b],
            wet_and_dry[a:b],
        )
