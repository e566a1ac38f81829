"""When fixes are taken: seconds since the beginning, ascending."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from estimators.arrays import FloatArray

Sampling: TypeAlias = Callable[[float, np.random.Generator], FloatArray]


def every(step_s: float) -> Sampling:
    """At a fixed rate."""
    return lambda duration, rng: np.arange(0.0, duration, step_s)  # noqa: ARG005  # a sampling may draw


def jittered(step_s: float, share: float) -> Sampling:
    """At a rate that holds only about: each time off by up to a share of half a step."""

    def draw(duration: float, rng: np.random.Generator) -> FloatArray:
        t = np.arange(0.0, duration, step_s)
        return np.clip(t + 0.5 * share * step_s * rng.uniform(-1.0, 1.0, t.size), 0.0, duration)

    return draw


def at_random(mean_s: float, least_s: float) -> Sampling:
    """At intervals of at least ``least_s``, the rest exponential: reports on events."""

    def draw(duration: float, rng: np.random.Generator) -> FloatArray:
        steps = least_s + rng.exponential(mean_s - least_s, int(2.0 * duration / mean_s) + 20)
        t = np.concatenate([[0.0], np.cumsum(steps)])
        return t[t < duration]

    return draw


def with_gaps(step_s: float, gaps: int, shortest_s: float, longest_s: float) -> Sampling:
    """At a fixed rate with silences: tunnels."""

    def draw(duration: float, rng: np.random.Generator) -> FloatArray:
        t = np.arange(0.0, duration, step_s)
        keep = np.ones(t.size, dtype=np.bool_)
        for begin in rng.uniform(0.1 * duration, 0.9 * duration, gaps):
            keep &= ~((t > begin) & (t < begin + rng.uniform(shortest_s, longest_s)))
        return t[keep]

    return draw
