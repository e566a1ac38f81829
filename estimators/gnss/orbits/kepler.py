"""Satellites on the orbits that GPS, Galileo, BeiDou and QZSS broadcast: elements of Kepler with corrections.

IS-GPS-200, table 20-IV; Galileo OS SIS ICD, 5.1.1; BeiDou ICD (B1I), table 5-12, with its own frame for the
geostationary satellites; IS-QZSS-PNT as GPS.
"""

from __future__ import annotations

import math

from estimators.arrays import FloatArray
from estimators.gnss.snapshot.linearise import SPEED_OF_LIGHT
from estimators.kernels import device

SQRT_A, ECCENTRICITY, M0, DELTA_N, OMEGA0, I0, OMEGA, OMEGA_DOT, I_DOT = range(9)
CUC, CUS, CRC, CRS, CIC, CIS, TOE_OF_WEEK, AF0, AF1, AF2, GM, EARTH_TURN, GEOSTATIONARY = range(9, 22)
"""Columns of an ephemeris; SI units and radians, :data:`GEOSTATIONARY` is 1 or 0."""
COLUMNS = 22
_STEPS = 30
_CONVERGED = 1e-14
_TILT = math.radians(-5.0)
"""Of the plane in which BeiDou describes its geostationary satellites."""


@device
def eccentric_anomaly(mean: float, eccentricity: float) -> float:
    """Solve Kepler's equation by Newton's method."""
    anomaly = mean
    for _ in range(_STEPS):
        step = (anomaly - eccentricity * math.sin(anomaly) - mean) / (1.0 - eccentricity * math.cos(anomaly))
        anomaly -= step
        if abs(step) < _CONVERGED:
            break
    return anomaly


@device
def kepler_state(elements: FloatArray, tk: float, out: FloatArray) -> float:
    """Write the position in metres, in the Earth-fixed frame of that instant; ``tk`` seconds after toe.

    Returns
    -------
    float
        Relativistic part of the satellite clock in seconds (IS-GPS-200, 20.3.3.3.3.1).
    """
    a = elements[SQRT_A] ** 2
    e = elements[ECCENTRICITY]
    mean = elements[M0] + (math.sqrt(elements[GM] / a**3) + elements[DELTA_N]) * tk
    anomaly = eccentric_anomaly(mean, e)
    sine, cosine = math.sin(anomaly), math.cos(anomaly)
    latitude = math.atan2(math.sqrt(1.0 - e * e) * sine, cosine - e) + elements[OMEGA]
    s2, c2 = math.sin(2.0 * latitude), math.cos(2.0 * latitude)
    u = latitude + elements[CUS] * s2 + elements[CUC] * c2
    r = a * (1.0 - e * cosine) + elements[CRS] * s2 + elements[CRC] * c2
    i = elements[I0] + elements[I_DOT] * tk + elements[CIS] * s2 + elements[CIC] * c2
    x, y = r * math.cos(u), r * math.sin(u)
    turn = elements[EARTH_TURN]
    still = elements[GEOSTATIONARY] == 1.0
    node = elements[OMEGA0] + elements[OMEGA_DOT] * tk - turn * elements[TOE_OF_WEEK]
    if not still:
        node -= turn * tk
    sn, cn = math.sin(node), math.cos(node)
    px, py, pz = x * cn - y * math.cos(i) * sn, x * sn + y * math.cos(i) * cn, y * math.sin(i)
    if still:
        st, ct = math.sin(_TILT), math.cos(_TILT)
        qx, qy, qz = px, py * ct + pz * st, -py * st + pz * ct
        sr, cr = math.sin(turn * tk), math.cos(turn * tk)
        px, py, pz = cr * qx + sr * qy, -sr * qx + cr * qy, qz
    out[0] = px
    out[1] = py
    out[2] = pz
    relativity: float = -2.0 * math.sqrt(elements[GM] * a) / SPEED_OF_LIGHT**2 * e * sine
    return relativity
