"""Siegel's repeated median."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy import stats

from estimators.regression import repeated_median as module
from estimators.regression.repeated_median import (
    MAX_POINTS,
    TooManySlopesError,
    repeated_median,
    repeated_median_uncertainty,
)

tied = st.integers(-4, 4).map(float)
smooth = st.floats(-1e3, 1e3, allow_subnormal=False).filter(lambda v: v == 0 or abs(v) > 1e-6)
points = st.lists(st.tuples(st.one_of(tied, smooth), st.one_of(tied, smooth)), min_size=2, max_size=50)


def slope_by_definition(t: np.ndarray, y: np.ndarray) -> float:
    inner = [np.median((y[t != t[i]] - y[i]) / (t[t != t[i]] - t[i])) for i in range(t.size)]
    return float(np.median(inner))


@given(points)
@settings(deadline=None)
def test_the_slope_is_the_median_of_the_medians_to_the_bit(pairs: list[tuple[float, float]]) -> None:
    t, y = (np.ascontiguousarray(column) for column in np.array(pairs).T)
    assume(np.ptp(t) > 0)
    assert repeated_median(t, y).slope == slope_by_definition(t, y)


@pytest.mark.parametrize("kind", ["smooth", "tied values", "tied times", "two lines", "exact"])
def test_narrowing_finds_the_same_slope_to_the_bit(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_FORMED", 16)
    monkeypatch.setattr(module, "_SAMPLED_ROWS", 8)
    rng = np.random.default_rng(len(kind))
    for _ in range(60):
        n = int(rng.integers(20, 150))
        t = rng.integers(0, n // 2, n).astype(float) if kind == "tied times" else rng.uniform(-1, 1, n)
        y = {
            "smooth": rng.normal(size=n),
            "tied values": rng.integers(0, 5, n).astype(float),
            "tied times": rng.normal(size=n),
            "two lines": np.where(rng.random(n) < 0.5, t, -t),
            "exact": 3 + 2 * t,
        }[kind]
        assert repeated_median(t, y).slope == pytest.approx(slope_by_definition(t, y), rel=3e-16, abs=0)


@pytest.mark.parametrize("n", [900, 3001])
def test_the_line_is_scipys_on_distinct_times(n: int) -> None:
    rng = np.random.default_rng(n)
    t = np.sort(rng.uniform(-1, 1, n))
    y = 1 + 2 * t + rng.standard_t(2, size=n)
    ours, theirs = repeated_median(t, y), stats.siegelslopes(y, t)
    assert (ours.slope, ours.intercept) == (theirs.slope, theirs.intercept)


def test_fifty_thousand_points_are_fitted() -> None:
    rng = np.random.default_rng(0)
    t = np.sort(rng.uniform(-1, 1, 50_000))
    y = 1 + 2 * t + 0.1 * rng.normal(size=50_000)
    y[rng.permutation(50_000)[:20_000]] = 30.0
    assert repeated_median(t, y).slope == pytest.approx(2.0, abs=0.1)


def test_fifty_thousand_points_without_noise_give_their_slope() -> None:
    t = np.linspace(-1, 1, 50_000)
    assert repeated_median(t, 1 + 2 * t).slope == pytest.approx(2.0, rel=4e-16)


@pytest.mark.parametrize("seed", range(3))
def test_the_slope_holds_at_45_percent_outliers(seed: int) -> None:
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(-1, 1, 200))
    y = 1 + 2 * t + 0.1 * rng.normal(size=200)
    y[rng.permutation(200)[:90]] = 1e9
    assert abs(repeated_median(t, y).slope - 2) < 2.0


@pytest.mark.parametrize("n", [2, 3])
def test_the_fewest_points_are_fitted(n: int) -> None:
    t = np.arange(float(n))
    line = repeated_median(t, 4 - 3 * t)
    assert (line.slope, line.intercept) == (-3.0, 4.0)


def test_constant_values_have_slope_zero() -> None:
    line = repeated_median(np.arange(700.0), np.full(700, 2.5))
    assert (line.slope, line.intercept) == (0.0, 2.5)


def test_equal_times_have_no_slope() -> None:
    with pytest.raises(ValueError, match="no two times differ"):
        repeated_median(np.ones(4), np.arange(4.0))


def test_too_many_points_are_refused_before_any_work() -> None:
    many = np.zeros(MAX_POINTS + 1)
    with pytest.raises(TooManySlopesError, match=str(MAX_POINTS)):
        repeated_median(many, many)


def test_rows_that_counting_cannot_tell_apart_are_refused_rather_than_formed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "_FORMED", 16)
    monkeypatch.setattr(module, "_SAMPLED_ROWS", 4)
    monkeypatch.setattr(module, "_WORTH_FORMING", 0)
    monkeypatch.setattr(module, "_MOST_FORMED", 10)
    rng = np.random.default_rng(1)
    t, y = rng.uniform(-1, 1, 51), rng.integers(0, 3, 51).astype(float)
    with pytest.raises(TooManySlopesError, match="rows"):
        repeated_median(t, y)


def test_the_interval_from_groups_covers_the_slope() -> None:
    rng = np.random.default_rng(2)
    covered = 0
    for _ in range(200):
        t = np.sort(rng.uniform(-1, 1, 60))
        y = rng.normal(size=60)
        found = repeated_median_uncertainty(t, y)
        assert found is not None
        covered += bool(abs(repeated_median(t, y).slope) <= stats.t.ppf(0.975, found.dof) * found.stderr[1])
    assert covered >= 180
