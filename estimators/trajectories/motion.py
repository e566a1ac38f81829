"""Where a track moves and where it stands, and how its speed changes.

A receiver that stands still wanders by its noise. Displacements count over a span in which noise moves the
smoothed track by less than people walk.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.regression.theil_sen import theil_sen, theil_sen_interval
from estimators.result import Estimate
from estimators.trajectories.distance import Way
from estimators.trajectories.labelling.modes import COLOUR_TIME_S
from estimators.trajectories.stale import runs_of
from estimators.trajectories.track import Stretch

SLOW_MPS = 0.35
"""Slower than this over the span is a stop: a third of an easy walk."""
_NOISE_MPS = 0.1
_LEAST_SPAN_S, _MOST_SPAN_S = 5.0, 60.0
_SHORTEST_S = 5.0
_FEWEST = 4
_SPEEDS = 1 << 16
"""The median speed of a stretch is taken from at most so many rows, evenly spread."""
_TREND_FIXES = 2000
"""A trend of speed is taken from at most so many fixes, evenly spread: Theil-Sen needs no more."""


def half_span(sigma: FloatArray) -> float:
    """Half of the span, in seconds, over which displacements count, given standard deviations per axis."""
    wander = float(np.median(sigma))
    return 0.5 * min(_MOST_SPAN_S, max(2.0 * _LEAST_SPAN_S, math.sqrt(2.0) * wander / _NOISE_MPS))


def is_displaced(t: FloatArray, places: FloatArray, sigma: FloatArray, half: float) -> BoolArray:
    """Mark rows where the track gets somewhere within a span.

    Parameters
    ----------
    t : ndarray, shape (m,)
        With the rows of half a span, and one at least, before and after those of interest.
    places : ndarray, shape (m, 2)
        Smoothed, metres.
    sigma : ndarray, shape (m,)
        Their standard deviations per axis.
    half : float
        Of the span, seconds.

    Returns
    -------
    ndarray of bool, shape (m,)
    """
    m = t.size
    if m < 2:
        return np.zeros(m, dtype=np.bool_)
    rows = np.arange(m)
    before = np.minimum(np.searchsorted(t, t - half), np.maximum(rows - 1, 0))
    after = np.maximum(np.searchsorted(t, t + half, side="right") - 1, np.minimum(rows + 1, m - 1))
    gone = np.hypot(*(places[after] - places[before]).T)
    span = np.maximum(t[after] - t[before], 1e-9)
    noise = math.sqrt(2.0) * np.maximum(sigma[after], sigma[before]) / span
    return np.asarray(gone / span > np.maximum(SLOW_MPS, 2.0 * noise))


def without_short(t: FloatArray, moving: BoolArray, half: float) -> BoolArray:
    """Give stretches that are short beside the span to what is around them, stops first."""
    shortest_s = max(_SHORTEST_S, 0.5 * half)
    out = moving.copy()
    for kind in (False, True):
        for first, stop in runs_of(out == kind):
            inside = first > 0 and stop < t.size
            if inside and t[stop] - t[first - 1] < shortest_s:
                out[first:stop] = not kind
    return out


class StretchGatherer:
    """Stretches of motion of a track whose rows come piece by piece, in order of time.

    Parameters
    ----------
    t : ndarray, shape (m,)
    moving : ndarray of bool, shape (m,)
    """

    def __init__(self, t: FloatArray, moving: BoolArray) -> None:
        self._t = t
        runs = [(first, stop, kind) for kind in (False, True) for first, stop in runs_of(moving == kind)]
        self._runs = sorted(runs)
        self._ways = [Way() for _ in self._runs]
        self._speeds: list[list[FloatArray]] = [[] for _ in self._runs]
        self._place = 0

    def add(self, at: int, ground: FloatArray, sigma: FloatArray, speed: FloatArray) -> None:
        """Take in rows.

        Parameters
        ----------
        at : int
            Place of the first of them.
        ground : ndarray, shape (k, 3)
            Smoothed places, Cartesian.
        sigma, speed : ndarray, shape (k,)
        """
        behind = at + speed.size
        while self._place < len(self._runs):
            first, stop, kind = self._runs[self._place]
            own = slice(max(first - at, 0), min(stop - at, speed.size))
            if own.stop > own.start:
                self._speeds[self._place].append(_evenly(speed[own], first, stop, at + own.start))
            # A stretch ends where the next begins, so that durations add up to that of the track.
            end = min(stop + 1, self._t.size)
            walked = slice(max(first - at, 0), min(end - at, speed.size))
            if kind:
                self._ways[self._place].add(ground[walked], sigma[walked])
            if behind < end:
                return
            self._place += 1

    def stretches(self, rows_of: Callable[[slice], IntArray], level: float) -> tuple[Stretch, ...]:
        """Give them in order of time, by input rows as a function finds them, with intervals of a level."""
        answer = []
        for (first, stop, kind), way, parts in zip(self._runs, self._ways, self._speeds, strict=True):
            end = min(stop + 1, self._t.size)
            speed = np.concatenate(parts)
            times = self._t[first:stop][:: _stride(first, stop)]
            answer.append(
                Stretch(
                    kind="moving" if kind else "stopped",
                    first=int(rows_of(slice(first, first + 1))[0]),
                    last=int(rows_of(slice(stop - 1, stop))[0]),
                    duration_s=float(self._t[end - 1] - self._t[first]),
                    distance_m=way.length_m if kind else 0.0,
                    speed_mps=float(np.median(speed)),
                    acceleration_mps2=_trend(times, speed, level) if kind else None,
                )
            )
        return tuple(answer)


def _stride(first: int, stop: int) -> int:
    """Every how many rows the speed of a stretch is looked at."""
    return -(-(stop - first) // _SPEEDS)


def _evenly(speed: FloatArray, first: int, stop: int, at: int) -> FloatArray:
    """Speeds of the rows that are looked at, of those of a stretch from ``at`` on."""
    stride = _stride(first, stop)
    return speed[(first - at) % stride :: stride].copy()


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
