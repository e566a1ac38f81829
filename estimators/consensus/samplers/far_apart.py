"""Far-apart sampling for a single trend: the points of a sample are far from one another in time.

The slope through two points has standard error sigma * sqrt(2) / |dt|, so that only 2 % of the clean pairs
with |dt| below 0.05 of the range are useful, against 84 % of those beyond 0.5 (METHODS.md 2.2, 4.3). A pair
is drawn uniformly in its first point and uniformly among the points at least 0.3 of the range away from it
in its second; a larger sample takes one point from each of s equal stretches of the series.

One draw in four is uniform, because far pairs alone can be hostage to a few points: where all but two
readings sit in one clump, every far pair contains one of the two. All probabilities stay exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.randomness import draw_distinct, index_below, random_bits
from estimators.consensus.samplers.uniform import uniform_log_miss
from estimators.consensus.stopping import UNBOUNDED, draws_needed_compiled, log_miss_per_draw_compiled
from estimators.kernels import device

FAR_APART = 1
"""Code of this sampler in compiled code."""

REACH = 0.3
"""Least distance of a far pair, as a share of the time range; any share below one half leaves every point a
partner, since one of the two ends is at least half the range away (METHODS_TRENDS: |dt| >= .3)."""

UNIFORM_EVERY = 4
"""Every fourth draw is uniform."""


@device
def far_reach(t: FloatArray, s: int) -> float:
    """Least distance of a far pair; 0 where far-apart sampling has nothing to work with."""
    if s < 2 or t.size < 2:
        return 0.0
    span: float = t[t.size - 1] - t[0]
    return REACH * span


@device
def _count_until(t: FloatArray, limit: float) -> int:
    """Count the times not after ``limit``."""
    low, high = 0, t.size
    while low < high:
        middle = (low + high) // 2
        if t[middle] <= limit:
            low = middle + 1
        else:
            high = middle
    return low


@device
def _count_before(t: FloatArray, limit: float) -> int:
    """Count the times before ``limit``."""
    low, high = 0, t.size
    while low < high:
        middle = (low + high) // 2
        if t[middle] < limit:
            low = middle + 1
        else:
            high = middle
    return low


@device
def draw_far_apart(key: Any, h: int, t: FloatArray, sample: IntArray) -> None:
    """One sample, ascending; see the module."""
    n, s = t.size, sample.size
    reach = far_reach(t, s)
    if reach <= 0.0 or h % UNIFORM_EVERY == UNIFORM_EVERY - 1:
        draw_distinct(key, n, s, sample)
    elif s == 2:
        i = index_below(random_bits(key, 0), n)
        early = _count_until(t, t[i] - reach)
        late = _count_before(t, t[i] + reach)
        j = index_below(random_bits(key, 1), early + n - late)
        if j >= early:
            j += late - early
        sample[0] = min(i, j)
        sample[1] = max(i, j)
    else:
        for k in range(s):
            low = k * n // s
            sample[k] = low + index_below(random_bits(key, k), (k + 1) * n // s - low)


@device
def _far_clean_probability(t: FloatArray, inlier: BoolArray, s: int, reach: float) -> float:
    """Exact chance that a far draw holds inliers only."""
    n = t.size
    probability = 1.0
    if s > 2:
        for k in range(s):
            low, high = k * n // s, (k + 1) * n // s
            count = 0
            for i in range(low, high):
                count += 1 if inlier[i] else 0
            probability *= count / (high - low)
        return probability
    total = 0
    for i in range(n):
        total += 1 if inlier[i] else 0
    # Both borders of the far set move forward with i, so one walk serves all points.
    early = late = early_inliers = inliers_before_late = 0
    summed = 0.0
    for i in range(n):
        while early < n and t[early] <= t[i] - reach:
            early_inliers += 1 if inlier[early] else 0
            early += 1
        while late < n and t[late] < t[i] + reach:
            inliers_before_late += 1 if inlier[late] else 0
            late += 1
        if inlier[i]:
            summed += (early_inliers + total - inliers_before_late) / (early + n - late)
    return min(summed / n, 1.0)


@device
def far_log_misses(t: FloatArray, inlier: BoolArray, s: int) -> tuple[float, float]:
    """ln(1 - p) of a far draw and of a uniform one."""
    uniform = uniform_log_miss(inlier, s)
    reach = far_reach(t, s)
    if reach <= 0.0:
        return uniform, uniform
    return log_miss_per_draw_compiled(_far_clean_probability(t, inlier, s, reach)), uniform


@device
def mixed_log_miss(far: float, uniform: float, drawn: int) -> float:
    """Logarithm of the chance that none of the first ``drawn`` draws is clean."""
    uniform_draws = drawn // UNIFORM_EVERY
    far_draws = drawn - uniform_draws
    total = 0.0
    if far_draws > 0:
        total += far_draws * far
    if uniform_draws > 0:
        total += uniform_draws * uniform
    return total


@device
def far_draws_needed(far: float, uniform: float, confidence: float) -> int:
    """Smallest number of draws whose chance to miss is at most 1 - P."""
    if far == -math.inf:
        return 1
    if uniform == -math.inf:
        return UNIFORM_EVERY
    per_draw = ((UNIFORM_EVERY - 1) * far + uniform) / UNIFORM_EVERY
    needed = draws_needed_compiled(per_draw, confidence)
    if needed == UNBOUNDED:
        return needed
    needed = max(1, needed - UNIFORM_EVERY)
    while mixed_log_miss(far, uniform, needed) > math.log1p(-confidence):
        needed += 1
    return needed


@dataclass(frozen=True, slots=True)
class FarApart:
    """Sampler for one trend over ordered points."""

    code: ClassVar[int] = FAR_APART

    def rank(self, quality: FloatArray | None, n: int, seed: int) -> IntArray:
        """No order but that of time is needed."""
        del quality, n, seed
        return np.empty(0, dtype=np.int64)
