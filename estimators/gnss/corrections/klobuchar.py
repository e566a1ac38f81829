"""Delay in the ionosphere by the broadcast model of Klobuchar (IS-GPS-200, 20.3.3.5.2.5, figure 20-4)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import types

from estimators.arrays import ArrayLike, FloatArray, InputError
from estimators.gnss.snapshot.linearise import SPEED_OF_LIGHT
from estimators.kernels import device, kernel, ro

_NIGHT_S = 5e-9
_DAY_S = 86400.0
_LARGEST = 1e8
"""Broadcast coefficients are at most 2^7 * 2^16 (beta) by their field lengths."""


@dataclass(frozen=True, slots=True)
class Klobuchar:
    """Coefficients as satellites broadcast them and RINEX navigation headers repeat them.

    Attributes
    ----------
    alpha : tuple of four float
        Amplitude: s, s/semicircle, s/semicircle^2, s/semicircle^3.
    beta : tuple of four float
        Period: s, and so on.

    Raises
    ------
    InputError
        If there are not four finite numbers each.
    """

    alpha: tuple[float, float, float, float]
    beta: tuple[float, float, float, float]

    def __post_init__(self) -> None:
        for name in ("alpha", "beta"):
            values = getattr(self, name)
            if len(values) != 4 or not all(math.isfinite(v) and abs(v) < _LARGEST for v in values):
                raise InputError(
                    f"klobuchar.{name}", "expected the four coefficients of a navigation message"
                )

    def coefficients(self) -> FloatArray:
        """Alpha, then beta; shape (8,)."""
        return np.array([*self.alpha, *self.beta], dtype=np.float64)


@device
def klobuchar_of(
    second: float,
    latitude: float,
    longitude: float,
    azimuth: float,
    elevation: float,
    coefficients: FloatArray,
) -> float:
    """Delay in metres at L1; angles in radians, ``second`` of GPS time (any day)."""
    if elevation <= 0.0:
        return 0.0
    height = elevation / math.pi
    psi = 0.0137 / (height + 0.11) - 0.022
    phi = latitude / math.pi + psi * math.cos(azimuth)
    phi = max(-0.416, min(0.416, phi))
    lam = longitude / math.pi + psi * math.sin(azimuth) / math.cos(phi * math.pi)
    phi += 0.064 * math.cos((lam - 1.617) * math.pi)
    local = (43200.0 * lam + second) % _DAY_S
    slant = 1.0 + 16.0 * (0.53 - height) ** 3
    amplitude, period, power = 0.0, 0.0, 1.0
    for k in range(4):
        amplitude += coefficients[k] * power
        period += coefficients[4 + k] * power
        power *= phi
    x = 2.0 * math.pi * (local - 50400.0) / max(period, 72000.0)
    delay = _NIGHT_S
    if abs(x) < 1.57:
        delay += max(amplitude, 0.0) * (1.0 - x * x / 2.0 + x**4 / 24.0)
    return SPEED_OF_LIGHT * slant * delay


_VECTOR = ro(types.float64)


@kernel(types.void(*(_VECTOR,) * 6, types.float64[::1]))
def _fill(
    second: FloatArray,
    latitude: FloatArray,
    longitude: FloatArray,
    azimuth: FloatArray,
    elevation: FloatArray,
    coefficients: FloatArray,
    out: FloatArray,
) -> None:
    for i in range(out.size):
        out[i] = klobuchar_of(
            second[i],
            math.radians(latitude[i]),
            math.radians(longitude[i]),
            math.radians(azimuth[i]),
            math.radians(elevation[i]),
            coefficients,
        )


def klobuchar_delay(
    time_of_week_s: ArrayLike,
    latitude_deg: ArrayLike,
    longitude_deg: ArrayLike,
    azimuth_deg: ArrayLike,
    elevation_deg: ArrayLike,
    model: Klobuchar,
) -> FloatArray:
    """Find how much longer the ionosphere makes a pseudorange at L1.

    At another frequency f multiply by (1575.42 MHz / f)^2.

    Parameters
    ----------
    time_of_week_s : array_like, shape (n,) or ()
        GPS time.
    latitude_deg, longitude_deg : array_like, shape (n,) or ()
        Of the receiver.
    azimuth_deg, elevation_deg : array_like, shape (n,) or ()
        Of the satellite.
    model : Klobuchar

    Returns
    -------
    ndarray of float64, shape (n,)
        Metres; 0 below the horizon.

    Examples
    --------
    >>> model = Klobuchar((4.6566e-09, 1.4901e-08, -5.9605e-08, -1.1921e-07),
    ...                   (8.1920e+04, 9.8304e+04, -6.5536e+04, -5.2429e+05))
    >>> klobuchar_delay(345600.0, 55.494, 8.457, 227.833, 60.893, model).round(2).tolist()
    [1.67]
    """
    given = (time_of_week_s, latitude_deg, longitude_deg, azimuth_deg, elevation_deg)
    second, latitude, longitude, azimuth, elevation = (
        np.ascontiguousarray(column, dtype=np.float64)
        for column in np.broadcast_arrays(*map(np.atleast_1d, given))
    )
    out = np.empty(second.size)
    _fill(second, latitude, longitude, azimuth, elevation, model.coefficients(), out)
    return out
