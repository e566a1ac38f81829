"""Where a track moves and where it stands, and how its speed changes.

A receiver that stands still wanders by its noise. Displacements count over a span in which noise moves the
smoothed track by less than people walk.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.regression.theil_sen import theil_sen, theil_sen_interval
from estimators.result import Estimate
from estimators.trajectories.distance import length_of
from estimators.trajectories.labelling.modes import COLOUR_TIME_S
from estimators.trajectories.stale import runs_of
from estimators.trajectories.track import Stretch

SLOW_MPS = 0.35
"""Slower than this over the span is a stop: a third of an easy walk."""
_NOISE_MPS = 0.1
_LEAST_SPAN_S, _MOST_SPAN_S = 5.0, 60.0
_SHORTEST_S = 5.0
_FEWEST = 4
_TREND_FIXES = 2000
"""A trend of speed is taken from at most so many fixes, evenly spread: Theil-Sen needs no more."""


def is_moving(t: FloatArray, places: FloatArray, sigma: FloatArray) -> BoolArray:
    """Mark rows where the track moves.

    Parameters
    ----------
    t : ndarray, shape (m,)
    places : ndarray, shape (m, 2)
        Smoothed, metres.
    sigma : ndarray, shape (m,)
        Their standard deviations per axis.

    Returns
    -------
    ndarray of bool, shape (m,)
    """
    m = t.size
    if m < 2:
        return np.zeros(m, dtype=np.bool_)
    wander = float(np.median(sigma))
    half = 0.5 * min(_MOST_SPAN_S, max(2.0 * _LEAST_SPAN_S, math.sqrt(2.0) * wander / _NOISE_MPS))
    rows = np.arange(m)
    before = np.minimum(np.searchsorted(t, t - half), np.maximum(rows - 1, 0))
    after = np.maximum(np.searchsorted(t, t + half, side="right") - 1, np.minimum(rows + 1, m - 1))
    gone = np.hypot(*(places[after] - places[before]).T)
    span = np.maximum(t[after] - t[before], 1e-9)
    noise = math.sqrt(2.0) * np.maximum(sigma[after], sigma[before]) / span
    moving = gone / span > np.maximum(SLOW_MPS, 2.0 * noise)
    return _without_short(t, moving, max(_SHORTEST_S, 0.5 * half))


def _without_short(t: FloatArray, moving: BoolArray, shortest_s: float) -> BoolArray:
    """Give stretches shorter than a duration to what is around them, stops first."""
    out = moving.copy()
    for kind in (False, True):
        for first, stop in runs_of(out == kind):
            inside = first > 0 and stop < t.size
            if inside and t[stop] - t[first - 1] < shortest_s:
                out[first:stop] = not kind
    return out


def stretches(
    t: FloatArray,
    ground: FloatArray,
    sigma: FloatArray,
    speed: FloatArray,
    moving: BoolArray,
    order: IntArray,
    level: float,
) -> tuple[Stretch, ...]:
    """Stretches of motion in order of time.

    Parameters
    ----------
    t, sigma, speed : ndarray, shape (m,)
    ground : ndarray, shape (m, 3)
        Smoothed places, Cartesian.
    moving : ndarray of bool, shape (m,)
    order : ndarray of int64, shape (m,)
        Input rows in order of time.
    level : float
        Of the interval of the trend.
    """
    found = []
    for kind in (False, True):
        for first, stop in runs_of(moving == kind):
            found.append((first, stop, kind))
    answer = []
    for first, stop, kind in sorted(found):
        # A stretch ends where the next begins, so that durations add up to that of the track.
        end = min(stop + 1, t.size)
        length = length_of(np.ascontiguousarray(ground[first:end]), sigma[first:end])
        answer.append(
            Stretch(
                kind="moving" if kind else "stopped",
                first=int(order[first]),
                last=int(order[stop - 1]),
                duration_s=float(t[end - 1] - t[first]),
                distance_m=length if kind else 0.0,
                speed_mps=float(np.median(speed[first:stop])),
                acceleration_mps2=_trend(t[first:stop], speed[first:stop], level) if kind else None,
            )
        )
    return tuple(answer)


def _trend(t: FloatArray, speed: FloatArray, level: float) -> Estimate | None:
    if t.size < _FEWEST or not t[-1] > t[0]:
        return None
    if t.size > _TREND_FIXES:
        chosen = np.linspace(0, t.size - 1, _TREND_FIXES).astype(np.int64)
        t, speed = t[chosen], speed[chosen]
    t, speed = np.ascontiguousarray(t - t[0]), np.ascontiguousarray(speed)
    slope = theil_sen(t, speed).slope
    # Speeds nearer than the correlation time tell the same thing twice.
    alike = max(1.0, 2.0 * COLOUR_TIME_S * (t.size - 1) / float(t[-1]))
    interval = theil_sen_interval(t, speed, level, inflation=alike)
    if interval is None:
        return Estimate(slope, None, None, None)
    return Estimate(slope, interval.stderr, interval.low, interval.high)
