"""Regression quantiles as starts of a search."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.arrays import FloatArray
from estimators.regression.quantiles import quantile_fits


def design(n: int) -> tuple[FloatArray, FloatArray]:
    t = np.linspace(-1.0, 1.0, n)
    return t, np.vstack([np.ones(n), t])


@settings(max_examples=30, deadline=None)
@given(st.floats(0.1, 0.9), st.integers(0, 100))
def test_about_the_share_asked_for_lies_below_the_curve(share: float, seed: int) -> None:
    t, columns = design(200)
    y = 3.0 * t + np.random.default_rng(seed).standard_t(3, 200)
    theta, _ = quantile_fits(columns, y, None, shares=np.array([share]), start=np.zeros(2), floor=1e-12)
    assert np.mean(y < theta[0] @ columns) == pytest.approx(share, abs=0.05)


def test_the_curve_of_the_fitting_quantile_runs_through_the_points_below_one_sided_errors() -> None:
    rng = np.random.default_rng(1)
    t, columns = design(400)
    high = rng.uniform(size=400) < 0.6
    y = 5.0 - 2.0 * t + rng.normal(size=400) + np.where(high, 6.0 + rng.exponential(15.0, 400), 0.0)
    theta, scale = quantile_fits(columns, y, None, shares=np.array([0.2]), start=np.zeros(2), floor=1e-12)
    assert theta[0] == pytest.approx([5.0, -2.0], abs=0.5)
    assert 0.5 < scale[0] < 2.0


def test_points_without_weight_have_no_say() -> None:
    t, columns = design(100)
    y = 1.0 + t
    y[::4] = 90.0
    weights = np.where(np.arange(100) % 4 == 0, 0.0, 4.0 / 3.0)
    theta, _ = quantile_fits(columns, y, weights, shares=np.array([0.7]), start=np.zeros(2), floor=1e-9)
    assert theta[0] == pytest.approx([1.0, 1.0], abs=1e-6)


def test_the_scale_does_not_fall_below_its_floor() -> None:
    t, columns = design(50)
    _, scale = quantile_fits(columns, 2.0 * t, None, shares=np.array([0.5]), start=np.zeros(2), floor=1e-3)
    assert scale[0] == 1e-3
