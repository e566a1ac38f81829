"""The periodogram at any times."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.arrays import FloatArray
from estimators.regression.periodogram import periodogram


def explained(t: FloatArray, y: FloatArray, w: FloatArray, frequency: float) -> float:
    """Share of the weighted variation about the mean that least squares of the sinusoid explains."""
    root = np.sqrt(w)
    angle = 2 * np.pi * frequency * t
    design = np.vstack([np.ones(t.size), np.cos(angle), np.sin(angle)])
    rest = y - np.linalg.lstsq((design * root).T, y * root, rcond=None)[0] @ design
    about = y - np.sum(w * y) / np.sum(w)
    return float(1.0 - np.sum(w * rest**2) / np.sum(w * about**2))


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 1000), n=st.integers(10, 60))
def test_it_is_the_share_that_least_squares_explains(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    t, y, w = np.sort(rng.uniform(0.0, 50.0, n)), rng.normal(size=n), rng.uniform(0.1, 2.0, n)
    power = periodogram(t, y, w, 0.03, 0.011, 30)
    expected = [explained(t, y, w, 0.03 + 0.011 * k) for k in range(30)]
    assert power == pytest.approx(expected, abs=1e-8)


def test_rotated_phases_do_not_drift_over_many_frequencies() -> None:
    rng = np.random.default_rng(0)
    t, y = np.sort(rng.uniform(0.0, 1000.0, 80)), rng.normal(size=80)
    power = periodogram(t, y, np.ones(80), 0.002, 0.0002, 3000)
    for k in (511, 512, 1700, 2999):
        assert power[k] == pytest.approx(explained(t, y, np.ones(80), 0.002 + 0.0002 * k), abs=1e-9)


def test_a_frequency_that_the_times_do_not_resolve_has_no_power() -> None:
    t = np.arange(20.0)
    assert periodogram(t, np.sin(t), np.ones(20), 1.0, 0.1, 1)[0] == 0.0


def test_values_without_variation_have_no_power() -> None:
    assert periodogram(np.arange(20.0), np.full(20, 3.0), np.ones(20), 0.05, 0.01, 9).max() == 0.0
