"""The fit on several features: designs without full rank, extreme units, honest intervals, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import t as student

from estimators import InputError, RobustOptions
from estimators.adapters.hyperplane import coefficient_variance, independent_columns
from estimators.adapters.sklearn import PlumblineRegressor
from estimators.consensus.found import LinearData, Scale
from estimators.consensus.search.closed import found_from_fit
from estimators.consensus.search.mm import MMSearch
from estimators.regression.bisquare import BISQUARE


def made(rows: int = 80, seed: int = 0, noise: float = 0.1) -> tuple[Any, Any]:
    """Three features and values 1 + 2 a - 3 b + c, every fifth one far off."""
    random = np.random.default_rng(seed)
    X = random.uniform(-1.0, 1.0, (rows, 3))
    y = 1.0 + X @ [2.0, -3.0, 1.0] + noise * random.standard_normal(rows)
    y[::5] += 20.0
    return X, y


def test_a_feature_that_does_not_vary_gets_a_coefficient_of_zero() -> None:
    X, y = made()
    plain = PlumblineRegressor().fit(X, y)
    model = PlumblineRegressor().fit(np.insert(X, 1, 7.0, axis=1), y)
    np.testing.assert_array_equal(model.coef_, np.insert(plain.coef_, 1, 0.0))
    assert np.isnan(model.stderr_).tolist() == [False, True, False, False]


def test_a_feature_that_others_determine_gets_a_coefficient_of_zero() -> None:
    X, y = made()
    model = PlumblineRegressor().fit(np.column_stack([X, X[:, 0] - 2.0 * X[:, 2] + 4.0]), y)
    np.testing.assert_allclose(model.coef_, [2.0, -3.0, 1.0, 0.0], atol=0.15)
    assert model.coef_[3] == 0.0


def test_one_feature_that_does_not_vary_leaves_a_robust_level() -> None:
    y = np.array([4.9, 5.0, 5.1, 5.0, 80.0, 4.95, 5.05, 90.0])
    model = PlumblineRegressor().fit(np.full((8, 1), 3.0), y)
    assert model.coef_.tolist() == [0.0]
    np.testing.assert_allclose(model.predict([[3.0], [9.0]]), 5.0, atol=0.05)


def test_a_coefficient_that_no_inlier_tells_has_no_variance() -> None:
    x = np.linspace(-1.0, 1.0, 20)
    only = np.where(x > 0.5, 1.0, 0.0)
    data = LinearData(np.array([np.ones(20), x, only]), np.zeros(20), x, None)
    residual = np.where(only > 0.0, 50.0, 0.1 * np.cos(np.arange(20.0)))
    found = found_from_fit(
        data, Scale(0.1, "given", None, "sigma", 1e-12), RobustOptions(), np.zeros(3), residual, 0.1, BISQUARE
    )
    variance, dof = coefficient_variance(data, found)
    assert np.isnan(variance).all()
    assert dof is None


def categories(count: int, seed: int) -> tuple[Any, Any, Any]:
    """Indicator columns and a number, values with every fifth one or so far off, and the levels."""
    random = np.random.default_rng(seed)
    kind = random.integers(0, count, 30 * count)
    levels = random.uniform(-10.0, 10.0, count)
    number = random.uniform(-1.0, 1.0, kind.size)
    y = levels[kind] + 2.0 * number + 0.1 * random.standard_normal(kind.size)
    off = random.uniform(size=kind.size) < 0.2
    y[off] += random.uniform(5.0, 50.0, np.count_nonzero(off))
    return np.column_stack([number, kind[:, None] == np.arange(count)]), y, levels


@pytest.mark.parametrize("count", [2, 4, 10, 20])
def test_categories_in_indicator_columns_get_their_levels(count: int) -> None:
    for seed in range(5):
        X, y, levels = categories(count, seed)
        model = PlumblineRegressor().fit(X, y)
        np.testing.assert_allclose(
            model.predict(np.column_stack([np.zeros(count), np.eye(count)])), levels, atol=0.2
        )


def error_of_levels(seed: int, *, starts_from_deviations: bool) -> float:
    """Largest error of a category's level, by an MM-estimate with and without that start."""
    X, y, levels = categories(20, seed)
    columns = np.ascontiguousarray(np.vstack([np.ones(y.size), X[:, :-1].T]))
    data = LinearData(columns, y, np.linspace(-1.0, 1.0, y.size), None)
    search = MMSearch(starts_from_deviations=starts_from_deviations)
    found = search.run(data, Scale(None, "given", None, "sigma", 1e-12), RobustOptions(), 0)
    assert found
    return float(np.abs(found.theta[0] + np.r_[found.theta[2:], 0.0] - levels).max())


def test_without_a_start_from_deviations_some_category_is_lost() -> None:
    assert max(error_of_levels(seed, starts_from_deviations=True) for seed in range(5)) < 0.2
    assert max(error_of_levels(seed, starts_from_deviations=False) for seed in range(5)) > 1.0


