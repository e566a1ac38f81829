"""A sampler bound to data: which sample hypothesis h gets, and what the draws so far are worth.

Here, and only here, the codes of the samplers are told apart. The compiled path calls the device functions;
the readable engine calls :class:`Draws`, whose kernels are the same functions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.randomness import SAMPLES, as_counter, random_key
from estimators.consensus.samplers.enumeration import ENUMERATION, next_subset, nth_subset, subsets_within
from estimators.consensus.samplers.far_apart import (
    FAR_APART,
    draw_far_apart,
    far_draws_needed,
    far_log_misses,
    mixed_log_miss,
)
from estimators.consensus.samplers.prosac import (
    PROSAC,
    draw_prosac,
    fill_prosac_tables,
    growth_length,
    prosac_draws_needed,
    prosac_log_miss,
)
from estimators.consensus.samplers.uniform import draw_uniform, uniform_log_miss
from estimators.consensus.stopping import draws_needed_compiled
from estimators.kernels import device, kernel, ro

# Only what comes from outside is read-only: with the types of the compiled path, compiled code is shared.
_TIMES, _ORDER = ro(types.float64), ro(types.int64)
_TABLE, _LABELS = types.int64[::1], types.boolean[::1]
_INT, _REAL = types.int64, types.float64


@device
def draw_block(
    code: int,
    seed: int,
    first: int,
    count: int,
    t: FloatArray,
    order: IntArray,
    growth: IntArray,
    samples: IntArray,
) -> None:
    """Fill ``samples[:count]`` with the samples of hypotheses ``first .. first + count - 1``."""
    s = samples.shape[1]
    if code == ENUMERATION:
        nth_subset(first, s, samples[0])
        for k in range(1, count):
            for j in range(s):
                samples[k, j] = samples[k - 1, j]
            next_subset(samples[k])
        return
    for k in range(count):
        h = first + k
        key = random_key(seed, SAMPLES, h)
        if code == FAR_APART:
            draw_far_apart(key, h, t, samples[k])
        elif code == PROSAC:
            draw_prosac(key, h, order, growth, samples[k])
        else:
            draw_uniform(key, t.size, samples[k])


@device
def log_miss(
    code: int, t: FloatArray, order: IntArray, growth: IntArray, inlier: BoolArray, s: int, drawn: int
) -> float:
    """Logarithm of the chance that none of the first ``drawn`` samples is clean, exact for every sampler."""
    if drawn == 0:
        return 0.0
    if code == ENUMERATION:
        return -np.inf
    if code == FAR_APART:
        far, uniform = far_log_misses(t, inlier, s)
        return mixed_log_miss(far, uniform, drawn)
    if code == PROSAC:
        return prosac_log_miss(inlier, s, order, growth, drawn)
    return drawn * uniform_log_miss(inlier, s)


@device
def draws_needed_for(
    code: int,
    t: FloatArray,
    order: IntArray,
    growth: IntArray,
    minima: IntArray,
    inlier: BoolArray,
    s: int,
    confidence: float,
) -> int:
    """Draws that reach the confidence if the inliers are those flagged."""
    if code == FAR_APART:
        far, uniform = far_log_misses(t, inlier, s)
        return far_draws_needed(far, uniform, confidence)
    if code == PROSAC:
        return prosac_draws_needed(inlier, s, order, growth, minima, confidence)
    return draws_needed_compiled(uniform_log_miss(inlier, s), confidence)


@kernel(types.void(_INT, _INT, _INT, _TIMES, _ORDER, _TABLE, types.int64[:, ::1]))
def fill_samples(
    code: int, seed: int, first: int, t: FloatArray, order: IntArray, growth: IntArray, samples: IntArray
) -> None:
    """Entry to :func:`draw_block` for a whole array of samples."""
    draw_block(code, seed, first, samples.shape[0], t, order, growth, samples)


@kernel(_REAL(_INT, _TIMES, _ORDER, _TABLE, _LABELS, _INT, _INT))
def find_log_miss(
    code: int, t: FloatArray, order: IntArray, growth: IntArray, inlier: BoolArray, s: int, drawn: int
) -> float:
    """Entry to :func:`log_miss`."""
    return log_miss(code, t, order, growth, inlier, s, drawn)


@kernel(_INT(_INT, _TIMES, _ORDER, _TABLE, _TABLE, _LABELS, _INT, _REAL))
def find_draws_needed(
    code: int,
    t: FloatArray,
    order: IntArray,
    growth: IntArray,
    minima: IntArray,
    inlier: BoolArray,
    s: int,
    confidence: float,
) -> int:
    """Entry to :func:`draws_needed_for`."""
    return draws_needed_for(code, t, order, growth, minima, inlier, s, confidence)


@kernel(types.void(_INT, _INT, _TABLE, _TABLE))
def fill_tables(n: int, s: int, growth: IntArray, minima: IntArray) -> None:
    """Entry to :func:`fill_prosac_tables`."""
    fill_prosac_tables(n, s, growth, minima)


@kernel(_INT(_INT, _INT, _INT))
def count_subsets_within(n: int, s: int, budget: int) -> int:
    """Entry to :func:`subsets_within`."""
    return subsets_within(n, s, budget)


@dataclass(frozen=True, slots=True)
class Draws:
    """The samples of one search.

    Attributes
    ----------
    code : int
        Of the sampler.
    total : int or None
        Number of samples there are, where they are enumerated.
    s : int
    seed : int
        As :func:`as_counter` returns it.
    t : ndarray of float64, shape (n,)
        Positions of the points, ascending.
    order, growth, minima : ndarray of int64
        Tables of PROSAC; empty for other samplers.
    """

    code: int
    total: int | None
    s: int
    seed: int
    t: FloatArray
    order: IntArray
    growth: IntArray
    minima: IntArray

    def block(self, first: int, count: int) -> IntArray:
        """Return the samples of hypotheses ``first .. first + count - 1``, shape (count, s), ascending."""
        samples = np.empty((count, self.s), dtype=np.int64)
        fill_samples(self.code, self.seed, first, self.t, self.order, self.growth, samples)
        return samples

    def log_miss(self, inlier: BoolArray, drawn: int) -> float:
        """Logarithm of the chance that none of the first ``drawn`` samples was clean."""
        return find_log_miss(self.code, self.t, self.order, self.growth, inlier, self.s, drawn)

    def needed(self, inlier: BoolArray, confidence: float) -> int:
        """Draws that reach the confidence if the inliers are those flagged."""
        return find_draws_needed(
            self.code, self.t, self.order, self.growth, self.minima, inlier, self.s, confidence
        )


def bind_sampler(
    code: int, t: FloatArray, s: int, order: IntArray, seed: int, limit: int, budget: int
) -> Draws:
    """Draws of a sampler over ``t.size`` points, or their enumeration where it fits the work budget.

    Parameters
    ----------
    code : int
    t : ndarray of float64, shape (n,)
    s : int
    order : ndarray of int64
        As the sampler's ``rank`` gives it.
    seed : int
    limit : int
        Most draws.
    budget : int
        Residual evaluations that an enumeration may cost; 0 always samples.
    """
    n = t.size
    total = count_subsets_within(n, s, budget)
    growth = minima = np.empty(0, dtype=np.int64)
    if total:
        code = ENUMERATION
    elif code == PROSAC:
        growth = np.zeros(growth_length(n, s, limit) + 1, dtype=np.int64)
        minima = np.zeros(n + 1, dtype=np.int64)
        fill_tables(n, s, growth, minima)
    return Draws(code, total or None, s, as_counter(seed), t, order, growth, minima)
