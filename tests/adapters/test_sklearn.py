"""PlumblineRegressor where people use it: scikit-learn's own checks, pipelines, searches, frames, pickles."""

from __future__ import annotations

import pickle
import warnings
from typing import Any

import numpy as np
import pandas as pd
import pytest
from sklearn.base import clone
from sklearn.model_selection import GridSearchCV, cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler
from sklearn.utils.estimator_checks import parametrize_with_checks

from estimators import InputError, RobustOptions, fit_trend
from estimators.adapters.sklearn import PlumblineRegressor

COEFFICIENTS = np.array([2.0, -3.0, 0.5, 1.0, 4.0, -1.5, 0.25, 3.0, -2.0, 1.0, 6.0, -4.0])


def planes(features: int, rows: int = 150, share: float = 0.3, seed: int = 0) -> tuple[Any, Any, Any]:
    """Features, values 1 + coefficients . x with noise of 0.1, and which rows are no outliers."""
    random = np.random.default_rng(seed)
    X = random.uniform(-1.0, 1.0, (rows, features))
    y = 1.0 + X @ COEFFICIENTS[:features] + 0.1 * random.standard_normal(rows)
    clean = np.arange(rows) >= round(share * rows)
    y[~clean] += random.uniform(5.0, 50.0, np.count_nonzero(~clean))
    order = random.permutation(rows)
    return X[order], y[order], clean[order]


def excused(estimator: PlumblineRegressor) -> dict[str, str]:
    # The one check from which scikit-learn excuses its own RANSACRegressor.
    del estimator
    return {
        "check_sample_weight_equivalence_on_dense_data": "weights are precisions, not numbers of repetitions"
    }


@parametrize_with_checks(
    [PlumblineRegressor(), PlumblineRegressor("msac"), PlumblineRegressor("huber")],
    expected_failed_checks=excused,
)
def test_the_regressor_passes_the_checks_of_scikit_learn(estimator: Any, check: Any) -> None:
    with warnings.catch_warnings():
        # A check that does not apply (array API) says so by a warning before it skips.
        warnings.simplefilter("ignore", category=UserWarning)
        check(estimator)


def test_scikit_learn_excuses_its_own_ransac_from_the_same_check() -> None:
    from sklearn.linear_model import RANSACRegressor
    from sklearn.utils._test_common.instance_generator import PER_ESTIMATOR_XFAIL_CHECKS

    assert set(excused(PlumblineRegressor())) <= set(PER_ESTIMATOR_XFAIL_CHECKS[RANSACRegressor])


def test_with_one_feature_the_answer_is_that_of_fit_trend() -> None:
    X, y, _ = planes(1)
    model, trend = PlumblineRegressor().fit(X, y), fit_trend(X[:, 0], y)
    assert trend
    slope = trend.parameters["slope"]
    assert model.coef_.tolist() == [slope.value]
    assert model.stderr_.tolist() == [slope.stderr]
    assert model.interval_.tolist() == [[slope.low, slope.high]]
    assert model.intercept_ == trend.parameters["intercept"].value
    assert model.sigma_ == trend.consensus.sigma
    np.testing.assert_array_equal(model.inlier_mask_, trend.points.inlier)
    np.testing.assert_array_equal(model.inlier_probability_, trend.points.probability)
    assert model.trend_.parameters == trend.parameters


@pytest.mark.parametrize("method", ["siegel", "theil-sen", "mm", "ransac"])
def test_the_method_is_that_of_fit_trend(method: str) -> None:
    X, y, _ = planes(1)
    trend = fit_trend(X[:, 0], y, method=method)
    assert trend
    assert PlumblineRegressor(method).fit(X, y).coef_[0] == trend.parameters["slope"].value


@pytest.mark.parametrize("features", [1, 2, 3, 7, 12])
@pytest.mark.parametrize("method", ["auto", "msac", "lo-ransac"])
def test_outliers_do_not_move_the_coefficients_of_any_number_of_features(features: int, method: str) -> None:
    X, y, clean = planes(features)
    model = PlumblineRegressor(method).fit(X, y)
    np.testing.assert_allclose(model.coef_, COEFFICIENTS[:features], atol=0.12)
    assert model.intercept_ == pytest.approx(1.0, abs=0.06)
    assert not model.inlier_mask_[~clean].any()
    assert model.inlier_mask_[clean].mean() > 0.9


def test_least_squares_is_moved_by_the_same_outliers() -> None:
    X, y, _ = planes(3)
    assert abs(PlumblineRegressor("ols").fit(X, y).intercept_ - 1.0) > 3.0


