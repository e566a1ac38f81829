"""Every form in which people have times gives the same trend."""

from __future__ import annotations

import datetime as dt
from typing import Any

import numpy as np
import pandas as pd
import pytest

from estimators import InputError, NoticeCode, fit_trend
from tests.trends.contaminated import contaminated, fitted

DAY = 86400.0
DATA = contaminated(60, seed=13)
SECONDS = np.arange(60)
NANOSECONDS = 1_700_000_000_000_000_000 + SECONDS * 10**9
PLAIN = fitted(SECONDS, DATA.y)


def same_line(times: Any, unit: float) -> None:
    """The trend at these times is the one at 0, 1, 2, ... units."""
    trend = fitted(times, DATA.y)
    assert trend.parameters["slope"].value * unit == pytest.approx(PLAIN.parameters["slope"].value, rel=1e-9)
    assert trend.parameters["slope"].stderr * unit == pytest.approx(
        PLAIN.parameters["slope"].stderr, rel=1e-9
    )
    np.testing.assert_array_equal(trend.points.inlier, PLAIN.points.inlier)


@pytest.mark.parametrize("dtype", [np.int64, np.uint64, object])
def test_integer_epoch_nanoseconds_are_exact(dtype: Any) -> None:
    same_line(NANOSECONDS.astype(dtype), 1e9)


def test_unsigned_times_beyond_the_signed_ones_are_exact() -> None:
    same_line(np.uint64(2**63 + 11) + SECONDS.astype(np.uint64), 1.0)


def test_python_integers_of_any_size_are_exact() -> None:
    same_line([10**20 + int(second) for second in SECONDS], 1.0)


def test_integers_with_a_gap_in_the_list_stay_exact() -> None:
    apart = [int(second) for second in 1_700_000_000_000_000_000 + SECONDS]
    holed = fitted([None, *apart], [0.0, *DATA.y])
    assert holed.parameters["slope"].value == pytest.approx(PLAIN.parameters["slope"].value, rel=1e-9)
    assert holed.points.reason[0] == "missing"


@pytest.mark.parametrize("dtype", [np.int8, np.int16, np.int32, np.uint8, np.float16, np.float32, np.float64])
def test_any_number_type_will_do(dtype: Any) -> None:
    same_line(SECONDS.astype(dtype), 1.0)


@pytest.mark.parametrize(
    ("unit", "seconds"),
    [
        ("W", 7 * DAY),
        ("D", DAY),
        ("h", 3600.0),
        ("m", 60.0),
        ("s", 1.0),
        ("ms", 1e-3),
        ("us", 1e-6),
        ("ns", 1e-9),
    ],
)
def test_datetimes_of_any_unit_are_in_seconds(unit: str, seconds: float) -> None:
    same_line(np.datetime64("2024-02-01", unit) + SECONDS, seconds)


def test_years_and_months_have_their_calendar_lengths() -> None:
    months = np.datetime64("2020-01", "M") + SECONDS
    days = months.astype("datetime64[D]")
    assert fitted(months, DATA.y).parameters == fitted(days, DATA.y).parameters
    years = np.datetime64("1970", "Y") + SECONDS
    assert fitted(years, DATA.y).parameters == fitted(years.astype("datetime64[s]"), DATA.y).parameters


def test_three_centuries_of_datetimes_do_not_wrap_round() -> None:
    years = np.datetime64("1700", "Y") + np.arange(0, 300, 5)
    slope = fitted(years, DATA.y).parameters["slope"].value * 5 * 365.2425 * DAY
    assert slope == pytest.approx(PLAIN.parameters["slope"].value, rel=1e-3)


@pytest.mark.parametrize("first", ["1000", "2200"])
def test_datetimes_that_nanoseconds_cannot_hold_are_refused(first: str) -> None:
    with pytest.raises(InputError, match="1678 and 2261") as caught:
        fit_trend(np.datetime64(first, "Y") + 10 * SECONDS, DATA.y)
    assert caught.value.field == "t"


def test_python_datetimes_and_dates_are_times() -> None:
    same_line([dt.datetime(2024, 1, 1) + dt.timedelta(days=int(k)) for k in SECONDS], DAY)
    same_line([dt.date(2024, 1, 1) + dt.timedelta(days=int(k)) for k in SECONDS], DAY)


