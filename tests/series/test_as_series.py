"""The one door: what comes out is finite, in order of time, and leads back to the caller's rows."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.arrays import LARGEST_VALUE, InputError, Reason
from estimators.series import as_series

ANY = st.floats(-1e6, 1e6) | st.sampled_from([float("nan"), float("inf"), -float("inf")])
TIME = ANY.filter(lambda value: value == 0.0 or not abs(value) < 1e-30)


@settings(max_examples=300, deadline=None)
@given(st.lists(st.tuples(TIME, ANY, st.sampled_from([0.0, 0.5, 1.0, 1e300])), max_size=30))
def test_points_are_finite_sorted_and_traced_to_their_rows(rows: list[tuple[float, float, float]]) -> None:
    t, y, weights = (np.array(column) for column in zip(*rows, strict=True)) if rows else (np.empty(0),) * 3
    series = as_series(t, y, weights)
    assert np.isfinite(series.t).all()
    assert np.isfinite(series.y).all()
    assert (np.diff(series.t) >= 0.0).all()
    kept = np.arange(len(rows)) if series.rows is None else series.rows
    np.testing.assert_array_equal(series.y, y[kept])
    np.testing.assert_array_equal(series.t, t[kept] - float(series.axis.origin))
    usable = np.isfinite(t) & np.isfinite(y) & (weights > 0.0)
    assert sorted(kept) == np.flatnonzero(usable).tolist()
    assert series.n_input == len(rows)
    if series.n:
        assert series.weights.mean() == pytest.approx(1.0)


def test_a_series_in_order_is_not_copied_or_rearranged() -> None:
    t, y = np.arange(5.0), np.ones(5)
    series = as_series(t, y)
    assert series.rows is None
    assert series.y is y
    assert series.was_sorted


def test_missing_comes_before_invalid_before_zero_weight() -> None:
    series = as_series([np.inf, np.inf, 2.0, 3.0], [np.nan, 1.0, 1.0, 1.0], [0, 0, 0, 1])
    assert [Reason(code).name for code in series.reasons] == ["missing", "invalid", "zero_weight", "ok"]


def test_points_at_one_time_are_ordered_by_value_and_counted() -> None:
    series = as_series([1.0, 0.0, 1.0, 1.0], [9.0, 0.0, 7.0, 9.0])
    assert series.y.tolist() == [0.0, 7.0, 9.0, 9.0]
    assert series.duplicate_times == 2
    assert [Reason(code).name for code in series.reasons] == ["ok", "ok", "ok", "duplicate"]


def test_values_up_to_the_largest_are_taken() -> None:
    assert as_series([0.0, 1.0], [LARGEST_VALUE, -LARGEST_VALUE]).n == 2


def test_a_value_beyond_the_largest_is_named_by_its_row() -> None:
    with pytest.raises(InputError, match="row 1 is beyond") as caught:
        as_series([0.0, 1.0], [0.0, 2.0 * LARGEST_VALUE])
    assert caught.value.field == "y"


def test_infinite_values_are_invalid_rows_and_not_too_large() -> None:
    series = as_series([0.0, 1.0], [np.inf, 1.0])
    assert Reason(series.reasons[0]) is Reason.invalid
