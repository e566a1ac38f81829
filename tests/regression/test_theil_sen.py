"""Theil-Sen: slope, intercept, interval."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy import stats

from estimators.regression import slope_selection
from estimators.regression.slope_selection import PairSlopes
from estimators.regression.theil_sen import theil_sen, theil_sen_interval

tied = st.integers(-4, 4).map(float)
smooth = st.floats(-1e3, 1e3, allow_subnormal=False).filter(lambda v: v == 0 or abs(v) > 1e-6)
points = st.lists(st.tuples(st.one_of(tied, smooth), st.one_of(tied, smooth)), min_size=2, max_size=60)


def split(pairs: list[tuple[float, float]]) -> tuple[np.ndarray, np.ndarray]:
    t, y = np.array(pairs).T
    assume(np.ptp(t) > 0)
    return np.ascontiguousarray(t), np.ascontiguousarray(y)


@given(points)
@settings(deadline=None)
def test_the_slope_is_scipys_to_the_bit(pairs: list[tuple[float, float]]) -> None:
    t, y = split(pairs)
    with np.errstate(invalid="ignore"):  # its interval takes the root of a negative variance if all are tied
        expected = stats.theilslopes(y, t).slope
    assert theil_sen(t, y).slope == expected


def test_narrowing_finds_the_same_slope_to_the_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(slope_selection, "_LISTED", 16)
    rng = np.random.default_rng(0)
    for _ in range(150):
        n = int(rng.integers(20, 150))
        t = rng.uniform(-1, 1, n) if rng.random() < 0.5 else rng.integers(0, n, n).astype(float)
        y = rng.normal(size=n) if rng.random() < 0.5 else rng.integers(0, 6, n).astype(float)
        assert theil_sen(t, y).slope == stats.theilslopes(y, t).slope


@given(points, st.data())
@settings(deadline=None)
def test_every_rank_is_the_rank_among_the_sorted_slopes(
    pairs: list[tuple[float, float]], data: st.DataObject
) -> None:
    t, y = split(pairs)
    later = t[:, None] > t
    expected = np.sort((y[:, None] - y)[later] / (t[:, None] - t)[later])
    slopes = PairSlopes(t, y)
    assert slopes.count == expected.size
    rank = data.draw(st.integers(0, expected.size - 1))
    assert slopes.ranked([rank]) == [expected[rank]]


def test_thousands_of_points_agree_with_the_median_of_all_their_slopes() -> None:
    rng = np.random.default_rng(1)
    n = 3_000
    t = np.sort(rng.integers(0, 2_000, n)).astype(float)
    y = rng.normal(size=n) + 0.01 * t
    slopes = np.concatenate(
        [
            (y[i + 1 :] - y[i])[t[i + 1 :] != t[i]] / (t[i + 1 :] - t[i])[t[i + 1 :] != t[i]]
            for i in range(n - 1)
        ]
    )
    middle = slopes.size // 2
    low, high = np.partition(slopes, [middle - 1, middle])[[middle - 1, middle]]
    expected = high if slopes.size % 2 else 0.5 * (low + high)
    assert theil_sen(t, y).slope == pytest.approx(expected, rel=4e-16)


def test_a_hundred_thousand_points_without_noise_give_their_slope() -> None:
    t = np.linspace(-1, 1, 100_000)
    line = theil_sen(t, 1 + 2 * t)
    assert line.slope == pytest.approx(2.0, rel=4e-16)
    assert line.intercept == pytest.approx(1.0, rel=4e-16)


def test_values_on_a_coarse_grid_are_selected_among_long_ties() -> None:
    rng = np.random.default_rng(3)
    t = np.arange(3_000.0)
    y = np.floor(0.001 * t + rng.normal(size=3_000))
    assert theil_sen(t, y).slope == stats.theilslopes(y, t).slope


@given(points)
@settings(deadline=None)
def test_the_order_of_the_points_does_not_matter(pairs: list[tuple[float, float]]) -> None:
    t, y = split(pairs)
    order = np.random.default_rng(0).permutation(t.size)
    assert theil_sen(t[order], y[order]) == theil_sen(t, y)


def test_the_intercept_halves_the_points() -> None:
    rng = np.random.default_rng(5)
    t, y = rng.uniform(size=31), rng.normal(size=31)
    line = theil_sen(t, y)
    assert line.intercept == stats.theilslopes(y, t, method="joint").intercept
    assert np.count_nonzero(y > line.intercept + line.slope * t) <= 15


@pytest.mark.parametrize("n", [2, 3])
def test_the_fewest_points_are_fitted(n: int) -> None:
    t = np.arange(float(n))
    assert theil_sen(t, 4 - 3 * t).slope == -3.0


@pytest.mark.parametrize("y", [np.full(8, 2.5), np.zeros(8)])
def test_constant_values_have_slope_zero(y: np.ndarray) -> None:
    line = theil_sen(np.arange(8.0), y)
    assert (line.slope, line.intercept) == (0.0, y[0])


def test_repeating_every_point_changes_nothing() -> None:
    rng = np.random.default_rng(6)
    t, y = rng.uniform(size=21), rng.normal(size=21)
    assert theil_sen(np.tile(t, 3), np.tile(y, 3)) == theil_sen(t, y)


def test_equal_times_have_no_slope() -> None:
    with pytest.raises(ValueError, match="no two times differ"):
        theil_sen(np.ones(4), np.arange(4.0))


@pytest.mark.parametrize("seed", range(3))
def test_the_slope_holds_at_25_percent_outliers(seed: int) -> None:
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(-1, 1, 200))
    y = 1 + 2 * t + 0.1 * rng.normal(size=200)
    y[rng.permutation(200)[:50]] = 1e9
    assert abs(theil_sen(t, y).slope - 2) < 1.0


@given(st.lists(st.integers(0, 25).map(float), min_size=15, max_size=60), st.integers(0, 1000))
@settings(deadline=None)
def test_the_interval_is_scipys_also_with_tied_times(times: list[float], seed: int) -> None:
    t = np.array(times)
    assume(np.unique(t).size > 8)
    y = np.random.default_rng(seed).normal(size=t.size)
    ours, theirs = theil_sen_interval(t, y, 0.9), stats.theilslopes(y, t, 0.9)
    assert ours is not None
    assert (ours.low, ours.high) == (theirs.low_slope, theirs.high_slope)


def test_the_interval_covers_the_slope_as_often_as_it_says() -> None:
    rng = np.random.default_rng(7)
    t = np.sort(rng.uniform(-1, 1, 40))
    intervals = [theil_sen_interval(t, rng.standard_t(3, size=40), 0.9) for _ in range(1000)]
    covered = sum(found is not None and found.low <= 0 <= found.high for found in intervals)
    assert stats.binomtest(covered, 1000, 0.9).pvalue > 0.001


def test_its_standard_error_is_that_of_wilcoxon_scores_on_normal_noise() -> None:
    t = np.linspace(-1, 1, 2000)
    found = theil_sen_interval(t, np.random.default_rng(8).normal(size=2000))
    assert found is not None
    assert found.stderr == pytest.approx(np.sqrt(np.pi / 3 / np.sum(t**2)), rel=0.1)


def test_inflation_widens_the_interval_by_its_square_root() -> None:
    t = np.linspace(-1, 1, 2000)
    y = np.random.default_rng(9).normal(size=2000)
    plain, wide = theil_sen_interval(t, y), theil_sen_interval(t, y, inflation=4.0)
    assert plain is not None
    assert wide is not None
    assert wide.stderr == pytest.approx(2 * plain.stderr, rel=0.1)


def test_too_few_points_for_the_level_have_no_interval() -> None:
    assert theil_sen_interval(np.arange(4.0), np.array([0.0, 2.0, 1.0, 3.0])) is None


def test_no_warning_is_raised_for_extreme_values() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        line = theil_sen(np.array([0.0, 1e-300, 1.0, 2.0, 3.0]), np.array([0.0, 1e100, -1e100, 2.0, 5.0]))
    assert np.isfinite(line.slope)
