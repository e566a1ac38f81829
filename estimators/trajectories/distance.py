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

REACH = 4.0
"""Standard deviations of a position from one vertex to the next."""


@kernel(types.void(ro(types.float64, 2), ro(types.float64), types.float64[::1]))
def walk_on(places: FloatArray, reach: FloatArray, course: FloatArray) -> None:
    """Go on along places that are farther apart than a reach.

    Parameters
    ----------
    places : ndarray, shape (m, 3)
        Cartesian, metres.
    reach : ndarray, shape (m,)
        Metres.
    course : ndarray, shape (4,)
        In and out: length so far, and the last vertex.
    """
    for k in range(places.shape[0]):
        squared = 0.0
        for axis in range(3):
            squared += (places[k, axis] - course[1 + axis]) ** 2
        if squared >= reach[k] * reach[k] and squared > 0.0:
            course[0] += math.sqrt(squared)
            for axis in range(3):
                course[1 + axis] = places[k, axis]


class Way:
    """Length of a path whose places come piece by piece.

    Parameters
    ----------
    reach : float
        From one vertex to the next, in standard deviations of a position; 0: every place is a vertex.

    Examples
    --------
    >>> way = Way(0.0)
    >>> way.add(np.zeros((1, 3)), np.ones(1))
    >>> way.add(np.array([[3.0, 4.0, 0.0]]), np.ones(1))
    >>> way.length_m
    5.0
    """

    def __init__(self, reach: float = REACH) -> None:
        self._reach = reach
        self._course = np.zeros(4)
        self._is_begun = False

    @property
    def length_m(self) -> float:
        """Metres so far."""
        return float(self._course[0])

    def add(self, places: FloatArray, sigma: FloatArray) -> None:
        """Go on along places, shape (m, 3), of standard deviations per axis, shape (m,)."""
        if not self._is_begun and len(places):
            self._course[1:] = places[0]
            self._is_begun = True
        walk_on(np.ascontiguousarray(places), np.ascontiguousarray(self._reach * sigma), self._course)


class Journey:
    """Distance along the smoothed track, whose rows come piece by piece.

    Its error is that of the two ends, and of the scale: half of what the path gains when it is walked in
    steps a quarter as long.
    """

    def __init__(self) -> None:
        self._way, self._finer = Way(), Way(1.0)
        self._ends = (math.nan, math.nan)

    def add(self, places: FloatArray, sigma: FloatArray) -> None:
        """Go on along places, shape (m, 3), of standard deviations per axis, shape (m,)."""
        self._way.add(places, sigma)
        self._finer.add(places, sigma)
        first = float(sigma[0]) if math.isnan(self._ends[0]) else self._ends[0]
        self._ends = first, float(sigma[-1])

    def travelled(self, rows: int, level: float) -> Estimate:
        """Length with a normal interval of a level."""
        if rows < 2:
            return Estimate(0.0, 0.0, 0.0, 0.0)
        total = self._way.length_m
        wiggles = self._finer.length_m - total
        stderr = math.sqrt(self._ends[0] ** 2 + self._ends[1] ** 2 + 0.25 * wiggles * wiggles)
        margin = float(ndtri(0.5 + 0.5 * level)) * stderr
        return Estimate(total, stderr, max(0.0, total - margin), total + margin)
