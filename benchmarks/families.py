"""Families of contamination that no method here was tuned on; otherwise as :mod:`benchmarks.kinds`."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

import numpy as np

from benchmarks.kinds import (
    BOX,
    SPAN,
    Contaminated,
    Kind,
    add_runs,
    all_but,
    competing_line,
    contiguous_runs,
    excursion_levels,
    irregular_times,
    scattered_rows,
    with_uniform,
)
from estimators.arrays import FloatArray

STEP_SHARE = 0.4
"""Where the level steps, as a share of the span and of the points."""


def gamma(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Outliers to both sides, their distance from the trend Gamma(2, 10 sigma)."""
    t, offset = irregular_times(n, rng), rng.normal(size=n)
    hit = scattered_rows(n, outliers, rng)
    offset[hit] = rng.choice([-1.0, 1.0], size=hit.size) * rng.gamma(2.0, 10.0, size=hit.size)
    return Contaminated(t, offset, all_but(n, hit))


def sine(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Outliers follow a slow sine of large amplitude around the trend."""
    t, offset = irregular_times(n, rng), rng.normal(size=n)
    hit = scattered_rows(n, outliers, rng)
    turns, phase = rng.uniform(0.5, 2.0), rng.uniform(0.0, 2.0 * np.pi)
    offset[hit] += rng.uniform(15.0, 40.0) * np.sin(2.0 * np.pi * turns * t[hit] / SPAN + phase)
    return Contaminated(t, offset, all_but(n, hit))


def step(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Jump of the level by 8 to 30 sigma at 40 % of span and points; the longer branch is the truth.

    ``outliers`` uniform ones come on top, on both branches alike.
    """
    before = round(STEP_SHARE * n)
    t = irregular_times(n, rng, gap=0.0)
    jump = 0.5 * (t[before - 1] + t[before])
    rest = (1.0 - STEP_SHARE) * SPAN
    t = np.where(t < jump, STEP_SHARE * SPAN * t / jump, SPAN - rest * (SPAN - t) / (SPAN - jump))
    made = with_uniform(t, rng.normal(size=n), outliers, rng)
    early = np.arange(n) < before
    made.offset[early & made.inlier] += rng.choice([-1.0, 1.0]) * rng.uniform(8.0, 30.0)
    return Contaminated(t, made.offset, made.inlier & ~early)


def ends(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Uniform outliers that fill one end of the range, or both."""
    t, offset = irregular_times(n, rng), rng.normal(size=n)
    early = round(outliers * rng.choice([0.0, 0.5, 1.0]))
    hit = np.concatenate((np.arange(early), np.arange(n - outliers + early, n)))
    offset[hit] = rng.uniform(-BOX, BOX, size=outliers)
    return Contaminated(t, offset, all_but(n, hit))


def gap(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Nothing was measured for 50 to 70 % of the span; uniform outliers."""
    t = irregular_times(n, rng, gap=rng.uniform(0.5, 0.7))
    return with_uniform(t, rng.normal(size=n), outliers, rng)


def _quantised(quantum: float) -> Kind:
    def quantised(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
        made = with_uniform(irregular_times(n, rng), rng.normal(size=n), outliers, rng)
        return replace(made, quantum=quantum)

    quantised.__doc__ = f"Uniform outliers; the values are rounded to {quantum:g} sigma."
    return quantised


def heteroscedastic(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Noise that grows (or shrinks) from 0.5 to 1.3 sigma along the range; uniform outliers."""
    t = irregular_times(n, rng)
    first, last = rng.permutation([0.5, 1.3])
    return with_uniform(t, rng.normal(size=n) * (first + (last - first) * t / SPAN), outliers, rng)


def ar1_noise(n: int, phi: float, rng: np.random.Generator) -> FloatArray:
    """Autoregressive noise of order 1 along the rows, marginal standard deviation 1."""
    fresh = rng.normal(size=n) * np.sqrt(1.0 - phi * phi)
    noise = np.empty(n)
    noise[0] = rng.normal()
    for row in range(1, n):
        noise[row] = phi * noise[row - 1] + fresh[row]
    return noise


def _ar1(phi: float) -> Kind:
    def correlated(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
        return with_uniform(irregular_times(n, rng), ar1_noise(n, phi, rng), outliers, rng)

    correlated.__doc__ = f"AR(1) noise with phi = {phi:g}, marginal sigma 1; uniform outliers."
    return correlated


def walk_bursts(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Three runs in time whose offsets from the trend walk at random."""
    t, offset = irregular_times(n, rng), rng.normal(size=n)
    runs = contiguous_runs(n, outliers, 3, 0.3, rng)
    inlier = np.ones(n, dtype=bool)
    for rows, level in zip(runs, excursion_levels(len(runs), rng), strict=True):
        offset[rows] = level + np.cumsum(rng.normal(scale=2.0, size=rows.size))
        inlier[rows] = False
    return Contaminated(t, offset, inlier)


def free_bursts(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Three runs in time, about equally long, whose levels may be near the trend or alike."""
    t, offset = irregular_times(n, rng), rng.normal(size=n)
    runs = contiguous_runs(n, outliers, 3, 0.3, rng)
    return add_runs(offset, runs, excursion_levels(len(runs), rng), t)


def uneven_bursts(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Two to five runs in time of very unequal length, each at a constant level."""
    t, offset = irregular_times(n, rng), rng.normal(size=n)
    runs = contiguous_runs(n, outliers, int(rng.integers(2, 6)), 0.9, rng)
    return add_runs(offset, runs, excursion_levels(len(runs), rng), t)


def near_line2(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Competing line that may all but coincide with the trend."""
    return competing_line(n, outliers, 0.0, rng)


def clumps(n: int, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Outliers in tight clumps of time and value, mixed in time with inliers."""
    t, offset = irregular_times(n, rng), rng.normal(size=n)
    inlier = np.ones(n, dtype=bool)
    left = outliers
    while left > 0:
        size = min(left, max(3, round(outliers * rng.uniform(0.05, 0.25))))
        free = np.flatnonzero(inlier)
        near = free[np.argsort(np.abs(t[free] - rng.uniform(0.0, SPAN)), kind="stable")[: 2 * size]]
        rows = rng.choice(near, size=size, replace=False)
        offset[rows] = rng.uniform(-BOX, BOX) + rng.normal(scale=1.5, size=size)
        inlier[rows] = False
        left -= size
    return Contaminated(t, offset, inlier)


FAMILIES: MappingProxyType[str, Kind] = MappingProxyType(
    {
        "gamma": gamma,
        "sine": sine,
        "step": step,
        "ends": ends,
        "gap": gap,
        "quantised1": _quantised(1.0),
        "quantised3": _quantised(3.0),
        "heteroscedastic": heteroscedastic,
        "ar1_0.5": _ar1(0.5),
        "ar1_0.8": _ar1(0.8),
        "walk_bursts": walk_bursts,
        "free_bursts": free_bursts,
        "uneven_bursts": uneven_bursts,
        "near_line2": near_line2,
        "clumps": clumps,
    }
)
"""Kinds that no method here was tuned on."""
