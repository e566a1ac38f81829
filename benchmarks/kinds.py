"""Kinds of contamination on the bed that methods are compared on, and the parts all kinds are made of.

Each kind is one function ``kind(n, outliers, rng) -> Contaminated``; kinds that no method here was tuned on
are in :mod:`benchmarks.families`, and :mod:`benchmarks.bed` puts a trend beneath them. The constants of
these files appear nowhere in ``estimators``: a benchmark that the product knows is no benchmark.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeAlias

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray

SPAN = 100.0
"""Length of the time axis, in units of time."""
SIGMA = 1.0
"""Standard deviation of an inlier's noise."""
BOX = 60.0
"""Uniform outliers lie within this many sigma of the trend."""


@dataclass(frozen=True, slots=True)
class Contaminated:
    """What a kind of contamination returns: the values less the trend, and who is an inlier.

    A ``quantum`` above 0 says that the instrument rounds its values to multiples of it.
    """

    t: FloatArray
    offset: FloatArray
    inlier: BoolArray
    quantum: float = 0.0


Kind: TypeAlias = Callable[[int, int, np.random.Generator], Contaminated]
"""``kind(n, outliers, rng)``."""


def irregular_times(n: int, rng: np.random.Generator, gap: float = 0.15) -> FloatArray:
    """Exponential gaps, one of which is stretched to a share ``gap`` of the span."""
    steps = rng.exponential(size=n - 1)
    if gap > 0:
        longest = int(rng.integers(n - 1))
        steps[longest] = 0.0
        steps[longest] = steps.sum() * gap / (1.0 - gap)
    times = np.concatenate(([0.0], np.cumsum(steps)))
    return np.asarray(times * (SPAN / times[-1]))


def scattered_rows(n: int, outliers: int, rng: np.random.Generator) -> IntArray:
    """Rows of the outliers, anywhere."""
    return np.asarray(rng.choice(n, size=outliers, replace=False), dtype=np.int64)


def all_but(n: int, outliers: IntArray) -> BoolArray:
    """Mask of the inliers."""
    inlier = np.ones(n, dtype=bool)
    inlier[outliers] = False
    return inlier


def contiguous_runs(
    n: int, outliers: int, parts: int, unevenness: float, rng: np.random.Generator
) -> list[IntArray]:
    """Disjoint contiguous runs of rows, ``outliers`` rows in all, at random places in time.

    ``unevenness`` 0 makes the runs equally long; 1 lets the shortest be next to nothing.
    """
    parts = min(parts, outliers)
    if parts == 0:
        return []
    sizes = 1.0 + unevenness * rng.uniform(-1.0, 1.0, size=parts)
    ends = np.round(np.cumsum(sizes) / sizes.sum() * (outliers - parts)).astype(np.int64)
    lengths = np.diff(ends, prepend=0) + 1
    clean = n - outliers
    places = np.sort(rng.choice(clean + 1, size=parts, replace=clean + 1 < parts))
    starts = places + np.concatenate(([0], np.cumsum(lengths)[:-1]))
    return [np.arange(start, start + length) for start, length in zip(starts, lengths, strict=True)]


def excursion_levels(
    count: int, rng: np.random.Generator, nearest: float = 5.0, apart: float = 0.0
) -> FloatArray:
    """Offsets of excursions: ``nearest`` to 60 sigma to either side, at least ``apart`` from one another."""
    while True:
        levels = rng.choice([-1.0, 1.0], size=count) * rng.uniform(nearest, BOX, size=count)
        if count < 2 or np.diff(np.sort(levels)).min() >= apart:
            return np.asarray(levels)


def add_runs(offset: FloatArray, runs: list[IntArray], levels: FloatArray, t: FloatArray) -> Contaminated:
    """Lift each run to its level, with the noise it has."""
    inlier = np.ones(t.size, dtype=bool)
    for rows, level in zip(runs, levels, strict=True):
        offset[rows] += level
        inlier[rows] = False
    return Contaminated(t, offset, inlier)


def with_uniform(t: FloatArray, noise: FloatArray, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Noise with outliers uniform within ±60 sigma of the trend."""
    hit = scattered_rows(t.size, outliers, rng)
    offset = noise.copy()
    offset[hit] = rng.uniform(-BOX, BOX, size=hit.size)
    return Contaminated(t, offset, all_but(t.size, hit))


def uniform(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Outliers uniform within ±60 sigma of the trend."""
    return with_uniform(irregular_times(n, rng), rng.normal(size=n), outliers, rng)


def shift(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Outliers to one side: 4 + Exp(15) sigma above (or all below) the trend."""
    t, offset = irregular_times(n, rng), rng.normal(size=n)
    hit = scattered_rows(n, outliers, rng)
    offset[hit] = rng.choice([-1.0, 1.0]) * (4.0 + rng.exponential(15.0, size=hit.size))
    return Contaminated(t, offset, all_but(n, hit))


def burst(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """At most three runs in time, about equally long, each at a constant level of its own.

    Levels are 8 to 60 sigma off the trend and 15 sigma apart: were two of them alike, one line would hold
    both runs, and which line is the truth would be a matter of taste (``free_bursts`` has such draws).
    """
    t, offset = irregular_times(n, rng), rng.normal(size=n)
    runs = contiguous_runs(n, outliers, 3, 0.3, rng)
    return add_runs(offset, runs, excursion_levels(len(runs), rng, nearest=8.0, apart=15.0), t)


def competing_line(n: int, outliers: int, farthest: float, rng: np.random.Generator) -> Contaminated:
    """Line with 60 % as many points as the trend, the other outliers uniform.

    Its offsets at both ends of the range lie within ±60 sigma; one of them is at least ``farthest``.
    """
    t, offset = irregular_times(n, rng), rng.normal(size=n)
    hit = scattered_rows(n, outliers, rng)
    on_line = min(outliers, round(0.6 * (n - outliers)))
    first, last = rng.uniform(-BOX, BOX, size=2)
    while max(abs(first), abs(last)) < farthest:
        first, last = rng.uniform(-BOX, BOX, size=2)
    offset[hit[:on_line]] += first + (last - first) * t[hit[:on_line]] / SPAN
    offset[hit[on_line:]] = rng.uniform(-BOX, BOX, size=outliers - on_line)
    return Contaminated(t, offset, all_but(n, hit))


def line2(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Competing line, at least 15 sigma away at one end of the range (``near_line2`` may be closer)."""
    return competing_line(n, outliers, 15.0, rng)


def t2(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Student-t noise with 2 degrees of freedom on the inliers, and uniform outliers."""
    return with_uniform(irregular_times(n, rng), rng.standard_t(2, size=n), outliers, rng)


KINDS: MappingProxyType[str, Kind] = MappingProxyType(
    {"uniform": uniform, "shift": shift, "burst": burst, "line2": line2, "t2": t2}
)
"""The kinds of the bed."""