@given(
    st.lists(st.sampled_from([1e-20, 1e-6, 1.0, 1e9, 1e20]), min_size=3, max_size=3),
    st.sampled_from([2.0**-900, 2.0**-60, 1.0, 2.0**60]),
)
@settings(max_examples=25, deadline=None)
def test_units_of_features_and_values_change_only_the_units_of_the_answer(
    of_features: list[float], of_values: float
) -> None:
    X, y = made()
    plain = PlumblineRegressor().fit(X, y)
    model = PlumblineRegressor().fit(X * of_features, y * of_values)
    np.testing.assert_allclose(model.coef_ * of_features / of_values, plain.coef_, rtol=1e-6)
    np.testing.assert_allclose(model.stderr_ * of_features / of_values, plain.stderr_, rtol=1e-4)
    np.testing.assert_array_equal(model.inlier_mask_, plain.inlier_mask_)
    assert model.sigma_ / of_values == pytest.approx(plain.sigma_, rel=1e-6)


@given(st.lists(st.floats(-1e3, 1e3), min_size=4, max_size=4))
@settings(max_examples=25, deadline=None)
def test_adding_a_plane_to_the_values_adds_it_to_the_coefficients(added: list[float]) -> None:
    X, y = made()
    plain, model = (
        PlumblineRegressor().fit(X, values) for values in (y, y + added[0] + X @ np.array(added[1:]))
    )
    np.testing.assert_allclose(model.coef_ - plain.coef_, added[1:], atol=1e-7)
    assert model.intercept_ - plain.intercept_ == pytest.approx(added[0], abs=1e-7)


def test_least_squares_has_the_intervals_of_the_textbook() -> None:
    X, y = made(rows=25)
    design = np.column_stack([np.ones(25), X])
    theta = np.linalg.lstsq(design, y)[0]
    noise = np.sum((y - design @ theta) ** 2) / 21
    stderr = np.sqrt(np.diag(np.linalg.inv(design.T @ design)) * noise)
    half = student.ppf(0.975, 21) * stderr
    model = PlumblineRegressor("ols", threshold=1e3).fit(X, y)
    np.testing.assert_allclose(model.coef_, theta[1:], rtol=1e-9)
    np.testing.assert_allclose(model.stderr_, stderr[1:], rtol=1e-9)
    np.testing.assert_allclose(model.interval_, (theta[1:, None] + half[1:, None] * [-1, 1]), rtol=1e-9)


@pytest.mark.parametrize("method", ["auto", "msac"])
def test_intervals_of_95_percent_cover_the_truth_about_that_often(method: str) -> None:
    # 200 x 3 trials at 0.95: a share below 0.92 has a chance of about 1 in 1000, above 0.99 of 1 in 10^6.
    covered = []
    for seed in range(200):
        X, y = made(60, seed)
        low, high = PlumblineRegressor(method).fit(X, y).interval_.T
        covered.append((low <= [2.0, -3.0, 1.0]) & (high >= [2.0, -3.0, 1.0]))
    assert 0.92 <= np.mean(covered) <= 0.99


def test_an_exact_plane_is_found_exactly_and_has_no_outliers_among_its_rows() -> None:
    X, y = made(noise=0.0)
    model = PlumblineRegressor().fit(X, y)
    np.testing.assert_allclose(model.coef_, [2.0, -3.0, 1.0], rtol=1e-12)
    assert np.flatnonzero(~model.inlier_mask_).tolist() == list(range(0, 80, 5))


def test_as_many_rows_as_coefficients_leave_no_uncertainty_to_report() -> None:
    X, y = made()
    model = PlumblineRegressor("ols").fit(X[1:5], y[1:5])
    np.testing.assert_allclose(model.predict(X[1:5]), y[1:5], atol=1e-9)
    assert np.isnan(model.stderr_).all()


@pytest.mark.parametrize("rows", [1, 2, 3])
def test_fewer_rows_than_coefficients_are_refused(rows: int) -> None:
    X, y = made()
    with pytest.raises(
        ValueError, match=f"needs at least 4 rows of positive weight; there are n_samples = {rows}"
    ):
        PlumblineRegressor().fit(X[:rows], y[:rows])


def test_rows_of_weight_zero_do_not_count_as_rows() -> None:
    X, y = made()
    with pytest.raises(ValueError, match="n_samples = 2"):
        PlumblineRegressor().fit(X, y, sample_weight=np.r_[1.0, 1.0, np.zeros(78)])


@pytest.mark.parametrize("factor", [1e31, 1e-31, 1e300])
def test_features_with_which_coefficients_overflow_are_refused(factor: float) -> None:
    X, y = made()
    with pytest.raises(InputError, match="rescale") as caught:
        PlumblineRegressor().fit(X * [1.0, factor, 1.0], y)
    assert caught.value.field == "X"


def test_values_whose_squares_overflow_are_refused() -> None:
    X, y = made()
    with pytest.raises(InputError, match="rescale") as caught:
        PlumblineRegressor().fit(X, y * 1e60)
    assert caught.value.field == "y"


def test_columns_are_independent_of_those_before_them() -> None:
    x = np.linspace(-1.0, 1.0, 9)
    columns = np.column_stack([np.zeros(9), x, x + 1e-12 * x**2, x**3, 2.0 * x - x**3, np.abs(x)])
    assert independent_columns(columns).tolist() == [1, 3, 5]
