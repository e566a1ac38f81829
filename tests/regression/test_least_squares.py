"""Weighted least squares."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.regression.least_squares import MAX_COLUMNS, least_squares


def line_columns(t: np.ndarray) -> np.ndarray:
    return np.vstack([np.ones_like(t), t])


@given(st.integers(1, MAX_COLUMNS), st.integers(0, 50), st.integers(0, 10_000), st.booleans())
@settings(deadline=None)
def test_the_fit_is_the_one_of_an_orthogonal_factorisation(
    p: int, extra: int, seed: int, weighted: bool
) -> None:
    rng = np.random.default_rng(seed)
    n = p + extra
    columns = np.vstack([np.ones(n), rng.uniform(-1, 1, (p - 1, n))])
    y = rng.normal(size=n)
    weights = rng.uniform(0.2, 3.0, n) if weighted else None
    theta, residual, rank = least_squares(columns, y, weights)
    root = np.ones(n) if weights is None else np.sqrt(weights)
    expected, _, expected_rank, singular = np.linalg.lstsq((columns * root).T, y * root)
    condition = singular[0] / singular[-1]
    assert rank == expected_rank == p
    assert theta == pytest.approx(expected, rel=1e-12 * condition**2, abs=1e-13 * condition**2)
    assert residual == pytest.approx(y - theta @ columns, abs=1e-13 * (1 + np.abs(theta).sum()))


def test_points_in_a_millionth_of_the_range_keep_nine_digits_of_their_slope() -> None:
    t = 0.9 + 1e-6 * np.linspace(0.0, 1.0, 101)
    theta, _, rank = least_squares(line_columns(t), 5.0 + 1000.0 * (t - 0.9))
    assert rank == 2
    assert theta[1] == pytest.approx(1000.0, rel=1e-7)
    assert theta[0] + theta[1] * 0.9 == pytest.approx(5.0, rel=1e-12)


def test_two_points_are_fitted_exactly() -> None:
    theta, residual, _ = least_squares(line_columns(np.array([-1.0, 1.0])), np.array([1.0, 5.0]))
    assert theta.tolist() == [3.0, 2.0]
    assert residual.tolist() == [0.0, 0.0]


def test_a_slope_that_equal_times_do_not_determine_is_zero() -> None:
    theta, _, rank = least_squares(line_columns(np.full(4, 0.7)), np.array([1.0, 2.0, 3.0, 4.0]))
    assert rank == 1
    assert theta.tolist() == [2.5, 0.0]


def test_a_repeated_column_lowers_the_rank_and_not_the_fit() -> None:
    t = np.linspace(-1, 1, 9)
    theta, residual, rank = least_squares(np.vstack([np.ones(9), t, t]), 1.0 + 3.0 * t)
    assert rank == 2
    assert np.abs(residual).max() < 1e-14
    assert theta[1] + theta[2] == pytest.approx(3.0)


def test_a_point_of_weight_two_counts_like_two_points() -> None:
    t, y = np.array([-1.0, 0.0, 0.5, 1.0]), np.array([1.0, 0.0, 2.0, 2.0])
    once, _, _ = least_squares(line_columns(t), y, np.array([1.0, 1.0, 2.0, 1.0]))
    twice, _, _ = least_squares(line_columns(np.sort(np.append(t, 0.5))), np.array([1.0, 0.0, 2.0, 2.0, 2.0]))
    assert once == pytest.approx(twice, rel=1e-14)
