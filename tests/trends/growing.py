"""Exponential series with known noise and known outliers, for tests of the exponential."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Growing(NamedTuple):
    """Ascending times, values, and which of them are outliers."""

    t: np.ndarray
    y: np.ndarray
    outlier: np.ndarray


def growing(
    noise: str,
    n: int = 120,
    share: float = 0.3,
    seed: int = 0,
    rate: float = 0.03,
    level: float = 2.0,
) -> Growing:
    """``level * exp(rate * t)`` at uneven times from 0 to 100; sigma 0.5 of values or 0.1 of logarithms.

    Outliers lie 4 to 40 away, or are too large or too small by a factor of 3 to 20.
    """
    rng = np.random.default_rng(seed)
    t = np.concatenate(([0.0], np.sort(rng.uniform(0.0, 100.0, n - 2)), [100.0]))
    curve = level * np.exp(rate * t)
    outlier = rng.permutation(n) < round(share * n)
    off = rng.choice([-1.0, 1.0], n)
    if noise == "additive":
        far = off * rng.uniform(4.0, 40.0, n)
        return Growing(t, curve + np.where(outlier, far, 0.5 * rng.normal(size=n)), outlier)
    far = off * np.log(rng.uniform(3.0, 20.0, n))
    return Growing(t, curve * np.exp(np.where(outlier, far, 0.1 * rng.normal(size=n))), outlier)
