"""Noise of a pseudorange where the caller gives none: by elevation, or by signal strength in cities."""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray

_CODE_M = 0.3
EPHEMERIS_M = 2.0
"""Accuracy of broadcast orbits and clocks where the message is not at hand."""
_LOWEST_SINE = 0.1
_LOWEST_CITY_SINE = 0.2


def elevation_sigma(
    elevation_deg: FloatArray, letters: tuple[str, ...], accuracy_m: FloatArray | float = EPHEMERIS_M
) -> FloatArray:
    """Noise under an open sky, after the model of RTKLIB.

    sigma^2 = (0.3 f)^2 (1 + 1 / sin el) + URA^2, f = 1.5 for GLONASS and 1 for the others: code noise and
    the accuracy of broadcast ephemerides (METHODS_GNSS, "Model").

    Parameters
    ----------
    elevation_deg : ndarray of float64, shape (n,)
    letters : tuple of str, length n
        System of each satellite.
    accuracy_m : ndarray of float64, shape (n,), or float
        URA: accuracy of orbit and clock as the satellite states it.

    Returns
    -------
    ndarray of float64, shape (n,)
        Metres.

    Examples
    --------
    >>> elevation_sigma(np.array([90.0, 10.0]), ("G", "G")).round(2).tolist()
    [2.04, 2.15]
    """
    sine = np.maximum(np.sin(np.radians(elevation_deg)), _LOWEST_SINE)
    factor = np.array([1.5 if letter == "R" else 1.0 for letter in letters])
    return np.sqrt((_CODE_M * factor) ** 2 * (1.0 + 1.0 / sine) + np.square(accuracy_m))


def strength_sigma(cn0_dbhz: FloatArray, elevation_deg: FloatArray) -> FloatArray:
    """Noise among buildings, where weak signals are reflected ones.

    sigma^2 = (4 + 16 * 10^(-(C/N0 - 42) / 7)) / max(sin el, 0.2) (METHODS_GNSS, "Cities").

    Parameters
    ----------
    cn0_dbhz, elevation_deg : ndarray of float64, shape (n,)

    Returns
    -------
    ndarray of float64, shape (n,)
        Metres.

    Examples
    --------
    >>> strength_sigma(np.array([50.0, 30.0]), np.array([90.0, 30.0])).round(1).tolist()
    [2.3, 40.8]
    """
    sine = np.maximum(np.sin(np.radians(elevation_deg)), _LOWEST_CITY_SINE)
    return np.sqrt((4.0 + 16.0 * 10.0 ** (-(cn0_dbhz - 42.0) / 7.0)) / sine)
