"""A second structure in the data is reported; where it is as good as the first, the answer says so."""

from __future__ import annotations

import numpy as np
import pytest

from estimators import NoticeCode
from tests.trends.contaminated import contaminated, fitted, two_lines

SEARCHING = ["auto", "ransac", "msac"]


@pytest.mark.parametrize("method", SEARCHING)
@pytest.mark.parametrize("seed", range(5))
def test_of_two_crossing_lines_the_larger_is_the_trend_and_the_other_the_runner_up(
    method: str, seed: int
) -> None:
    trend = fitted(*two_lines(200, 0.6, seed), method=method)
    assert trend.parameters["slope"].value == pytest.approx(0.5, abs=0.02)
    other = trend.runner_up
    assert other is not None
    assert other.parameters["slope"] == pytest.approx(-0.4, abs=0.05)
    assert other.parameters["intercept"] == pytest.approx(60.0, abs=2.0)
    assert 60 <= other.inliers <= 90
    assert not other.equally_good


@pytest.mark.parametrize("method", SEARCHING)
@pytest.mark.parametrize("seed", range(5))
def test_two_lines_of_equal_size_are_ambiguous(method: str, seed: int) -> None:
    trend = fitted(*two_lines(200, 0.5, seed), method=method)
    assert trend.runner_up is not None
    assert trend.runner_up.equally_good
    slopes = sorted([trend.parameters["slope"].value, trend.runner_up.parameters["slope"]])
    assert slopes == pytest.approx([-0.4, 0.5], abs=0.05)
    assert NoticeCode.ambiguous_structure in {item.code for item in trend.notices}


@pytest.mark.parametrize("method", SEARCHING)
@pytest.mark.parametrize("share", [0.0, 0.2, 0.4])
def test_a_line_among_scattered_outliers_has_no_runner_up(method: str, share: float) -> None:
    reported = [fitted(*contaminated(150, share, seed)[:2], method=method).runner_up for seed in range(12)]
    assert reported == [None] * 12


def test_a_runner_up_is_found_in_a_long_series_too() -> None:
    trend = fitted(*two_lines(20_000, 0.6))
    assert trend.runner_up is not None
    assert trend.runner_up.inliers == pytest.approx(7_600, rel=0.08)


def test_the_runner_up_is_in_the_units_of_the_answer() -> None:
    t, y = two_lines(200, 0.6)
    plain = fitted(t, y).runner_up
    moved = fitted(
        np.datetime64("2024-01-01", "ns") + (3600e9 * t).astype("timedelta64[ns]"), 10.0 * y
    ).runner_up
    assert plain is not None
    assert moved is not None
    assert moved.parameters["slope"] == pytest.approx(10.0 * plain.parameters["slope"] / 3600.0, rel=1e-6)
    assert moved.sigma == pytest.approx(10.0 * plain.sigma, rel=1e-6)
