"""pandas in, pandas out: what fit_trend takes from a frame and what it gives back as one."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from estimators import InputError, fit_trend
from tests.trends.contaminated import contaminated, fitted

DATA = contaminated(80, 0.3, 4)
DAYS = pd.date_range("2024-03-01", periods=80, freq="D")


def test_a_frame_of_one_column_is_a_series() -> None:
    series = pd.Series(DATA.y, index=DAYS, name="level")
    assert fitted(series.to_frame()).parameters == fitted(series).parameters


def test_times_and_values_may_each_be_a_frame_of_one_column() -> None:
    frame = pd.DataFrame({"t": DATA.t, "y": DATA.y})
    assert fitted(frame[["t"]], frame[["y"]]).parameters == fitted(frame["t"], frame["y"]).parameters


def test_a_frame_of_several_columns_is_refused_by_name() -> None:
    frame = pd.DataFrame(dict.fromkeys("abcdefg", DATA.y), index=DAYS)
    with pytest.raises(InputError, match=r"the frame has 7 \('a', 'b', 'c', 'd', 'e', \.\.\.\)") as caught:
        fit_trend(frame)
    assert caught.value.field == "y"
    with pytest.raises(InputError, match=r"the frame has 2 \('a', 'b'\)") as caught:
        fit_trend(frame[["a", "b"]], DATA.y)
    assert caught.value.field == "t"


def test_a_frame_without_columns_is_refused() -> None:
    with pytest.raises(InputError, match="the frame has 0"):
        fit_trend(pd.DataFrame(index=DAYS))


def test_missing_values_of_a_frame_are_missing_rows() -> None:
    frame = pd.DataFrame({"level": DATA.y}, index=DAYS).astype("Float64")
    frame.iloc[[3, 40]] = pd.NA
    trend = fitted(frame)
    assert [row for row, reason in enumerate(trend.points.reason) if reason == "missing"] == [3, 40]


def test_the_frame_that_comes_out_has_the_rows_that_went_in() -> None:
    shuffled = pd.Series(DATA.y, index=DAYS).sample(frac=1.0, random_state=0)
    rows = fitted(shuffled).to_frame()
    np.testing.assert_array_equal(rows["time"], shuffled.index)
    np.testing.assert_array_equal(rows["value"], shuffled)
    np.testing.assert_allclose(rows["value"] - rows["fit"], rows["residual"], atol=1e-12)
    assert list(rows["inlier"]) == [reason == "ok" for reason in rows["reason"]]
