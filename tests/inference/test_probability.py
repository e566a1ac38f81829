"""Probability that a point follows the model, from its residual alone."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from estimators.inference.probability import inlier_probability

RESIDUALS = hnp.arrays(np.float64, st.integers(1, 60), elements=st.floats(-1e6, 1e6))


@settings(max_examples=200, deadline=None)
@given(residual=RESIDUALS, sigma=st.floats(1e-6, 1e3))
def test_probabilities_lie_between_0_and_1_and_fall_with_the_residual(
    residual: np.ndarray, sigma: float
) -> None:
    z = inlier_probability(residual, None, sigma)
    assert ((z >= 0.0) & (z <= 1.0)).all()
    assert (np.diff(z[np.argsort(np.abs(residual))]) <= 1e-12).all()


@settings(max_examples=100, deadline=None)
@given(residual=RESIDUALS, scale=st.sampled_from([2.0**-30, 0.5, 2.0**40]))
def test_the_unit_of_the_residuals_is_arbitrary(residual: np.ndarray, scale: float) -> None:
    np.testing.assert_allclose(
        inlier_probability(scale * residual, None, scale), inlier_probability(residual, None, 1.0), rtol=1e-9
    )


def test_weights_whiten_the_residuals() -> None:
    rng = np.random.default_rng(0)
    residual, root = rng.normal(size=50), rng.uniform(0.5, 2.0, 50)
    np.testing.assert_array_equal(
        inlier_probability(residual, root, 1.0), inlier_probability(residual * root, None, 1.0)
    )


def test_stated_probabilities_are_the_shares_that_come_true() -> None:
    rng = np.random.default_rng(1)
    truth = rng.random(20_000) < 0.6
    residual = np.where(truth, rng.normal(size=20_000), rng.uniform(-15.0, 15.0, 20_000))
    z = inlier_probability(residual, None, 1.0)
    for low in (0.2, 0.4, 0.6, 0.8):
        bin_ = (z >= low) & (z < low + 0.2)
        assert truth[bin_].mean() == pytest.approx(z[bin_].mean(), abs=0.06)
    assert z.mean() == pytest.approx(0.6, abs=0.02)


def test_a_residual_beyond_all_floats_of_the_normal_law_has_probability_0() -> None:
    assert inlier_probability(np.array([0.1, -0.2, 1e9]), None, 1.0)[2] == 0.0