def test_datetimes_in_any_zone_are_the_same_moments() -> None:
    zone = dt.timezone(dt.timedelta(hours=5, minutes=30))
    utc = [dt.datetime(2024, 1, 1, tzinfo=dt.UTC) + dt.timedelta(hours=int(k)) for k in SECONDS]
    there = [moment.astimezone(zone) for moment in utc]
    assert fitted(there, DATA.y).parameters == fitted(utc, DATA.y).parameters
    assert fitted(there, DATA.y).origin == np.datetime64("2024-01-01T00:00:00", "ns")


def test_missing_datetimes_may_come_first() -> None:
    times = [None] * 9 + [dt.datetime(2024, 1, 1) + dt.timedelta(days=int(k)) for k in SECONDS[9:]]
    trend = fitted(times, DATA.y)
    assert trend.points.reason[:9] == ["missing"] * 9
    assert trend.origin == np.datetime64("2024-01-10", "ns")


def test_the_answer_keeps_the_times_to_the_nanosecond() -> None:
    times = np.datetime64("2024-01-01T00:00:00.123456789", "ns") + 12_345_678_912_345_679 * np.arange(20)
    np.testing.assert_array_equal(fitted(times, DATA.y[:20]).time, times)


def test_float_epoch_nanoseconds_are_taken_with_a_notice() -> None:
    trend = fitted(NANOSECONDS.astype(float), DATA.y)
    assert NoticeCode.float_nanoseconds in {item.code for item in trend.notices}
    same_line(NANOSECONDS.astype(float), 1e9)


def test_integers_at_both_ends_of_64_bits_do_not_overflow() -> None:
    t = np.array([-(2**63), *range(-5, 5), 2**63 - 1], dtype=np.int64)
    trend = fitted(t, 3.0 + 2e-19 * t.astype(float) + 0.01 * np.sin(np.arange(12.0)), method="ols")
    assert trend.parameters["slope"].value == pytest.approx(2e-19, rel=0.05)


@pytest.mark.parametrize("zone", [None, "Europe/Berlin", "UTC"])
def test_a_pandas_series_with_datetimes_may_be_given_alone(zone: str | None) -> None:
    index = pd.date_range("2024-03-01", periods=60, freq="D", tz="UTC").tz_convert(zone)
    alone = fitted(pd.Series(DATA.y, index=index))
    same_line(index, DAY)
    same_line(pd.Series(index), DAY)
    assert alone.parameters == fitted(index, DATA.y).parameters
    assert alone.origin == np.datetime64("2024-03-01", "ns")


def test_a_pandas_series_with_numbers_as_index_may_be_given_alone() -> None:
    assert fitted(pd.Series(DATA.y, index=SECONDS)).parameters == PLAIN.parameters


@pytest.mark.parametrize("dtype", ["Int64", "Float64", "double[pyarrow]"])
def test_nullable_pandas_columns_have_missing_rows(dtype: str) -> None:
    values = pd.Series([None, *np.round(100 * DATA.y)], dtype="Float64").astype(dtype)
    trend = fitted(np.arange(61), values)
    assert trend.points.reason[0] == "missing"
    assert trend.consensus.n == 60


def test_nullable_pandas_integers_as_times_stay_exact() -> None:
    times = pd.array([None, *(1_700_000_000_000_000_000 + SECONDS)], dtype="Int64")
    trend = fitted(times, [0.0, *DATA.y])
    assert trend.parameters["slope"].value == pytest.approx(PLAIN.parameters["slope"].value, rel=1e-9)


@pytest.mark.parametrize("dtype", ["timestamp[ns][pyarrow]", "timestamp[us, tz=Europe/Berlin][pyarrow]"])
def test_arrow_timestamps_are_times(dtype: str) -> None:
    index = pd.Series(pd.date_range("2024-03-01", periods=60, freq="D", tz="UTC" if "tz=" in dtype else None))
    same_line(index.astype(dtype), DAY)


@pytest.mark.parametrize("factor", [1e-300, 1e-33, 1e31, 1e300])
def test_plain_times_with_which_slopes_overflow_are_refused(factor: float) -> None:
    with pytest.raises(InputError, match="choose another unit") as caught:
        fit_trend(factor * np.arange(1.0, 61.0), DATA.y)
    assert caught.value.field == "t"
