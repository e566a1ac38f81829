from __future__ import annotations

import json

import numpy as np
import pandas as pd
from hypothesis import given
from hypothesis import strategies as st

from estimators.notices import NoticeCode, notice
from estimators.trends.presentation.dictionary import fitted_values
from estimators.trends.presentation.json_values import iso_utc, time_to_json
from estimators.trends.trend import RunnerUp
from tests.trends.made import daily, made_trend

NANOSECONDS = st.integers(-(2**62), 2**62)


@given(st.lists(NANOSECONDS, min_size=1, max_size=20))
def test_points_in_time_come_back_from_their_text_to_the_nanosecond(ticks: list[int]) -> None:
    moments = np.array(ticks, dtype="datetime64[ns]")
    texts = time_to_json(moments)
    assert all(text.endswith("Z") for text in texts)
    back = np.array([text[:-1] for text in texts], dtype="datetime64[ns]")
    np.testing.assert_array_equal(back, moments)


@given(st.lists(st.integers(-(2**31), 2**33), min_size=1, max_size=20))
def test_whole_seconds_are_written_without_a_fraction(seconds: list[int]) -> None:
    moments = np.array(seconds, dtype="datetime64[s]").astype("datetime64[ns]")
    assert time_to_json(moments) == [iso_utc(moment) for moment in moments]
    assert not any("." in text for text in time_to_json(moments))


def test_missing_times_are_null() -> None:
    assert time_to_json(np.array(["2024-01-01", "NaT"], dtype="datetime64[ns]")) == [
        "2024-01-01T00:00:00Z",
        None,
    ]
    assert time_to_json(np.array([1.0, np.nan, np.inf])) == [1.0, None, None]


def test_integer_times_stay_exact() -> None:
    assert time_to_json(np.array([2**62 + 1], dtype=np.int64)) == [2**62 + 1]


def test_the_dict_is_strict_json_even_with_missing_rows_and_no_uncertainty() -> None:
    trend = made_trend(
        [0.0, np.nan, 2.0, np.inf], [1.0, 2.0, np.nan, 4.0], slope=1.0, level=1.0, dof=None, predict=[9.0]
    )
    answer = trend.to_dict()
    assert json.loads(json.dumps(answer, allow_nan=False)) == answer
    assert answer["parameters"]["slope"]["stderr"] is None
    assert answer["prediction"]["confidence_low"] == [None]
    assert answer["points"]["time"] == [0.0, None, 2.0, None]


def test_the_dict_has_one_entry_per_row_in_every_column() -> None:
    trend = made_trend(daily(5), [1.0, 2.0, np.nan, 40.0, 5.0], slope=1 / 86400, level=1.0, outliers=(3,))
    points = trend.to_dict()["points"]
    assert {name: len(column) for name, column in points.items()} == dict.fromkeys(
        ("time", "fit", "inlier", "probability", "residual", "reason"), 5
    )
    assert points["reason"] == ["ok", "ok", "missing", "outlier", "ok"]


def test_the_columns_can_be_left_out_of_the_dict() -> None:
    assert "points" not in made_trend([0.0, 1.0, 2.0], [0.0, 1.0, 2.0], slope=1.0, level=0.0).to_dict(
        points=False
    )


def test_the_dict_carries_runner_up_prediction_and_notices() -> None:
    trend = made_trend(
        [0.0, 1.0, 2.0],
        [0.0, 1.0, 2.0],
        slope=1.0,
        level=0.0,
        runner_up=RunnerUp({"slope": 2.0, "intercept": 5.0}, 7, 0.1, True),
        notices=(notice(NoticeCode.missing_values, count=3),),
        predict=[3.0],
    )
    answer = trend.to_dict()
    assert answer["runner_up"] == {
        "parameters": {"slope": 2.0, "intercept": 5.0},
        "inliers": 7,
        "sigma": 0.1,
        "equally_good": True,
    }
    assert answer["prediction"]["value"] == [3.0]
    assert answer["notices"][0]["code"] == "missing_values"
    assert answer["notices"][0]["detail"] == {"count": 3}


def test_the_fit_is_known_wherever_the_time_is() -> None:
    trend = made_trend([0.0, 1.0, np.nan, 3.0, np.inf], [1.0, np.nan, 3.0, 7.0, 1.0], slope=2.0, level=1.0)
    np.testing.assert_allclose(fitted_values(trend), [1.0, 3.0, np.nan, 7.0, np.nan])


def test_the_frame_has_one_row_per_input_row_and_keeps_datetimes() -> None:
    time = daily(5)
    time[1] = np.datetime64("NaT")
    frame = made_trend(
        time, [1.0, 2.0, np.nan, 40.0, 5.0], slope=1 / 86400, level=1.0, outliers=(3,)
    ).to_frame()
    assert list(frame.columns) == [
        "time",
        "value",
        "fit",
        "confidence_low",
        "confidence_high",
        "prediction_low",
        "prediction_high",
        "inlier",
        "probability",
        "residual",
        "reason",
    ]
    assert isinstance(frame.index, pd.RangeIndex)
    assert frame["time"].dtype == "datetime64[ns]"
    assert frame["reason"].tolist() == ["ok", "missing", "missing", "outlier", "ok"]
    assert frame["fit"].isna().tolist() == [False, True, False, False, False]
    assert frame["residual"].isna().tolist() == [False, True, True, False, False]


def test_the_frame_holds_the_bands_of_predict() -> None:
    trend = made_trend([0.0, 1.0, 2.0, 3.0], [1.0, 3.0, 5.0, 7.0], slope=2.0, level=1.0)
    frame, bands = trend.to_frame(), trend.predict([0.0, 1.0, 2.0, 3.0])
    for name in ("confidence_low", "confidence_high", "prediction_low", "prediction_high"):
        np.testing.assert_array_equal(frame[name], getattr(bands, name))
    assert (frame["prediction_high"] > frame["confidence_high"]).all()


def test_the_frame_of_two_points_has_no_bands() -> None:
    frame = made_trend([0.0, 1.0], [1.0, 3.0], slope=2.0, level=1.0, dof=None).to_frame()
    assert frame["confidence_low"].isna().all()
    assert frame["fit"].tolist() == [1.0, 3.0]
