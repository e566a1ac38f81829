"""PROSAC: sample from the best points first and widen the choice step by step.

Chum & Matas 2005; METHODS.md 4.2.

Points are ranked by quality (here: the caller's weights), best first. The t-th draw uses the n = g(t) best
points: the n-th itself and s - 1 from those above it. With T_N = min(200 000, C(N, s)) the growth does not
stall on small samples: for T_N = C(N, s) it is a progressive enumeration. When the growth is exhausted, draws
are uniform over all points.

The sampler has no state: draw t is the same whatever happened before. Termination lengths are looked for
among the prefixes that the growth has passed, and never narrow later draws, so that the reported sampling
probability stays an exact product over the draws made.

Points of equal quality are ordered by a seeded permutation. The order of the rows, which is that of time,
would make the first samples neighbours in time, the worst there are for a trend.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.randomness import TIES, as_counter, draw_distinct, random_block
from estimators.consensus.stopping import (
    UNBOUNDED,
    clean_probability_compiled,
    draws_needed_compiled,
    fill_nonrandom_minima,
    log_miss_per_draw_compiled,
)
from estimators.kernels import device

PROSAC = 2
"""Code of this sampler in compiled code."""

LONGEST_GROWTH = 200_000.0
"""Draws after which PROSAC is RANSAC: T_N of the authors."""

OUTLIER_SUPPORT = 0.05
"""beta: chance that an outlier fits a wrong model (USAC)."""

NONRANDOM_RISK = 0.05
"""psi: accepted chance that the consensus is random (USAC: confidence 0.95)."""

SHORTEST_STOP = 20
"""Shortest termination length (USAC)."""


@device
def growth_length(n: int, s: int, limit: int) -> int:
    """Points that ``limit`` draws can reach: each draw length adds at least one draw."""
    return min(n, s + limit)


@device
def fill_growth(n: int, s: int, longest: int, growth: IntArray) -> None:
    """Fill ``growth[m]`` = T'_m for m = s .. longest: the draws made before point m + 1 comes in.

    T_{m+1} = T_m (m + 1) / (m + 1 - s), T'_{m+1} = T'_m + ceil(T_{m+1} - T_m), T'_s = 1.
    """
    subsets = 1.0
    for i in range(s):
        subsets = subsets * (n - i) / (i + 1)
    average = min(LONGEST_GROWTH, subsets) / subsets
    growth[s] = 1
    for m in range(s, longest):
        grown = average * (m + 1) / (m + 1 - s)
        step = grown - average
        # Where T is a whole number by construction, rounding must not add a draw.
        growth[m + 1] = growth[m] + max(1, math.ceil(step - 1e-9 * max(1.0, step)))
        average = grown


@device
def draw_length(t: int, s: int, growth: IntArray) -> int:
    """g(t): the shortest m with T'_m >= t (t counts from 1), or -1 where the growth is exhausted."""
    low, high = s, growth.size
    while low < high:
        middle = (low + high) // 2
        if growth[middle] >= t:
            high = middle
        else:
            low = middle + 1
    return low if low < growth.size else -1


@device
def draw_prosac(key: Any, h: int, order: IntArray, growth: IntArray, sample: IntArray) -> None:
    """One sample, ascending; ``order`` ranks the points, best first."""
    s = sample.size
    length = draw_length(h + 1, s, growth)
    if length < 0:
        draw_distinct(key, order.size, s, sample)
        return
    draw_distinct(key, length - 1, s - 1, sample)
    sample[s - 1] = length - 1
    for k in range(s):
        point = order[sample[k]]
        place = k
        while place > 0 and sample[place - 1] > point:
            sample[place] = sample[place - 1]
            place -= 1
        sample[place] = point


@device
def prosac_log_miss(inlier: BoolArray, s: int, order: IntArray, growth: IntArray, drawn: int) -> float:
    """Logarithm of the chance that none of the first ``drawn`` draws is clean, draw length by draw length."""
    total, inliers, made = 0.0, 0, 0
    for place in range(order.size):
        length = place + 1
        if length >= s and length < growth.size and made < drawn:
            draws = min(growth[length], drawn) - made
            if inlier[order[place]]:
                clean = clean_probability_compiled(inliers, length - 1, s - 1) if s > 1 else 1.0
                total += draws * log_miss_per_draw_compiled(clean)
            made += draws
        inliers += 1 if inlier[order[place]] else 0
    if made < drawn:
        clean = clean_probability_compiled(inliers, order.size, s)
        total += (drawn - made) * log_miss_per_draw_compiled(clean)
    return total


@device
def prosac_draws_needed(
    inlier: BoolArray, s: int, order: IntArray, growth: IntArray, minima: IntArray, confidence: float
) -> int:
    """Draws after which some termination length satisfies non-randomness and maximality.

    A length m qualifies when its I_m inliers are not random and when the draws from the m best points, T'_m
    of them (unlimited for m = N), suffice for I_m at the wanted confidence.
    """
    n = order.size
    needed, inliers = UNBOUNDED, 0
    for place in range(n):
        inliers += 1 if inlier[order[place]] else 0
        length = place + 1
        if length < min(SHORTEST_STOP, n) or inliers < max(s, minima[length]):
            continue
        log_miss = log_miss_per_draw_compiled(clean_probability_compiled(inliers, length, s))
        draws = draws_needed_compiled(log_miss, confidence)
        if length == n or length >= growth.size or draws <= growth[length]:
            needed = min(needed, draws)
    return needed


@device
def fill_prosac_tables(n: int, s: int, growth: IntArray, minima: IntArray) -> None:
    """Growth and non-randomness tables of a series."""
    fill_growth(n, s, growth.size - 1, growth)
    fill_nonrandom_minima(n, s, OUTLIER_SUPPORT, NONRANDOM_RISK, minima)


@dataclass(frozen=True, slots=True)
class Prosac:
    """Sampler that follows the quality of the points."""

    code: ClassVar[int] = PROSAC

    def rank(self, quality: FloatArray | None, n: int, seed: int) -> IntArray:
        """Points from best to worst; equal quality is ordered by a seeded permutation.

        Parameters
        ----------
        quality : ndarray of float64, shape (n,), or None
            Higher is better; None ranks all points equal.
        n : int
        seed : int

        Returns
        -------
        ndarray of int64, shape (n,)

        Examples
        --------
        >>> Prosac().rank(np.array([0.2, 3.0, 1.0]), 3, 0)
        array([1, 2, 0])
        """
        ties = random_block(as_counter(seed), TIES, 0, n, 1)[:, 0]
        if quality is None:
            return np.argsort(ties, kind="stable").astype(np.int64)
        return np.lexsort((ties, -quality)).astype(np.int64)
