"""By how much fixes are off that lie: families of offsets of single fixes and of bursts, metres.

Several families on purpose: a cleaner that fits one of them would look better than it is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from benchmarks.tracks.noises import correlated
from estimators.arrays import FloatArray

Offset: TypeAlias = Callable[[FloatArray, np.random.Generator], FloatArray]
"""From the ages in seconds of the fixes of one burst, or of single fixes, to their offsets, shape (n, 2)."""


def _vectors(n: int, low_m: float, high_m: float, rng: np.random.Generator) -> FloatArray:
    """Any direction, length uniform in its logarithm."""
    angle = rng.uniform(-np.pi, np.pi, n)
    length = np.exp(rng.uniform(np.log(low_m), np.log(high_m), n))
    return np.stack([length * np.sin(angle), length * np.cos(angle)], axis=1)


def scattered(low_m: float, high_m: float) -> Offset:
    """Each fix for itself, length uniform in its logarithm."""
    return lambda age, rng: _vectors(age.size, low_m, high_m, rng)


def clumped(spread_m: float) -> Offset:
    """Each fix for itself, normal, and outside the noise by a tenth of the spread at least."""

    def draw(age: FloatArray, rng: np.random.Generator) -> FloatArray:
        vector = spread_m * rng.normal(size=(age.size, 2))
        length = np.hypot(vector[:, 0], vector[:, 1])
        return np.asarray(vector * np.maximum(1.0, 0.1 * spread_m / length)[:, None])

    return draw


def constant(low_m: float, high_m: float) -> Offset:
    """One vector for the whole burst: one strong reflection."""
    return lambda age, rng: np.repeat(_vectors(1, low_m, high_m, rng), age.size, axis=0)


def ramp(low_m: float, high_m: float) -> Offset:
    """Growing from nothing to the whole: a receiver that is drawn away."""

    def draw(age: FloatArray, rng: np.random.Generator) -> FloatArray:
        share = (np.arange(age.size) + 1.0) / age.size
        return np.asarray(share[:, None] * _vectors(1, low_m, high_m, rng))

    return draw


def random_walk(low_m: float, high_m: float, step_m: float) -> Offset:
    """Offset by a vector that walks, by so much in the root of a second."""

    def draw(age: FloatArray, rng: np.random.Generator) -> FloatArray:
        passed = np.diff(age, prepend=age[:1])
        steps = step_m * np.sqrt(passed)[:, None] * rng.normal(size=(age.size, 2))
        return np.asarray(_vectors(1, low_m, high_m, rng) + np.cumsum(steps, axis=0))

    return draw


def wandering(low_m: float, high_m: float, share: float, time_s: float) -> Offset:
    """Offset by a vector and an Ornstein-Uhlenbeck process about it, of a share of its length."""

    def draw(age: FloatArray, rng: np.random.Generator) -> FloatArray:
        vector = _vectors(1, low_m, high_m, rng)
        spread = share * float(np.hypot(*vector[0]))
        return np.asarray(vector + correlated(age, spread, time_s, rng))

    return draw


def returning(low_m: float, high_m: float, time_s: float) -> Offset:
    """Off at once, and back exponentially: a filter inside the receiver that recovers."""

    def draw(age: FloatArray, rng: np.random.Generator) -> FloatArray:
        return np.asarray(np.exp(-age / time_s)[:, None] * _vectors(1, low_m, high_m, rng))

    return draw
