"""Periodogram of values at any times: what share of their variation a sinusoid of each frequency explains.

Least squares of cosine, sine and a constant (Zechmeister & Kurster 2009), weighted; for even sampling that is
the classical periodogram, for uneven sampling Lomb's and Scargle's with a floating mean.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import FloatArray
from estimators.kernels import kernel, ro

_f8 = types.float64
_REFRESHED = 512  # frequencies after which rotated phases are computed anew


@kernel(types.void(ro(_f8), ro(_f8), ro(_f8), _f8, _f8, _f8[::1]))
def _fill_powers(
    t: FloatArray, y: FloatArray, weights: FloatArray, first: float, step: float, power: FloatArray
) -> None:
    n = t.size
    total = mean = 0.0
    for i in range(n):
        total += weights[i]
        mean += weights[i] * y[i]
    mean /= total
    energy = 0.0
    for i in range(n):
        energy += weights[i] * (y[i] - mean) ** 2
    c, s = np.empty(n), np.empty(n)
    turn_c, turn_s = np.empty(n), np.empty(n)
    for i in range(n):
        angle = 2.0 * math.pi * ((step * t[i]) % 1.0)
        turn_c[i], turn_s[i] = math.cos(angle), math.sin(angle)
    for k in range(power.size):
        if k % _REFRESHED == 0:
            for i in range(n):
                angle = 2.0 * math.pi * (((first + k * step) * t[i]) % 1.0)
                c[i], s[i] = math.cos(angle), math.sin(angle)
        sum_c = sum_s = cc = ss = cs = yc = ys = 0.0
        for i in range(n):
            wc, ws = weights[i] * c[i], weights[i] * s[i]
            off = y[i] - mean
            sum_c += wc
            sum_s += ws
            cc += wc * c[i]
            ss += ws * s[i]
            cs += wc * s[i]
            yc += wc * off
            ys += ws * off
            c[i], s[i] = c[i] * turn_c[i] - s[i] * turn_s[i], s[i] * turn_c[i] + c[i] * turn_s[i]
        cc -= sum_c * sum_c / total
        ss -= sum_s * sum_s / total
        cs -= sum_c * sum_s / total
        det = cc * ss - cs * cs
        power[k] = 0.0
        if energy > 0.0 and det > 1e-9 * total * total:
            explained = (yc * yc * ss - 2.0 * yc * ys * cs + ys * ys * cc) / det
            power[k] = min(max(explained / energy, 0.0), 1.0)


def periodogram(
    t: FloatArray, y: FloatArray, weights: FloatArray, first: float, step: float, count: int
) -> FloatArray:
    """Share of the variation explained at ``count`` frequencies from ``first`` on, ``step`` apart.

    Parameters
    ----------
    t, y : ndarray of float64, shape (n,)
    weights : ndarray of float64, shape (n,)
        Not negative, not all 0.
    first, step : float
        In turns per unit of time.
    count : int

    Returns
    -------
    ndarray of float64, shape (count,)
        Between 0 and 1; 0 where the times do not tell cosine, sine and constant apart.

    Examples
    --------
    >>> t = np.arange(48.0)
    >>> power = periodogram(t, np.sin(2 * np.pi * t / 12), np.ones(48), 1 / 48, 1 / 48, 12)
    >>> int(np.argmax(power)) + 1, round(float(power.max()), 6)
    (4, 1.0)
    """
    power = np.empty(count)
    _fill_powers(t, y, weights, first, step, power)
    return power
