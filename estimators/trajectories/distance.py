"""How far a track goes, at the scale of its motion and not of its noise.

The sum of steps grows with every wiggle that noise leaves. Here the path is walked from vertex to vertex: the
next is the first place that is farther from the last than the positions are uncertain, several times over.
Curves are cut by as little as they can be told from noise, and a receiver that stands goes nowhere.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types
from scipy.special import ndtri

from estimators.arrays import FloatArray
from estimators.kernels import kernel, ro
from estimators.result import Estimate

_REACH = 4.0
"""Standard deviations of a position from one vertex to the next."""


@kernel(types.float64(ro(types.float64, 2), ro(types.float64)))
def walk(places: FloatArray, reach: FloatArray) -> float:
    """Length of the path over places that are farther apart than a reach.

    Parameters
    ----------
    places : ndarray, shape (m, 3)
        Cartesian, metres.
    reach : ndarray, shape (m,)
        Metres.

    Returns
    -------
    float
        Metres.
    """
    total = 0.0
    last = 0
    for k in range(1, places.shape[0]):
        squared = 0.0
        for axis in range(3):
            squared += (places[k, axis] - places[last, axis]) ** 2
        if squared >= reach[k] * reach[k] and squared > 0.0:
            total += math.sqrt(squared)
            last = k
    return float(total)


def length_of(places: FloatArray, sigma: FloatArray) -> float:
    """Metres along smoothed places, shape (m, 3), whose standard deviations per axis are ``sigma``."""
    return walk(places, _REACH * sigma)


def travelled(places: FloatArray, sigma: FloatArray, level: float) -> Estimate:
    """Distance along the smoothed track.

    Its error is that of the two ends, and of the scale: half of what the path gains when it is walked in
    steps a quarter as long.

    Parameters
    ----------
    places : ndarray, shape (m, 3)
        Smoothed, Cartesian, metres.
    sigma : ndarray, shape (m,)
        Their standard deviations per axis.
    level : float
        Of the interval, which is normal.
    """
    if sigma.size < 2:
        return Estimate(0.0, 0.0, 0.0, 0.0)
    total = length_of(places, sigma)
    wiggles = walk(places, sigma) - total
    stderr = math.sqrt(float(sigma[0] ** 2 + sigma[-1] ** 2) + 0.25 * wiggles * wiggles)
    margin = float(ndtri(0.5 + 0.5 * level)) * stderr
    return Estimate(total, stderr, max(0.0, total - margin), total + margin)


def steps_of(places: FloatArray) -> FloatArray:
    """Metres from each place to the next, shape (m - 1,)."""
    return np.asarray(np.sqrt(np.sum(np.diff(places, axis=0) ** 2, axis=1)))