def test_inlier_probabilities_tell_outliers_from_inliers() -> None:
    X, y, clean = planes(4)
    model = PlumblineRegressor().fit(X, y)
    assert model.inlier_probability_[~clean].max() < 0.05
    assert np.median(model.inlier_probability_[clean]) > 0.9


def test_predictions_keep_their_digits_far_from_zero() -> None:
    seconds = 1.7e9 + np.arange(200.0)[:, None]
    y = 5.0 + 1e-3 * (seconds[:, 0] - 1.7e9)
    model = PlumblineRegressor().fit(seconds, y)
    np.testing.assert_allclose(model.predict(seconds), y, rtol=0, atol=1e-12)
    shifted = np.column_stack([seconds, seconds**2 / 1e9])
    model = PlumblineRegressor().fit(shifted, y)
    np.testing.assert_allclose(model.predict(shifted), y, rtol=0, atol=1e-6)


def test_the_score_is_one_on_clean_rows() -> None:
    X, y, clean = planes(3)
    assert PlumblineRegressor().fit(X, y).score(X[clean], y[clean]) > 0.99


@pytest.mark.parametrize("features", [1, 3])
def test_rows_of_weight_zero_have_no_part(features: int) -> None:
    X, y, _ = planes(features)
    weights = np.where(np.arange(y.size) % 3 == 0, 0.0, 1.0)
    weighted = PlumblineRegressor().fit(X, y, sample_weight=weights)
    without = PlumblineRegressor().fit(X[weights > 0], y[weights > 0])
    np.testing.assert_array_equal(weighted.coef_, without.coef_)
    assert weighted.intercept_ == without.intercept_
    assert not weighted.inlier_mask_[weights == 0].any()
    assert np.isnan(weighted.inlier_probability_[weights == 0]).all()


@pytest.mark.parametrize("features", [1, 4])
def test_weights_pull_the_fit_towards_the_rows_that_are_known_better(features: int) -> None:
    random = np.random.default_rng(3)
    X = random.uniform(-1.0, 1.0, (400, features))
    scatter = np.where(np.arange(400) % 2 == 0, 0.02, 1.0)
    y = 1.0 + X @ COEFFICIENTS[:features] + scatter * random.standard_normal(400)
    weighted = PlumblineRegressor("mm").fit(X, y, sample_weight=1.0 / scatter**2)
    plain = PlumblineRegressor("mm").fit(X, y)
    truth = COEFFICIENTS[:features]
    assert np.abs(weighted.coef_ - truth).max() < np.abs(plain.coef_ - truth).max()
    assert (weighted.stderr_ < plain.stderr_).all()


@pytest.mark.parametrize("features", [1, 3])
def test_only_the_ratios_of_weights_count(features: int) -> None:
    X, y, _ = planes(features)
    weights = np.random.default_rng(1).uniform(0.5, 2.0, y.size)
    one = PlumblineRegressor().fit(X, y, sample_weight=weights)
    other = PlumblineRegressor().fit(X, y, sample_weight=1024.0 * weights)
    np.testing.assert_array_equal(one.coef_, other.coef_)
    assert one.sigma_ == other.sigma_


def test_the_threshold_is_the_one_that_was_given() -> None:
    X, y, _ = planes(3)
    model = PlumblineRegressor("msac", threshold=0.25).fit(X, y)
    assert model.threshold_ == 0.25
    np.testing.assert_array_equal(model.inlier_mask_, np.abs(y - model.predict(X)) <= 0.25)


def test_a_given_noise_scale_sets_the_threshold() -> None:
    X, y, _ = planes(3)
    model = PlumblineRegressor("msac", sigma=0.2, options=RobustOptions(threshold_sigmas=3.0)).fit(X, y)
    assert model.sigma_ == 0.2
    assert model.threshold_ == pytest.approx(0.6)


def test_the_level_sets_the_width_of_the_intervals() -> None:
    X, y, _ = planes(3)
    narrow, wide = (np.ptp(PlumblineRegressor(level=p).fit(X, y).interval_, axis=1) for p in (0.5, 0.99))
    assert (narrow < 0.5 * wide).all()


