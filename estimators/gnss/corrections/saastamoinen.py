"""Delay in the troposphere by Saastamoinen's model in a standard atmosphere.

Towards the zenith: Saastamoinen 1972, "Atmospheric correction for the troposphere and stratosphere in radio
ranging of satellites"; pressure and temperature by height of the US Standard Atmosphere 1976 with 70 %
relative humidity, as RTKLIB's single points take them (its manual, E.5).

Aslant: the mapping function of Black and Eisner 1984, "Correcting satellite Doppler data for tropospheric
effects" (Journal of Geophysical Research 89), as satellite-based augmentation takes it (RTCA DO-229,
A.4.2.4). A flat atmosphere, 1 / sin el, is 3 % too long at 10 degrees, which is 40 cm: Saastamoinen's own
formula has a term for the Earth's curvature, which the manual leaves out.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import ArrayLike, FloatArray
from estimators.kernels import device, kernel, ro

_HUMIDITY = 0.7
_SLANT, _CURVED = 1.001, 0.002001
"""1.001 / sqrt(0.002001 + sin^2 el): within 1 % of traced rays down to 5 degrees."""
_TOP_M = 40e3
"""Above, the pressure law ends, and less than 1 cm is left."""


@device
def saastamoinen_of(latitude: float, height: float, elevation: float) -> float:
    """Delay in metres; angles in radians, height above the ellipsoid in metres."""
    if elevation <= 0.0 or height > _TOP_M:
        return 0.0
    h = max(height, 0.0)
    pressure = 1013.25 * math.pow(1.0 - 2.2557e-5 * h, 5.2568)
    kelvin = 15.0 - 6.5e-3 * h + 273.16
    vapour = 6.108 * _HUMIDITY * math.exp((17.15 * kelvin - 4684.0) / (kelvin - 38.45))
    dry = 0.0022768 * pressure / (1.0 - 0.00266 * math.cos(2.0 * latitude) - 0.00028 * h / 1e3)
    wet = 0.002277 * (1255.0 / kelvin + 0.05) * vapour
    return (dry + wet) * _SLANT / math.sqrt(_CURVED + math.sin(elevation) ** 2)


@kernel(types.void(*(ro(types.float64),) * 3, types.float64[::1]))
def _fill(latitude: FloatArray, height: FloatArray, elevation: FloatArray, out: FloatArray) -> None:
    for i in range(out.size):
        out[i] = saastamoinen_of(math.radians(latitude[i]), height[i], math.radians(elevation[i]))


def saastamoinen_delay(latitude_deg: ArrayLike, height_m: ArrayLike, elevation_deg: ArrayLike) -> FloatArray:
    """Find how much longer the troposphere makes a pseudorange; the same at every frequency.

    Parameters
    ----------
    latitude_deg, height_m : array_like, shape (n,) or ()
        Of the receiver; height above the ellipsoid.
    elevation_deg : array_like, shape (n,) or ()
        Of the satellite.

    Returns
    -------
    ndarray of float64, shape (n,)
        Metres; 0 below the horizon and above 40 km.

    Examples
    --------
    >>> saastamoinen_delay(55.5, 60.0, [90.0, 10.0]).round(2).tolist()
    [2.41, 13.43]
    """
    latitude, height, elevation = (
        np.ascontiguousarray(column, dtype=np.float64)
        for column in np.broadcast_arrays(*map(np.atleast_1d, (latitude_deg, height_m, elevation_deg)))
    )
    out = np.empty(elevation.size)
    _fill(latitude, height, elevation, out)
    return out
