"""One row out per row in, in input order, each with a reason."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import Trend, fit_trend
from estimators.arrays import Reason
from tests.trends.contaminated import contaminated, fitted, refused

CELLS = st.one_of(
    st.none(), st.sampled_from([float("nan"), float("inf"), -float("inf"), 0.0, 1.0]), st.floats(-1e6, 1e6)
)
TIMES = st.one_of(
    st.none(), st.sampled_from([float("nan"), float("inf"), 3.0]), st.integers(-50, 50).map(float)
)


@settings(max_examples=200, deadline=None)
@given(st.lists(st.tuples(TIMES, CELLS), max_size=40))
def test_whatever_the_rows_hold_each_has_a_reason_and_nothing_overflows(
    rows: list[tuple[float | None, float | None]],
) -> None:
    t, y = [row[0] for row in rows], [row[1] for row in rows]
    answer = fit_trend(t, y)
    points = answer.points
    assert points.inlier.size == points.probability.size == points.residual.size == len(rows)
    for time, value, reason in zip(t, y, points.reason, strict=True):
        gone = [x is None or np.isnan(x) for x in (time, value)]
        if any(gone):
            assert reason == "missing"
        elif np.isinf(time) or np.isinf(value):
            assert reason == "invalid"
        else:
            assert reason in ("ok", "outlier", "duplicate")
    if isinstance(answer, Trend):
        took_part = points.reason_codes != Reason.missing
        took_part &= points.reason_codes != Reason.invalid
        assert np.isfinite(points.residual[took_part]).all()
        assert ((points.probability[took_part] >= 0) & (points.probability[took_part] <= 1)).all()
        assert not points.inlier[~took_part].any()
        assert np.isnan(points.residual[~took_part]).all()
        assert all(np.isfinite(estimate.value) for estimate in answer.parameters.values())


def test_rows_that_cannot_be_used_change_nothing_for_the_others() -> None:
    data = contaminated(seed=1)
    plain = fitted(data.t, data.y)
    t, y = np.insert(data.t, [5, 40], [np.nan, 50.0]), np.insert(data.y, [5, 40], [1.0, np.inf])
    widened = fitted(t, y)
    kept = np.delete(np.arange(82), [5, 41])
    assert widened.parameters == plain.parameters
    assert [widened.points.reason[row] for row in (5, 41)] == ["missing", "invalid"]
    np.testing.assert_array_equal(widened.points.inlier[kept], plain.points.inlier)
    np.testing.assert_array_equal(widened.points.probability[kept], plain.points.probability)


@settings(max_examples=40, deadline=None)
@given(st.permutations(range(40)))
def test_the_order_of_the_rows_does_not_matter(order: list[int]) -> None:
    data = contaminated(40, seed=2)
    rows = np.array(order)
    plain, shuffled = fitted(data.t, data.y), fitted(data.t[rows], data.y[rows])
    assert shuffled.parameters == plain.parameters
    np.testing.assert_array_equal(shuffled.points.inlier, plain.points.inlier[rows])
    np.testing.assert_array_equal(shuffled.points.residual, plain.points.residual[rows])


def test_points_that_share_times_and_values_do_not_depend_on_the_order_either() -> None:
    rng = np.random.default_rng(3)
    t, y = rng.integers(0, 10, 60).astype(float), np.round(rng.normal(size=60), 1)
    rows = rng.permutation(60)
    assert fitted(t[rows], y[rows]).parameters == fitted(t, y).parameters


def test_an_exact_repeat_is_used_and_called_a_duplicate() -> None:
    data = contaminated(seed=4)
    inlier = int(np.flatnonzero(~data.outlier)[10])
    trend = fitted(np.append(data.t, data.t[inlier]), np.append(data.y, data.y[inlier]))
    assert trend.points.reason[-1] == "duplicate"
    assert trend.points.inlier[-1]
    assert trend.consensus.n == 81


def test_an_outlier_that_is_repeated_is_still_an_outlier() -> None:
    data = contaminated(seed=4)
    row = int(np.flatnonzero(data.outlier)[3])
    trend = fitted(np.append(data.t, data.t[row]), np.append(data.y, data.y[row]))
    assert trend.points.reason[row] == trend.points.reason[-1] == "outlier"


def test_the_outliers_planted_are_the_outliers_found() -> None:
    data = contaminated(120, 0.3, seed=5)
    trend = fitted(data.t, data.y)
    assert not trend.points.inlier[data.outlier].any()
    assert trend.points.inlier[~data.outlier].mean() > 0.95
    assert trend.points.probability[data.outlier].max() < 0.05


@pytest.mark.parametrize("value", [0.0, 5.0, -2.5e-7, 1e12])
def test_constant_values_give_a_level_line_and_no_evidence_of_a_slope(value: float) -> None:
    trend = fitted(np.arange(30.0), np.full(30, value))
    assert abs(trend.parameters["slope"].value) <= 1e-15 * abs(value)
    assert trend.parameters["intercept"].value == pytest.approx(value, rel=1e-14)
    assert trend.points.inlier.all()
    assert trend.points.probability.min() > 0.9
    assert trend.p_value == pytest.approx(1.0)
    assert trend.r2 is None


def test_a_line_without_noise_is_met_and_its_few_outliers_are_named() -> None:
    t = np.arange(40.0)
    y = 2.0 - 0.25 * t
    y[[3, 17, 30]] += [5.0, -8.0, 11.0]
    trend = fitted(t, y)
    assert np.flatnonzero(~trend.points.inlier).tolist() == [3, 17, 30]
    assert trend.parameters["slope"].value == pytest.approx(-0.25, rel=1e-6)


def test_ties_in_the_values_do_not_make_outliers() -> None:
    rng = np.random.default_rng(6)
    t = np.arange(200.0)
    y = np.round(0.05 * t + rng.normal(0.0, 0.4, 200))
    trend = fitted(t, y)
    assert trend.points.inlier.mean() > 0.97
    assert trend.parameters["slope"].low <= 0.05 <= trend.parameters["slope"].high


def test_one_column_of_repeated_times_beside_another_makes_a_line_of_two_levels() -> None:
    rng = np.random.default_rng(7)
    t = np.repeat([0.0, 10.0], 30)
    trend = fitted(t, 0.2 * t + rng.normal(0.0, 0.1, 60))
    assert trend.parameters["slope"].value == pytest.approx(0.2, abs=0.02)


def test_lists_with_none_are_series_with_missing_rows() -> None:
    trend = fitted([0, 1, 2, 3, None, 5, 6], [1, 2.0, None, 4, 5, 6, 7])
    assert trend.points.reason == ["ok", "ok", "missing", "ok", "missing", "ok", "ok"]
    assert trend.parameters["slope"].value == pytest.approx(1.0, rel=1e-9)


def test_no_fit_keeps_the_reasons_of_the_rows() -> None:
    answer = refused([0.0, np.nan, 2.0], [np.nan, 1.0, np.inf])
    assert answer.points.reason == ["missing", "missing", "invalid"]
    assert [item.code.value for item in answer.notices] == ["missing_values", "invalid_values"]
