"""The trend at other times, and how sure it is."""

from __future__ import annotations

import datetime as dt
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import InputError, NoticeCode
from tests.trends.contaminated import contaminated, fitted

DATA = contaminated(60, seed=17)
NUMBERS = fitted(DATA.t, DATA.y)
DATES = fitted(np.datetime64("2024-01-01") + np.arange(60), DATA.y)
EPOCH = fitted(1_700_000_000_000_000_000 + 10**9 * np.arange(60), DATA.y)
APRIL = np.datetime64("2024-04-01", "ns")


@settings(max_examples=100, deadline=None)
@given(time=st.floats(-1e6, 1e6), level=st.floats(0.01, 0.999))
def test_the_bands_contain_the_trend_and_the_one_of_a_reading_is_the_wider(time: float, level: float) -> None:
    bands = NUMBERS.predict([time], level)
    slope, intercept = (NUMBERS.parameters[name].value for name in ("slope", "intercept"))
    assert bands.value[0] == pytest.approx(intercept + slope * time, rel=1e-9, abs=1e-9)
    assert bands.prediction_low[0] < bands.confidence_low[0] < bands.value[0]
    assert bands.value[0] < bands.confidence_high[0] < bands.prediction_high[0]


def test_the_band_of_the_trend_is_narrowest_amid_the_data() -> None:
    bands = NUMBERS.predict([-100.0, 50.0, 200.0])
    width = bands.confidence_high - bands.confidence_low
    assert width[1] < min(width[0], width[2])


def test_the_level_is_that_of_the_fit_unless_another_is_asked_for() -> None:
    wide, narrow = NUMBERS.predict([50.0]), NUMBERS.predict([50.0], 0.5)
    assert (wide.level, narrow.level) == (0.95, 0.5)
    assert narrow.confidence_high[0] < wide.confidence_high[0]


def test_at_the_origin_the_band_is_the_interval_of_the_intercept() -> None:
    bands, intercept = NUMBERS.predict([0.0]), NUMBERS.parameters["intercept"]
    assert (bands.confidence_low[0], bands.confidence_high[0]) == pytest.approx(
        (intercept.low, intercept.high)
    )


def test_times_outside_of_the_data_are_counted_in_a_notice() -> None:
    assert NUMBERS.predict([DATA.t[0], 50.0, DATA.t[-1]]).notices == ()
    notices = NUMBERS.predict([-1.0, 50.0, 101.0]).notices
    assert [(item.code, item.detail) for item in notices] == [(NoticeCode.extrapolation, {"times": 2})]


def test_two_points_predict_a_line_without_bands() -> None:
    bands = fitted([0.0, 1.0], [1.0, 3.0]).predict([2.0])
    assert bands.value[0] == pytest.approx(5.0)
    assert np.isnan([bands.confidence_low[0], bands.prediction_high[0]]).all()


@pytest.mark.parametrize(
    "times",
    [
        APRIL,
        [APRIL],
        dt.datetime(2024, 4, 1),
        [dt.date(2024, 4, 1)],
        "2024-04-01",
        ["2024-04-01T00:00:00Z"],
        ["2024-04-01T02:00:00+02:00"],
        pd.Timestamp("2024-04-01"),
        pd.DatetimeIndex(["2024-03-31T20:00"], tz="America/New_York"),
        pd.Series(pd.DatetimeIndex(["2024-04-01"])),
    ],
)
def test_moments_may_be_written_in_any_way(times: Any) -> None:
    bands = DATES.predict(times)
    assert bands.time.tolist() == [APRIL.astype(np.int64)]
    assert bands.value[0] == DATES.predict([APRIL]).value[0]


@pytest.mark.parametrize(
    "times", [70, 70.0, np.int32(70), [70], (70.0,), pd.Series([70]), pd.array([70], dtype="Int64")]
)
def test_numbers_may_be_written_in_any_way(times: Any) -> None:
    assert NUMBERS.predict(times).value.tolist() == NUMBERS.predict([70.0]).value.tolist()


def test_integer_epochs_are_predicted_at_exactly() -> None:
    last = 1_700_000_000_000_000_000 + 59 * 10**9
    near, next_one = EPOCH.predict([last, last + 1]).value
    assert next_one - near == pytest.approx(EPOCH.parameters["slope"].value, rel=1e-4)


def test_a_missing_time_has_no_prediction() -> None:
    assert np.isnan(NUMBERS.predict([None, 5.0]).value).tolist() == [True, False]
    assert np.isnan(DATES.predict([None, "2024-04-01"]).value).tolist() == [True, False]
    assert np.isnan(NUMBERS.predict(pd.array([None, 5], dtype="Int64")).value).tolist() == [True, False]


def test_no_times_have_no_predictions() -> None:
    assert NUMBERS.predict([]).value.size == 0
    assert DATES.predict([]).value.size == 0


@pytest.mark.parametrize(
    ("trend", "times"),
    [
        (NUMBERS, ["2024-04-01"]),
        (NUMBERS, ["70"]),
        (NUMBERS, [APRIL]),
        (NUMBERS, [dt.datetime(2024, 4, 1)]),
        (NUMBERS, [np.inf]),
        (NUMBERS, [1e31]),
        (NUMBERS, [True]),
        (NUMBERS, [[1.0, 2.0]]),
        (DATES, [5.0]),
        (DATES, ["soon"]),
        (DATES, ["3000-01-01"]),
        (DATES, [dt.datetime(3000, 1, 1)]),
        (DATES, np.array(["3000-01-01"], dtype="datetime64[D]")),
    ],
)
def test_times_of_another_kind_or_beyond_all_bounds_are_refused(trend: Any, times: Any) -> None:
    with pytest.raises(InputError) as caught:
        trend.predict(times)
    assert caught.value.field == "t"


@pytest.mark.parametrize("level", [0.0, 1.0, -3.0, 2.0])
def test_a_level_that_is_none_is_refused(level: float) -> None:
    with pytest.raises(InputError, match="level"):
        NUMBERS.predict([1.0], level)


def test_predictions_can_be_asked_for_with_the_fit() -> None:
    trend = fitted(DATA.t, DATA.y, predict=[120.0], level=0.9)
    assert trend.prediction is not None
    assert trend.prediction.level == 0.9
    assert trend.prediction.to_dict() == trend.predict([120.0]).to_dict()


def test_readings_to_come_fall_into_the_prediction_band_as_often_as_it_says() -> None:
    inside = 0
    for seed in range(100):
        data = contaminated(60, 0.25, seed)
        bands = fitted(data.t, data.y).predict(np.linspace(0.0, 130.0, 20))
        reading = 3.0 + 0.5 * bands.time + np.random.default_rng(seed).normal(size=20)
        inside += np.count_nonzero((bands.prediction_low <= reading) & (reading <= bands.prediction_high))
    # 2,000 readings; those of one series share its line, so the bounds are a little wider than binomial.
    assert 0.92 <= inside / 2000 <= 0.985
