"""Carrier frequencies of the satellite systems, by band as RINEX numbers them.

IS-GPS-200 and IS-GPS-705 (L1, L2, L5), Galileo OS SIS ICD (E1, E5a, E5b, E5, E6), BeiDou ICD (B1C, B1I, B2a,
B2b, B3I), GLONASS ICD (L1 and L2 in channels), IS-QZSS-PNT (as GPS); band numbers as in RINEX 3.05.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

L1_HZ = 1575.42e6
"""The frequency for which the broadcast ionosphere is given (IS-GPS-200, 20.3.3.5.2.5)."""

CARRIERS_HZ: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "G": {"1": L1_HZ, "2": 1227.60e6, "5": 1176.45e6},
        "E": {"1": L1_HZ, "5": 1176.45e6, "6": 1278.75e6, "7": 1207.140e6, "8": 1191.795e6},
        "C": {"1": L1_HZ, "2": 1561.098e6, "5": 1176.45e6, "6": 1268.52e6, "7": 1207.140e6},
        "J": {"1": L1_HZ, "2": 1227.60e6, "5": 1176.45e6},
        "I": {"5": 1176.45e6, "9": 2492.028e6},
        "S": {"1": L1_HZ, "5": 1176.45e6},
    }
)
"""By system letter and band; GLONASS is in :func:`carrier_hz`."""

_GLONASS_HZ = {"1": (1602.0e6, 562.5e3), "2": (1246.0e6, 437.5e3)}
_CHANNELS = range(-7, 14)
"""Channels that satellites have used."""


def first_carrier_hz(system: str) -> float:
    """Frequency of a system's first band; GLONASS at the middle of its channels.

    Parameters
    ----------
    system : str
        Letter.

    Examples
    --------
    >>> first_carrier_hz("C")
    1561098000.0
    """
    if system == "R":
        return _GLONASS_HZ["1"][0]
    return CARRIERS_HZ[system]["2" if system == "C" else "5" if system == "I" else "1"]


def carrier_hz(system: str, band: str, channel: int | None = None) -> float:
    """Frequency of a band.

    Parameters
    ----------
    system : str
        Letter.
    band : str
        Band number of RINEX 3: the digit of ``C1C``.
    channel : int, optional
        Of GLONASS, -7 to 13.

    Returns
    -------
    float
        Hertz; NaN where the band or the channel is not known.

    Examples
    --------
    >>> carrier_hz("R", "1", -4), carrier_hz("E", "5")
    (1599750000.0, 1176450000.0)
    """
    if system != "R":
        return CARRIERS_HZ.get(system, {}).get(band, math.nan)
    if band not in _GLONASS_HZ or channel is None or channel not in _CHANNELS:
        return math.nan
    base, step = _GLONASS_HZ[band]
    return base + step * channel
