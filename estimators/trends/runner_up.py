"""The best trend among the points that do not follow the answer."""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.found import Found, LineData, OtherStructure, Scale
from estimators.consensus.presets import Preset
from estimators.options import RobustOptions
from estimators.result import NoFit
from estimators.trends.line import Frame
from estimators.trends.trend import RunnerUp

LEAST_MARGIN = 3.0
"""Log evidence under which two structures are called equally good (20 to 1)."""

LEAST_SUPPORT = 5
"""Points that follow a runner-up; fewer can lie on a line by chance (METHODS.md 2.1: 0.5^5 = 3 %)."""

_RIVAL_SHARE = 0.8
"""Support, as a share of the answer's, from which counting methods call a rival equally good."""


def find_runner_up(
    data: LineData,
    found: Found,
    preset: Preset,
    scale: Scale,
    options: RobustOptions,
    seed: int,
    frame: Frame,
    intercept_at: float,
) -> RunnerUp | None:
    """Competing structure, where there is one with enough points of its own.

    A search that weighs structures reports its own second; one that counts inliers is run again on the
    points outside of its consensus. Closed estimates know no other structure.
    """
    other = found.runner_up
    if other is None and preset.search.needs_threshold:
        other = _among_outliers(data, found, preset, scale, options, seed)
    if other is None or other.inliers < LEAST_SUPPORT:
        return None
    slope = float(other.theta[1]) / frame.half
    at = (intercept_at - frame.middle) / frame.half
    return RunnerUp(
        parameters={"slope": slope, "intercept": float(other.theta[0] + other.theta[1] * at)},
        inliers=other.inliers,
        sigma=other.sigma,
        equally_good=other.margin < LEAST_MARGIN,
    )


def _among_outliers(
    data: LineData, found: Found, preset: Preset, scale: Scale, options: RobustOptions, seed: int
) -> OtherStructure | None:
    rest = np.flatnonzero(~found.inlier)
    if rest.size < LEAST_SUPPORT or data.t[rest[0]] == data.t[rest[-1]]:
        return None
    weights: FloatArray | None = None if data.weights is None else np.ascontiguousarray(data.weights[rest])
    remaining = LineData(np.ascontiguousarray(data.t[rest]), np.ascontiguousarray(data.y[rest]), weights)
    again = preset.search.run(remaining, scale, options, seed)
    if isinstance(again, NoFit):
        return None
    support = int(np.count_nonzero(again.inlier))
    own = int(np.count_nonzero(found.inlier))
    if support < 2 * _chance_support(rest.size, again.threshold, remaining.y):
        return None
    margin = 0.0 if support >= _RIVAL_SHARE * own else math.inf
    return OtherStructure(again.theta, again.sigma, support, margin)


def _chance_support(n: int, threshold: float, y: FloatArray) -> float:
    """Points that a band of the threshold covers if the values are spread evenly over their range."""
    span = float(y.max() - y.min())
    return n * min(1.0, 2.0 * threshold / span) if span > 0 else float(n)
