"""Motions whose consensus hangs together in time: local optimisation by cuts of the chain."""

from __future__ import annotations

import numpy as np

from estimators.arrays import BoolArray, FloatArray
from estimators.statespace.cut import cut_chain
from estimators.trajectories.hypotheses.steady_motion import SteadyMotion
from estimators.trajectories.hypotheses.windows import GATE, closeness, find_motion
from estimators.trajectories.labelling.modes import COLOUR_TIME_S

COHERENCE = 0.14
"""lambda of the published settings of Graph-Cut RANSAC (METHODS.md 6.3)."""
_MOST_CUTS = 10


def cut_in_time(t: FloatArray, near: FloatArray) -> BoolArray:
    """Label fixes by the cheapest cut; neighbours bind the less the longer the time between them.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Seconds, ascending.
    near : ndarray, shape (n,)
        Closeness of each fix to the motion, 0 to 1.
    """
    inlier = np.zeros(t.size, dtype=np.bool_)
    weight = np.ascontiguousarray(np.exp(-np.diff(t) / COLOUR_TIME_S))
    cut_chain(np.ascontiguousarray(near), weight, COHERENCE, inlier)
    return inlier


def find_coherent_motion(model: SteadyMotion, t: FloatArray) -> FloatArray | None:
    """Find a motion, then label by a cut and fit the labelled fixes in turn, as long as that is better.

    Parameters
    ----------
    model : SteadyMotion
    t : ndarray, shape (n,)
        Its times.
    """
    theta = find_motion(model, t)
    if theta is None:
        return None
    best = _loss(model, theta)
    for _ in range(_MOST_CUTS):
        members = np.flatnonzero(cut_in_time(t, closeness(model, theta))).astype(np.int64)
        fitted = model.fit(members, theta)
        if fitted is None or not _loss(model, fitted) < best:
            break
        theta, best = fitted, _loss(model, fitted)
    return theta


def _loss(model: SteadyMotion, theta: FloatArray) -> float:
    """Value a motion by the truncated quadratic, the main score."""
    residual = model.residuals(theta[None, :], 0, model.n)[0]
    return float(np.sum(np.minimum((residual / GATE) ** 2, 1.0)))
