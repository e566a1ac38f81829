"""Two codes on two carriers, combined so that the ionosphere falls out (IS-GPS-200, 20.3.3.3.3.3)."""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray

_LEAST_GAP = 1.05
"""Squared ratio of carriers that are far enough apart: nearer ones multiply the noise by more than 25."""


def ionosphere_free(
    first_m: FloatArray, second_m: FloatArray, first_hz: FloatArray, second_hz: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Combine pseudoranges on two carriers: (g P1 - P2) / (g - 1), g = (f1 / f2)^2.

    The delay of first order, 40.3 TEC / f^2, falls out; what is left is millimetres to centimetres.

    Parameters
    ----------
    first_m, second_m : ndarray of float64, shape (n,)
        Pseudoranges, each with the group delay of its signal removed.
    first_hz, second_hz : ndarray of float64, shape (n,)
        Carriers.

    Returns
    -------
    combined_m : ndarray of float64, shape (n,)
        NaN where a code is missing or the carriers are too near to each other.
    gain : ndarray of float64, shape (n,)
        Noise of the combination in units of that of one code.

    Examples
    --------
    >>> combined, gain = ionosphere_free(*(np.array([v]) for v in (100.0, 100.0, 1575.42e6, 1227.6e6)))
    >>> combined.round(6).tolist(), gain.round(2).tolist()
    ([100.0], [2.98])
    """
    ratio = (first_hz / second_hz) ** 2
    apart = np.maximum(ratio, 1.0 / ratio) > _LEAST_GAP
    g = np.where(apart, ratio, np.nan)
    return (g * first_m - second_m) / (g - 1.0), np.sqrt(g * g + 1.0) / np.abs(g - 1.0)
