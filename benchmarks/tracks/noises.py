"""Errors of fixes that do not lie: independent, with tails, lasting for a while, or of a known spread.

A noise is a function of times and a generator that gives a :class:`Noise`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from estimators.arrays import FloatArray

RADIUS_68 = 1.515
"""Radius of 68 % of a circular normal distribution in sigmas per axis, rounded as in DESIGN section 8."""


@dataclass(frozen=True, slots=True)
class Noise:
    """Errors and what they are drawn from.

    Attributes
    ----------
    error_m : ndarray, shape (n, 2)
    sigma_m : ndarray, shape (n,)
        Of a fix, per axis, without its tails.
    accuracy_m : ndarray, shape (n,), or None
        Radius that holds 68 %, if the receiver reports it.
    """

    error_m: FloatArray
    sigma_m: FloatArray
    accuracy_m: FloatArray | None = None


NoiseLaw: TypeAlias = Callable[[FloatArray, np.random.Generator], Noise]


def normal(sigma_m: float) -> NoiseLaw:
    """White and normal."""

    def draw(t_s: FloatArray, rng: np.random.Generator) -> Noise:
        return Noise(sigma_m * rng.normal(size=(t_s.size, 2)), np.full(t_s.size, sigma_m))

    return draw


def student(sigma_m: float, freedom: float) -> NoiseLaw:
    """White, Student's t of both axes together: a bad fix is bad both ways."""

    def draw(t_s: FloatArray, rng: np.random.Generator) -> Noise:
        stretch = np.sqrt(freedom / rng.chisquare(freedom, size=(t_s.size, 1)))
        return Noise(sigma_m * stretch * rng.normal(size=(t_s.size, 2)), np.full(t_s.size, sigma_m))

    return draw


def laplace(sigma_m: float) -> NoiseLaw:
    """White, each axis of Laplace's law with this standard deviation."""

    def draw(t_s: FloatArray, rng: np.random.Generator) -> Noise:
        error = rng.laplace(scale=sigma_m / np.sqrt(2.0), size=(t_s.size, 2))
        return Noise(error, np.full(t_s.size, sigma_m))

    return draw


def coloured(white_m: float, coloured_m: float, time_s: float) -> NoiseLaw:
    """White noise and an Ornstein-Uhlenbeck process of this correlation time."""

    def draw(t_s: FloatArray, rng: np.random.Generator) -> Noise:
        lasting = correlated(t_s, coloured_m, time_s, rng)
        total = float(np.hypot(white_m, coloured_m))
        return Noise(lasting + white_m * rng.normal(size=(t_s.size, 2)), np.full(t_s.size, total))

    return draw


def reported(smallest_m: float, largest_m: float) -> NoiseLaw:
    """White and normal with a spread that wanders between bounds, and that the receiver reports."""

    def draw(t_s: FloatArray, rng: np.random.Generator) -> Noise:
        wandering = correlated(t_s, 1.0, 45.0, rng)[:, 0]
        share = 0.5 * (1.0 + np.tanh(1.2 * wandering))
        sigma = smallest_m * (largest_m / smallest_m) ** share
        accuracy = np.round(RADIUS_68 * sigma, 1)
        return Noise(sigma[:, None] * rng.normal(size=(t_s.size, 2)), sigma, accuracy)

    return draw


def correlated(t_s: FloatArray, spread: float, time_s: float, rng: np.random.Generator) -> FloatArray:
    """Ornstein-Uhlenbeck process at ascending times, exactly, shape (n, 2)."""
    drawn = spread * rng.normal(size=(t_s.size, 2))
    keep = np.exp(-np.diff(t_s) / time_s)
    fresh = np.sqrt(1.0 - keep**2)
    for k in range(1, t_s.size):
        drawn[k] = keep[k - 1] * drawn[k - 1] + fresh[k - 1] * drawn[k]
    return drawn
