"""Two slopes against one another, and slopes per unit of time."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy.stats import ttest_ind_from_stats

from estimators import InputError, Trend
from estimators.result import Estimate, Uncertainty
from tests.statistics.bounds import fewest, most
from tests.trends.contaminated import fitted
from tests.trends.made import daily, made_trend

T = np.arange(40.0)


def with_slope(value: float, stderr: float, dof: float) -> Trend:
    """Trend whose slope is known to a given accuracy."""
    trend = made_trend(T, T, slope=1.0, level=0.0)
    estimate = Estimate(value, stderr, None, None)
    return dataclasses.replace(
        trend,
        parameters=trend.parameters | {"slope": estimate},
        uncertainty=Uncertainty("effective-n", 0.95, 10.0, 0.0, dof),
    )


def test_the_test_is_welch_s() -> None:
    # Two samples of 8 and 15 have means with 7 and 14 degrees of freedom.
    ours = with_slope(1.3, 0.2, 7.0).differs_from(with_slope(0.8, 0.1, 14.0))
    theirs = ttest_ind_from_stats(1.3, 0.2 * math.sqrt(8), 8, 0.8, 0.1 * math.sqrt(15), 15, equal_var=False)
    assert ours.p_value == pytest.approx(theirs.pvalue)
    assert ours.slope.value == pytest.approx(0.5)
    assert ours.slope.stderr == pytest.approx(math.hypot(0.2, 0.1))


def test_the_interval_leaves_out_zero_where_the_p_value_is_below_one_minus_the_level() -> None:
    one, other = with_slope(1.3, 0.2, 7.0), with_slope(0.8, 0.1, 14.0)
    loose, strict = one.differs_from(other, level=0.9), one.differs_from(other, level=0.99)
    assert loose.slope.low > 0.0 > strict.slope.low
    assert (loose.is_significant, strict.is_significant) == (True, False)


def test_turned_round_the_difference_changes_its_sign() -> None:
    one, other = with_slope(1.3, 0.2, 7.0), with_slope(0.8, 0.1, 14.0)
    forth, back = one.differs_from(other), other.differs_from(one)
    assert (forth.slope.value, forth.p_value) == (-back.slope.value, back.p_value)
    assert (forth.slope.low, forth.slope.high) == (-back.slope.high, -back.slope.low)


def test_equal_slopes_are_called_different_as_rarely_as_the_level_says() -> None:
    rng = np.random.default_rng(5)

    def drawn(slope: float) -> Trend:
        y = slope * T + rng.normal(size=40)
        y[rng.permutation(40)[:8]] += 30.0
        return fitted(T, y)

    same = sum(drawn(0.1).differs_from(drawn(0.1)).is_significant for _ in range(150))
    other = sum(drawn(0.1).differs_from(drawn(0.25)).is_significant for _ in range(40))
    assert same <= most(150, 0.07)
    assert other >= fewest(40, 0.9)


def test_without_an_uncertainty_there_is_a_difference_and_no_test() -> None:
    pair = fitted([0.0, 1.0], [0.0, 2.0])
    found = pair.differs_from(with_slope(0.5, 0.1, 9.0))
    assert found.slope == Estimate(1.5, None, None, None)
    assert (found.p_value, found.is_significant) == (None, False)


def test_the_difference_is_json_safe() -> None:
    told = with_slope(1.0, 0.1, math.inf).differs_from(with_slope(0.5, 0.1, math.inf)).to_dict()
    assert told["dof"] is None
    assert told["slope"]["value"] == pytest.approx(0.5)


def test_trends_on_different_kinds_of_time_are_refused() -> None:
    dated = made_trend(daily(20), np.arange(20.0), slope=1e-5, level=0.0)
    with pytest.raises(InputError, match="another kind"):
        dated.differs_from(with_slope(1.0, 0.1, 9.0))
    with pytest.raises(InputError) as caught:
        dated.differs_from("last week")  # type: ignore[arg-type]
    assert caught.value.field == "other"


def test_the_slope_is_told_per_unit_of_time() -> None:
    trend = made_trend(daily(20), np.arange(20.0), slope=1.0 / 86400.0, level=0.0)
    told = {unit: trend.slope_per(unit).value for unit in ("second", "minute", "hour", "day", "week", "year")}
    assert told == pytest.approx(
        {"second": 1 / 86400, "minute": 1 / 1440, "hour": 1 / 24, "day": 1.0, "week": 7.0, "year": 365.25}
    )
    assert trend.slope_per() == trend.slope_per("day")
    assert trend.to_dict()["slope_per"]["unit"] == "day"
    assert trend.to_dict()["slope_per"]["value"] == pytest.approx(1.0)


def test_plain_numbers_have_one_unit_that_nobody_named() -> None:
    trend = made_trend(T, T, slope=1.5, level=0.0)
    assert trend.slope_per() == trend.parameters["slope"]
    assert trend.to_dict()["slope_per"]["unit"] is None
    with pytest.raises(InputError) as caught:
        trend.slope_per("day")
    assert caught.value.field == "unit"


def test_an_unknown_unit_is_named_with_the_known_ones() -> None:
    trend = made_trend(daily(20), np.arange(20.0), slope=1e-5, level=0.0)
    with pytest.raises(InputError, match="known: second, minute, hour, day, week, year"):
        trend.slope_per("fortnight")
