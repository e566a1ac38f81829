"""Uniform sampling: every subset of s points is equally likely (Fischler & Bolles 1981; METHODS.md 4.1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.randomness import draw_distinct
from estimators.consensus.stopping import clean_probability_compiled, log_miss_per_draw_compiled
from estimators.kernels import device

UNIFORM = 0
"""Code of this sampler in compiled code."""


@device
def draw_uniform(key: Any, n: int, sample: IntArray) -> None:
    """Distinct points, uniformly."""
    draw_distinct(key, n, sample.size, sample)


@device
def uniform_log_miss(inlier: BoolArray, s: int) -> float:
    """ln(1 - p_e) of one draw, with p_e exact (METHODS.md 2.2)."""
    count = 0
    for i in range(inlier.size):
        count += 1 if inlier[i] else 0
    return log_miss_per_draw_compiled(clean_probability_compiled(count, inlier.size, s))


@dataclass(frozen=True, slots=True)
class Uniform:
    """Sampler of classic RANSAC."""

    code: ClassVar[int] = UNIFORM

    def rank(self, quality: FloatArray | None, n: int, seed: int) -> IntArray:
        """No order is needed."""
        del quality, n, seed
        return np.empty(0, dtype=np.int64)
