"""Contaminated linear data in the normalising frame, and what tests compare about a result."""

from __future__ import annotations

import dataclasses

import numpy as np

from estimators.consensus.found import Found, LinearData, Scale
from estimators.consensus.presets import PRESETS
from estimators.consensus.search.sampling import SamplingSearch
from estimators.result import NoFit

SAMPLING: dict[str, SamplingSearch] = {
    name: preset.search for name, preset in PRESETS.items() if isinstance(preset.search, SamplingSearch)
}
"""Every preset that draws samples."""


def contaminated(
    n: int, seed: int, *, p: int = 2, outliers: float = 0.4, sigma: float = 0.01, weighted: bool = False
) -> LinearData:
    """A polynomial of degree p - 1 through irregular times, with uniform outliers."""
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(-1.0, 1.0, n))
    columns = np.array([t**k for k in range(p)])
    weights = rng.uniform(0.2, 1.8, n) if weighted else None
    noise = rng.normal(0.0, sigma, n) / (1.0 if weights is None else np.sqrt(weights))
    y = rng.uniform(-0.5, 0.5, p) @ columns + noise
    wild = rng.uniform(size=n) < outliers
    y[wild] = rng.uniform(-1.0, 1.0, int(wild.sum()))
    return LinearData(columns, y, t, weights)


def given(threshold: float) -> Scale:
    """Scale of a caller who knows the threshold only."""
    return Scale(None, "residuals", threshold, "given", 1e-12)


def found(result: Found | NoFit) -> Found:
    """The result as a model."""
    assert isinstance(result, Found), result
    return result


def differing_fields(a: Found, b: Found) -> list[str]:
    """Names of the fields whose bytes differ."""
    different = []
    for field in dataclasses.fields(Found):
        x, y = getattr(a, field.name), getattr(b, field.name)
        same = x.tobytes() == y.tobytes() if isinstance(x, np.ndarray) else x == y
        if not same:
            different.append(field.name)
    return different
