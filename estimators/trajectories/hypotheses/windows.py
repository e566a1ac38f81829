"""Short windows that overlap, a motion in each, and what they say of every fix together.

A window is as long as the motion stays steady to within the noise, so that constant velocity is a model of
it; what the motion may still bend is allowed for. A track is cut at gaps. Voting has a limit that no window
can see past: faults that fill a window agree with one another (METHODS_TRACKS, "Negative results").
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus import engine
from estimators.consensus.scores.msac import Msac
from estimators.consensus.search.sampling import SamplingSearch
from estimators.options import RobustOptions
from estimators.trajectories.estimation import Measured
from estimators.trajectories.hypotheses.steady_motion import SteadyMotion
from estimators.trajectories.parameters import TrackParameters

GATE = math.sqrt(9.21)
"""Of a whitened distance: 99 % of chi-square with two degrees of freedom."""
_FEWEST_BESIDE, _MOST_BESIDE = 4, 12
"""Fixes on each side of the middle of a window; all pairs of 25 fixes fit the work budget of the engine."""
_FEWEST = 4
"""Two fixes make a motion, and a third may agree by chance."""
_GAP_STEPS = 10.0
_POLICIES = SamplingSearch(score=Msac(), block=512)
_OPTIONS = RobustOptions()

FindMotion = Callable[[SteadyMotion, FloatArray], FloatArray | None]
"""From a window and its times to a motion, shape (4,); None if there is none."""


def find_motion(model: SteadyMotion, t: FloatArray) -> FloatArray | None:
    """Find the motion with the best consensus: every pair of fixes is tried, so that no draw is random.

    Parameters
    ----------
    model : SteadyMotion
    t : ndarray, shape (n,)
        Its times.
    """
    found = engine.search(model, _POLICIES, GATE, _OPTIONS, seed=0, positions=t)
    return None if found is None else found.theta


def closeness(model: SteadyMotion, theta: FloatArray) -> FloatArray:
    """K of each fix: 1 on the motion, 1/2 at the gate, 0 from sqrt(2) gates on."""
    residual = model.residuals(theta[None, :], 0, model.n)[0]
    return np.asarray(1.0 - np.minimum(0.5 * (residual / GATE) ** 2, 1.0))


def ballot(
    measured: Measured, parameters: TrackParameters, find: FindMotion, max_speed_mps: float | None
) -> FloatArray:
    """Mean closeness of each fix to the motions of its windows, weighted by how many agree to them.

    Parameters
    ----------
    measured : Measured
    parameters : TrackParameters
        Noise and manoeuvre say how long windows are.
    find : callable
        Finds the motion of a window.
    max_speed_mps : float or None

    Returns
    -------
    ndarray, shape (n,)
        From 0 to 1; 1 where there are too few fixes to say.
    """
    n = measured.t.size
    top = np.inf if max_speed_mps is None else max_speed_mps
    sigma = np.sqrt(measured.variance(parameters) + parameters.colour_m**2)
    votes, summed = np.zeros(n), np.zeros(n)
    beside = _fixes_beside(measured.t, float(np.median(sigma)), parameters.manoeuvre)
    for first, last in _windows(measured.t, beside):
        t = np.ascontiguousarray(measured.t[first:last])
        # How far a motion that is not quite steady leaves a straight line over half of the window.
        bend = parameters.manoeuvre * (0.5 * (t[-1] - t[0])) ** 3 / 6.0
        model = SteadyMotion(t, measured.fixes[first:last], np.sqrt(sigma[first:last] ** 2 + bend), top)
        theta = find(model, t)
        if theta is None:
            continue
        near = closeness(model, theta)
        agreeing = float(np.mean(near >= 0.5))
        votes[first:last] += agreeing
        summed[first:last] += agreeing * near
    return np.divide(summed, votes, out=np.ones(n), where=votes > 0.0)


def _fixes_beside(t: FloatArray, sigma: float, manoeuvre: float) -> int:
    """Count the fixes on each side of the middle: so many that the motion bends by no more than the noise."""
    if t.size < 2:
        return _FEWEST_BESIDE
    step = float(np.median(np.diff(t)))
    steady_s = (6.0 * sigma**2 / manoeuvre) ** (1.0 / 3.0)
    if steady_s >= _MOST_BESIDE * step:
        return _MOST_BESIDE
    return max(_FEWEST_BESIDE, int(steady_s / step))


def _windows(t: FloatArray, beside: int) -> list[tuple[int, int]]:
    """First fix and last + 1 of each window; a fix lies in about four of them."""
    steps = np.diff(t)
    typical = float(np.median(steps)) if steps.size else 0.0
    cuts = np.flatnonzero(steps > _GAP_STEPS * typical) + 1 if typical > 0.0 else np.empty(0, dtype=np.int64)
    edges = [0, *cuts.tolist(), t.size]
    length, stride = 2 * beside + 1, max(1, beside // 2)
    windows = []
    for start, stop in itertools.pairwise(edges):
        if stop - start < _FEWEST:
            continue
        last = max(start, stop - length)
        firsts = [*range(start, last, stride), last]
        windows += [(first, min(first + length, stop)) for first in firsts]
    return windows
