"""When a trend reaches a value: the four answers, their intervals, and the forms of time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import InputError
from estimators.trends.curve import Bands, LineGeometry
from estimators.trends.questions.passage import first_passage
from tests.statistics.bounds import fewest
from tests.trends.contaminated import fitted
from tests.trends.made import daily, made_trend

T = np.arange(60.0)
RISING = fitted(T, 10.0 + 0.5 * T + np.random.default_rng(0).normal(size=60))
FLAT = fitted(T, 10.0 + np.random.default_rng(8).normal(size=60))
FALLING = fitted(T, 10.0 - 0.5 * T + np.random.default_rng(0).normal(size=60))


class Searched:
    """The same line, hidden from the closed form."""

    def __init__(self, line: LineGeometry) -> None:
        self._line = line

    @property
    def span(self) -> tuple[float, float]:
        return self._line.span

    def value(self, at: np.ndarray) -> np.ndarray:
        return self._line.value(at)

    def bands(self, at: np.ndarray, quantile: float) -> Bands:
        return self._line.bands(at, quantile)

    def in_value_units(self, unit: float) -> Searched:
        return Searched(self._line.in_value_units(unit))


def test_a_rising_trend_crosses_a_higher_value_within_an_interval_after_the_data() -> None:
    found = RISING.time_to(60.0)
    assert (found.status, found.direction) == ("crosses", "up")
    assert 59.0 < found.low < found.time < found.high
    assert RISING.predict([found.time]).value[0] == pytest.approx(60.0)


def test_the_interval_is_where_the_confidence_band_touches_the_value() -> None:
    found = FALLING.time_to(-40.0)
    bands = FALLING.predict([found.low, found.high])
    assert found.direction == "down"
    assert bands.confidence_low[0] == pytest.approx(-40.0)
    assert bands.confidence_high[1] == pytest.approx(-40.0)


def test_a_value_that_the_trend_came_from_is_passed_already_and_since_when_is_told() -> None:
    found = RISING.time_to(20.0)
    assert (found.status, found.low, found.high) == ("already", None, None)
    assert found.time == pytest.approx(20.0, abs=1.5)


def test_asked_for_the_other_direction_the_trend_never_gets_there() -> None:
    found = RISING.time_to(20.0, direction="down")
    assert (found.status, found.time, found.low, found.high) == ("never", None, None, None)


def test_a_trend_whose_slope_may_be_zero_may_never_reach_a_far_value() -> None:
    assert FLAT.p_value is not None
    assert FLAT.p_value > 0.1
    for value in (100.0, -100.0):
        found = FLAT.time_to(value)
        assert (found.status, found.high) == ("uncertain", None)
        assert found.low is not None


def test_within_the_band_of_the_level_it_is_uncertain_whether_it_is_there_already() -> None:
    at_last = float(RISING.predict([59.0]).value[0])
    for value in (at_last - 0.01, at_last + 0.01):
        found = RISING.time_to(value)
        assert found.low == 59.0
        assert found.high > 59.0
    assert RISING.time_to(at_last - 0.01).status == "uncertain"


def test_the_probability_by_a_horizon_is_one_half_where_the_trend_gets_there() -> None:
    when = RISING.time_to(60.0).time
    found = RISING.time_to(60.0, horizon=when)
    assert found.probability == pytest.approx(0.5)
    assert found.reading_probability == pytest.approx(0.5)


def test_at_the_limits_of_the_interval_the_probability_is_that_of_the_level() -> None:
    plain = RISING.time_to(60.0)
    early, late = (RISING.time_to(60.0, horizon=at) for at in (plain.low, plain.high))
    assert early.probability == pytest.approx(0.025)
    assert late.probability == pytest.approx(0.975)
    assert early.probability < early.reading_probability < 0.5


def test_for_points_in_time_the_answer_is_points_in_time() -> None:
    trend = made_trend(daily(20), np.linspace(50.0, 69.0, 20), slope=1.0 / 86400.0, level=50.0)
    found = trend.time_to(90.0, horizon="2024-03-01")
    assert found.time == np.datetime64("2024-02-10", "ns")
    assert found.horizon == np.datetime64("2024-03-01", "ns")
    assert found.low < found.time
    assert found.high is None or found.time < found.high


def test_points_in_time_and_seconds_give_the_same_answer() -> None:
    seconds = np.arange(60) * 3600
    y = 10.0 + 0.5 * T + np.random.default_rng(3).normal(size=60)
    moments = np.datetime64("2024-01-01", "ns") + seconds.astype("timedelta64[s]")
    dated, plain = fitted(moments, y).time_to(70.0), fitted(seconds, y).time_to(70.0)
    for name in ("time", "low", "high"):
        since = (getattr(dated, name) - moments[0]) / np.timedelta64(1, "s")
        assert since == pytest.approx(getattr(plain, name), rel=1e-9)


def test_without_an_uncertainty_the_trend_alone_decides() -> None:
    found = fitted([0.0, 1.0], [0.0, 1.0]).time_to(5.0, horizon=9.0)
    assert (found.status, found.low, found.high, found.probability) == ("crosses", None, None, None)
    assert found.time == pytest.approx(5.0)


def test_a_time_beyond_what_the_form_can_say_is_never() -> None:
    moments = daily(20)
    trend = fitted(moments, 50.0 + 1e-3 * np.arange(20.0))
    found = trend.time_to(1e6)
    assert (found.status, found.time) == ("never", None)


def test_a_level_of_its_own_widens_the_interval() -> None:
    narrow, wide = RISING.time_to(60.0, level=0.5), RISING.time_to(60.0, level=0.99)
    assert wide.low < narrow.low < narrow.high < wide.high
    assert (narrow.level, wide.level) == (0.5, 0.99)


def test_values_asked_for_with_the_fit_are_answered_in_their_order() -> None:
    y = 10.0 + 0.5 * T + np.random.default_rng(0).normal(size=60)
    trend = fitted(T, y, reach=[60.0, 20.0], horizon=90)
    assert trend.crossings == (trend.time_to(60.0, horizon=90), trend.time_to(20.0, horizon=90))
    told = trend.to_dict()["crossings"]
    assert [item["status"] for item in told] == ["crosses", "already"]
    assert "Reaches 60" in trend.summary()


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"value": math.nan}, "value"),
        ({"value": True}, "value"),
        ({"value": 1e61}, "value"),
        ({"value": "90"}, "value"),
        ({"value": 90.0, "horizon": 58.0}, "horizon"),
        ({"value": 90.0, "horizon": [70.0, 80.0]}, "horizon"),
        ({"value": 90.0, "horizon": math.nan}, "horizon"),
        ({"value": 90.0, "horizon": np.datetime64("2024-01-01")}, "horizon"),
        ({"value": 90.0, "level": 1.0}, "level"),
        ({"value": 90.0, "direction": "sideways"}, "direction"),
    ],
)
def test_an_argument_that_cannot_be_used_is_named(arguments: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as caught:
        RISING.time_to(**arguments)
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("arguments", "field"),
    [({"reach": "x"}, "reach"), ({"reach": [1.0] * 101}, "reach"), ({"horizon": 90.0}, "horizon")],
)
def test_questions_that_cannot_be_asked_with_the_fit_are_named(arguments: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as caught:
        fitted(T, T, **arguments)
    assert caught.value.field == field


numbers = st.floats(-5.0, 5.0)
errors = st.floats(0.01, 2.0)


@settings(deadline=None, max_examples=80)
@given(
    slope=numbers, slope_stderr=errors, level_stderr=errors, value=st.floats(-30.0, 30.0), up=st.booleans()
)
def test_the_closed_form_of_a_line_is_what_a_search_finds(
    slope: float, slope_stderr: float, level_stderr: float, value: float, up: bool
) -> None:
    line = LineGeometry(5.0, 0.0, slope, level_stderr, slope_stderr, 1.0, (0.0, 10.0))
    direction = 1.0 if up else -1.0
    for quantile in (-2.0, 0.0, 2.0):
        closed = first_passage(line, value, quantile, direction, 10.0, 1e9)
        searched = first_passage(Searched(line), value, quantile, direction, 10.0, 1e9)
        if closed is None or closed > 9000.0:
            assert searched is None or searched > 9000.0
        else:
            assert searched == pytest.approx(closed, rel=1e-6)


@settings(deadline=None, max_examples=40)
@given(factor=st.floats(1e-6, 1e6), offset=st.floats(-1e3, 1e3), flip=st.booleans())
def test_the_answer_moves_with_the_unit_and_the_zero_of_the_values(
    factor: float, offset: float, flip: bool
) -> None:
    line = LineGeometry(30.0, 25.0, 0.5, 0.13, 0.0075, 1.0, (0.0, 59.0))
    unit = -factor if flip else factor
    other = LineGeometry(
        30.0, unit * 25.0 + offset, unit * 0.5, factor * 0.13, factor * 0.0075, factor, line.span
    )
    for quantile in (-2.0, 0.0, 2.0):
        plain = first_passage(line, 60.0, quantile, 1.0, 59.0, 1e9)
        moved = first_passage(other, unit * 60.0 + offset, quantile, math.copysign(1.0, unit), 59.0, 1e9)
        assert moved == pytest.approx(plain, rel=1e-6)


def test_the_interval_holds_the_true_time_as_often_as_it_says() -> None:
    rng = np.random.default_rng(12)
    truth, draws, held = 120.0, 300, 0
    for _ in range(draws):
        y = 0.25 * T + rng.normal(size=60)
        y[rng.permutation(60)[:12]] += rng.uniform(8.0, 60.0, 12)
        found = fitted(T, y).time_to(0.25 * truth)
        held += found.low <= truth and (found.high is None or truth <= found.high)
    assert held >= fewest(draws, 0.93)


def test_probabilities_by_a_horizon_are_as_often_right_as_they_say() -> None:
    rng = np.random.default_rng(13)
    chances = [
        fitted(T, 0.02 * T + rng.normal(size=60)).time_to(2.0, horizon=100.0, direction="up").probability
        for _ in range(300)
    ]
    # The trend is exactly there at the horizon: the probability is then uniform, as a p-value is.
    assert fewest(300, 0.47) <= np.count_nonzero(np.array(chances) < 0.5) <= 300 - fewest(300, 0.47)
    assert np.count_nonzero(np.array(chances) < 0.1) <= 300 - fewest(300, 0.88)


def test_a_curve_that_turns_back_is_followed_to_where_it_first_gets() -> None:
    class Wave:
        span = (0.0, 10.0)

        def value(self, at: np.ndarray) -> np.ndarray:
            return np.sin(at) + 0.05 * at

        def bands(self, at: np.ndarray, quantile: float) -> Bands:
            value, half = self.value(at), np.full(at.size, 0.01 * quantile)
            return Bands(value, value - half, value + half, value - half, value + half)

        def in_value_units(self, unit: float) -> Wave:
            raise NotImplementedError(unit)

    found = first_passage(Wave(), 1.5, 0.0, 1.0, 10.0, 1e6)
    assert found is not None
    assert Wave().value(np.array([found]))[0] == pytest.approx(1.5)
    assert (Wave().value(np.linspace(10.0, found - 1e-6, 1000)) < 1.5).all()
