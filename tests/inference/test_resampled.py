"""Blocks of neighbours, and what replicates say."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import t as student

from estimators.inference.blocks import block_correction, block_length, drawn_blocks, shuffled_blocks
from estimators.inference.resampled import permutation_p, symmetric_quantile, widening

SIZES = st.integers(2, 300)


@given(n=SIZES, length=st.integers(1, 40), replicate=st.integers(0, 10_000))
def test_drawn_blocks_hold_neighbours_of_the_circle(n: int, length: int, replicate: int) -> None:
    rows = drawn_blocks(n, length, 7, replicate)
    assert rows.shape == (n,)
    assert rows.min() >= 0
    assert rows.max() < n
    inside = np.flatnonzero(np.arange(1, n) % length != 0)
    assert ((rows[inside + 1] - rows[inside]) % n == 1 % n).all()


@given(n=SIZES, length=st.integers(1, 40), replicate=st.integers(0, 10_000))
def test_shuffled_blocks_hold_every_row_once(n: int, length: int, replicate: int) -> None:
    rows = shuffled_blocks(n, length, 7, replicate)
    np.testing.assert_array_equal(np.sort(rows), np.arange(n))


def test_a_replicate_is_the_same_whatever_else_is_drawn_and_differs_from_the_others() -> None:
    np.testing.assert_array_equal(drawn_blocks(50, 5, 3, 17), drawn_blocks(50, 5, 3, 17))
    assert (drawn_blocks(50, 5, 3, 17) != drawn_blocks(50, 5, 3, 18)).any()
    assert (shuffled_blocks(50, 5, 3, 17) != shuffled_blocks(50, 5, 4, 17)).any()


def test_every_row_is_drawn_equally_often() -> None:
    drawn = np.concatenate([drawn_blocks(20, 4, 0, k) for k in range(5000)])
    # 5 000 draws of a row on average; blocks make their counts a little less even than single draws.
    np.testing.assert_allclose(np.bincount(drawn), 5000, rtol=0.06)


def test_blocks_grow_with_the_series_and_with_the_correlation() -> None:
    assert block_length(80, 0.0) == round(1.75 * 80 ** (1 / 3))
    assert block_length(80, 0.0) < block_length(1000, 0.0) < block_length(1000, 0.9)
    assert block_length(30, 0.98) == 5  # a sixth of the series at most


def test_residuals_in_blocks_vary_less_than_the_noise_they_came_from() -> None:
    rng = np.random.default_rng(0)
    n, length = 60, 10
    t = np.arange(float(n))
    basis = np.linalg.qr(np.column_stack((np.ones(n), t)))[0]
    noise = rng.normal(size=(4000, n))
    residual = noise - (noise @ basis) @ basis.T
    circle = np.concatenate((residual, residual[:, :length]), axis=1)
    sums = np.cumsum(circle, axis=1)[:, length:] - np.cumsum(circle, axis=1)[:, :n]
    short = np.mean(sums**2) / (length * np.mean(residual**2))
    assert block_correction(n, length, 2) == pytest.approx(1.0 / np.sqrt(short), rel=0.05)


@given(st.lists(st.floats(-50, 50), min_size=1, max_size=400), st.floats(0.5, 0.99))
def test_the_quantile_leaves_at_most_the_rest_above_it(values: list[float], level: float) -> None:
    statistics = np.array(values)
    bound = symmetric_quantile(statistics, level)
    assert bound in np.abs(statistics)
    assert np.mean(np.abs(statistics) > bound) <= max(1.0 - level, 0.0) + 1e-9


def test_replicates_that_follow_student_leave_intervals_as_they_are() -> None:
    statistics = student.rvs(12.0, size=40_000, random_state=1)
    assert widening(statistics, 0.95, 12.0) == pytest.approx(1.0, abs=0.02)


def test_the_observed_series_counts_among_the_permuted_ones() -> None:
    assert permutation_p(10.0, np.zeros(99)) == 0.01
    assert permutation_p(0.0, np.ones(99)) == 1.0
    assert permutation_p(-2.0, np.array([2.0, 1.0, -3.0])) == 0.75
