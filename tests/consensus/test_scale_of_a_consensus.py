"""Noise scale of inliers that a threshold has cut."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import truncnorm

from estimators.consensus.labelling.scale import sigma_of_consensus, truncated_variance


@given(c=st.floats(0.1, 20.0))
def test_the_variance_of_the_cut_normal_law_is_the_textbook_one(c: float) -> None:
    assert truncated_variance(c) == pytest.approx(truncnorm.var(-c, c), rel=1e-6)


@given(c=st.floats(1.01, 38.0), sigma=st.floats(1e-12, 1e12))
def test_the_scale_before_the_cut_is_recovered_from_the_scatter_after_it(c: float, sigma: float) -> None:
    scatter = sigma * math.sqrt(truncated_variance(c))
    assert sigma_of_consensus(scatter, c * sigma) == pytest.approx(sigma, rel=1e-9)


def test_no_scatter_is_no_scale() -> None:
    assert sigma_of_consensus(0.0, 1.0) == 0.0


@given(scatter=st.floats(0.55, 1.0))
def test_residuals_that_fill_the_threshold_say_no_more_than_that_it_is_too_small(scatter: float) -> None:
    assert sigma_of_consensus(scatter, 1.0) == 1.0


def test_a_threshold_that_cuts_nothing_leaves_the_scatter() -> None:
    assert sigma_of_consensus(1e-9, 1.0) == pytest.approx(1e-9)
