"""Constant velocity as a :class:`~estimators.consensus.protocols.Model`: two fixes make a hypothesis."""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.protocols import Solved

_SHORTEST_S = 1e-6
"""Fixes closer in time determine no velocity."""


class SteadyMotion:
    """Place and velocity that do not change during a window.

    Residuals are distances in the plane over the standard deviation of each fix per axis, so that none is
    negative. A hypothesis has the coefficients east, north (at the window's middle, metres from its first
    fix), and their rates.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Seconds, ascending.
    fixes : ndarray, shape (n, 2)
        East and north, metres.
    sigma : ndarray, shape (n,)
        Standard deviation of each fix per axis, metres.
    top_speed : float
        m/s; hypotheses that are faster are refused. May be infinite.

    Examples
    --------
    >>> t = np.arange(4.0)
    >>> model = SteadyMotion(t, np.column_stack([3.0 * t, 0.0 * t]), np.ones(4), np.inf)
    >>> model.solve(np.array([[0, 2]])).theta
    array([[4.5, 0. , 3. , 0. ]])
    """

    p = 4
    sample_size = 2

    def __init__(self, t: FloatArray, fixes: FloatArray, sigma: FloatArray, top_speed: float) -> None:
        self.n = int(t.size)
        self._t = t - 0.5 * (t[0] + t[-1])
        self._places = fixes - fixes[0]
        self._sigma = sigma
        self._top_speed = top_speed

    @property
    def resolution(self) -> float:
        """A few units in the last place of the farthest fix."""
        farthest = float(np.max(np.abs(self._places)))
        return max(8.0 * 2.0**-52 * farthest / float(self._sigma.min()), 1e-150)

    def solve(self, samples: IntArray) -> Solved:
        """Motions through two fixes each; those of one time are degenerate, those too fast invalid."""
        first, second = samples[:, 0], samples[:, 1]
        dt = self._t[second] - self._t[first]
        usable = dt > _SHORTEST_S
        first, second, dt = first[usable], second[usable], dt[usable]
        velocity = (self._places[second] - self._places[first]) / dt[:, None]
        place = self._places[first] - self._t[first][:, None] * velocity
        kept = np.sqrt(np.sum(velocity * velocity, axis=1)) <= self._top_speed
        owner = np.flatnonzero(usable)[kept].astype(np.int64)
        degenerate = int(usable.size - np.count_nonzero(usable))
        theta = np.ascontiguousarray(np.hstack([place, velocity])[kept])
        return Solved(theta, owner, degenerate, int(usable.size) - degenerate - owner.size)

    def residuals(self, theta: FloatArray, start: int, stop: int) -> FloatArray:
        """Whitened distances, shape (m, stop - start), from several motions."""
        t = self._t[start:stop]
        east = self._places[start:stop, 0] - (theta[:, :1] + theta[:, 2:3] * t)
        north = self._places[start:stop, 1] - (theta[:, 1:2] + theta[:, 3:4] * t)
        return np.asarray(np.sqrt(east * east + north * north) / self._sigma[start:stop])

    def residuals_at(self, theta: FloatArray, points: IntArray) -> FloatArray:
        """Whitened distances of chosen fixes from one motion."""
        east = self._places[points, 0] - (theta[0] + theta[2] * self._t[points])
        north = self._places[points, 1] - (theta[1] + theta[3] * self._t[points])
        return np.asarray(np.sqrt(east * east + north * north) / self._sigma[points])

    def fit(self, members: IntArray, theta: FloatArray) -> FloatArray | None:
        """Weighted least squares through the members; None where they have one time."""
        del theta
        weight = self._sigma[members] ** -2.0
        t, places = self._t[members], self._places[members]
        total = float(np.sum(weight))
        if members.size < self.sample_size or not total > 0.0:
            return None
        middle_t = float(np.sum(weight * t)) / total
        middle = np.sum(weight[:, None] * places, axis=0) / total
        since = t - middle_t
        spread = float(np.sum(weight * since * since))
        if not spread > total * _SHORTEST_S**2:
            return None
        velocity = np.sum((weight * since)[:, None] * (places - middle), axis=0) / spread
        if float(np.hypot(velocity[0], velocity[1])) > self._top_speed:
            return None
        return np.concatenate([middle - middle_t * velocity, velocity])