@pytest.mark.parametrize("features", [1, 3])
def test_the_same_random_state_gives_the_same_model(features: int) -> None:
    X, y, _ = planes(features)
    options = RobustOptions(work_budget=0)
    for state in (0, 7):
        first, second = (
            PlumblineRegressor("ransac", threshold=0.3, random_state=state, options=options).fit(X, y)
            for _ in range(2)
        )
        np.testing.assert_array_equal(first.coef_, second.coef_)
    drawn = [
        PlumblineRegressor("ransac", threshold=0.3, random_state=np.random.RandomState(5), options=options)
        for _ in range(2)
    ]
    np.testing.assert_array_equal(drawn[0].fit(X, y).coef_, drawn[1].fit(X, y).coef_)


def test_a_clone_has_the_parameters_and_nothing_of_the_fit() -> None:
    X, y, _ = planes(2)
    model = PlumblineRegressor("mm", sigma=0.1, options=RobustOptions(confidence=0.999)).fit(X, y)
    copy = clone(model)
    assert copy.get_params() == model.get_params()
    assert not hasattr(copy, "coef_")


@pytest.mark.parametrize("features", [1, 3])
def test_a_pickled_model_predicts_the_same(features: int) -> None:
    X, y, _ = planes(features)
    model = PlumblineRegressor().fit(X, y)
    again = pickle.loads(pickle.dumps(model))
    np.testing.assert_array_equal(again.predict(X), model.predict(X))


def test_the_regressor_stands_at_the_end_of_a_pipeline() -> None:
    t = np.linspace(0.0, 10.0, 120)
    y = 3.0 - 2.0 * t + 0.5 * t**2 + 0.1 * np.random.default_rng(2).standard_normal(120)
    y[::4] += 30.0
    line = make_pipeline(PolynomialFeatures(2, include_bias=False), StandardScaler(), PlumblineRegressor())
    line.fit(t[:, None], y)
    np.testing.assert_allclose(line.predict([[0.0], [4.0]]), [3.0, 3.0], atol=0.2)


def test_a_grid_search_finds_the_method_that_predicts_best() -> None:
    X, y, _ = planes(2)
    search = GridSearchCV(
        PlumblineRegressor(),
        {"method": ["ols", "auto"], "level": [0.9, 0.95]},
        scoring="neg_median_absolute_error",
        cv=4,
    )
    assert search.fit(X, y).best_params_["method"] == "auto"


def test_cross_validation_tells_how_well_most_rows_are_predicted() -> None:
    X, y, _ = planes(3)
    errors = -cross_val_score(PlumblineRegressor(), X, y, scoring="neg_median_absolute_error", cv=5)
    assert errors.max() < 0.3


def test_names_of_columns_are_kept_and_checked() -> None:
    X, y, _ = planes(2)
    frame = pd.DataFrame(X, columns=["north", "up"])
    model = PlumblineRegressor().fit(frame, y)
    assert model.feature_names_in_.tolist() == ["north", "up"]
    assert model.n_features_in_ == 2
    with pytest.raises(ValueError, match="feature names"):
        model.predict(frame[["up", "north"]])


def test_a_pipeline_that_passes_frames_on_reaches_the_regressor_with_its_names() -> None:
    X, y, _ = planes(2)
    frame = pd.DataFrame(X, columns=["north", "up"])
    line = make_pipeline(StandardScaler(), PlumblineRegressor()).set_output(transform="pandas")
    line.fit(frame, y)
    assert line[-1].feature_names_in_.tolist() == ["north", "up"]


def test_a_pandas_series_of_values_is_taken() -> None:
    X, y, _ = planes(2)
    series = PlumblineRegressor().fit(pd.DataFrame(X, columns=["a", "b"]), pd.Series(y))
    np.testing.assert_array_equal(series.coef_, PlumblineRegressor().fit(X, y).coef_)


@pytest.mark.parametrize(
    ("parameters", "field"),
    [
        ({"method": "ransack"}, "method"),
        ({"threshold": -1.0}, "threshold"),
        ({"sigma": "small"}, "sigma"),
        ({"level": 1.0}, "level"),
        ({"random_state": -1}, "seed"),
        ({"options": {"confidence": 0.9}}, "options"),
    ],
)
@pytest.mark.parametrize("features", [1, 2])
def test_a_parameter_that_cannot_be_used_is_named(
    parameters: dict[str, Any], field: str, features: int
) -> None:
    X, y, _ = planes(features)
    with pytest.raises(InputError) as caught:
        PlumblineRegressor(**parameters).fit(X, y)
    assert caught.value.field == field


@pytest.mark.parametrize("method", ["siegel", "theil-sen"])
def test_methods_for_lines_refuse_several_features(method: str) -> None:
    X, y, _ = planes(2)
    with pytest.raises(InputError, match="fits lines only"):
        PlumblineRegressor(method).fit(X, y)
