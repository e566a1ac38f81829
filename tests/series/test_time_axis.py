"""Times become numbers since the first one without losing a digit that 64-bit floats can hold."""

from __future__ import annotations

import datetime as dt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators.arrays import InputError
from estimators.time_axis import as_moments, as_times

INT64 = st.integers(-(2**63), 2**63 - 1)


@given(st.lists(INT64, min_size=1, max_size=8))
def test_signed_integers_are_subtracted_exactly(times: list[int]) -> None:
    internal, axis, column = as_times(np.array(times, dtype=np.int64))
    assert axis.origin == min(times)
    assert internal.tolist() == [float(time - min(times)) for time in times]
    assert column.tolist() == times


@given(st.lists(st.integers(0, 2**64 - 1), min_size=1, max_size=8))
def test_unsigned_integers_are_subtracted_exactly(times: list[int]) -> None:
    internal, _, _ = as_times(np.array(times, dtype=np.uint64))
    assert internal.tolist() == [float(time - min(times)) for time in times]


@given(st.lists(INT64, min_size=1, max_size=8), st.lists(INT64, min_size=1, max_size=8))
def test_other_integers_lie_where_they_should_on_the_axis(times: list[int], asked: list[int]) -> None:
    _, axis, _ = as_times(np.array(times, dtype=np.int64))
    assert axis.to_internal(asked).tolist() == [float(time - min(times)) for time in asked]


@given(st.lists(st.integers(-(9 * 10**18), 9 * 10**18), min_size=1, max_size=8))
def test_moments_are_seconds_since_the_first_over_any_span(nanoseconds: list[int]) -> None:
    times = np.array(nanoseconds, dtype=np.int64).astype("datetime64[ns]")
    internal, _, column = as_times(times)
    assert internal.tolist() == [float(time - min(nanoseconds)) / 1e9 for time in nanoseconds]
    np.testing.assert_array_equal(column, times)


@given(st.lists(st.floats(-1e15, 1e15).map(round).map(float), min_size=1, max_size=8))
def test_plain_numbers_come_back_from_the_axis(times: list[float]) -> None:
    internal, axis, _ = as_times(times)
    assert axis.from_internal(internal).tolist() == times


def test_missing_moments_are_nan_and_do_not_move_the_origin() -> None:
    internal, axis, _ = as_times(np.array(["NaT", "2024-01-02", "2024-01-01"], dtype="datetime64[D]"))
    assert axis.origin == np.datetime64("2024-01-01", "ns")
    np.testing.assert_array_equal(internal, [np.nan, 86400.0, 0.0])


@given(st.datetimes(dt.datetime(1700, 1, 1), dt.datetime(2200, 1, 1), timezones=st.timezones()))
def test_moments_in_any_zone_are_read_in_utc(moment: dt.datetime) -> None:
    utc = moment.astimezone(dt.UTC).replace(tzinfo=None)
    assert as_moments([moment])[0] == np.datetime64(utc, "ns")
    assert as_moments([moment.isoformat()])[0] == np.datetime64(utc, "ns")


@pytest.mark.parametrize("text", ["1677-01-01", "2262-01-01", "9999-12-31T23:59:59Z"])
def test_moments_beyond_what_nanoseconds_hold_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="1678 and 2261"):
        as_moments([text])


@pytest.mark.parametrize("text", ["", "tomorrow", "2024-13-01", "12"])
def test_text_that_is_no_moment_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="points in time"):
        as_moments([text])
