"""The present regime: found where there is one, not seen where there is none, and fitted like any series."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from benchmarks.regimes import Cell, measure
from estimators import InputError, NoFit, Trend, fit_trend
from estimators.trends.regimes.path import cheapest_path
from tests.statistics.bounds import fewest, most
from tests.trends.contaminated import fitted

RNG = np.random.default_rng(4)
T = np.arange(200.0)
NOISE = RNG.normal(size=200)
JUMP = np.where(T < 120, 0.5 * T, 0.2 * (T - 120)) + NOISE
SPIKED = JUMP + np.where(np.arange(200) % 7 == 3, 25.0, 0.0)


def starts(trend: Trend) -> list[float]:
    return [float(regime.start) for regime in trend.regimes]


def test_the_last_regime_is_fitted_and_the_earlier_one_is_listed() -> None:
    trend = fitted(T, SPIKED, regime="last")
    assert starts(trend) == [0.0, 120.0]
    earlier, present = trend.regimes
    assert earlier.slope.low < 0.5 < earlier.slope.high
    assert present.slope == trend.parameters["slope"]
    assert trend.parameters["slope"].low < 0.2 < trend.parameters["slope"].high
    assert present.level.value == pytest.approx(0.2 * 79, abs=1.0)


def test_it_is_the_fit_of_the_rows_of_the_last_regime_alone() -> None:
    trend, alone = fitted(T, SPIKED, regime="last"), fitted(T[120:], SPIKED[120:])
    assert trend.parameters["slope"].value == pytest.approx(alone.parameters["slope"].value, rel=1e-9)
    np.testing.assert_array_equal(trend.points.inlier[120:], alone.points.inlier)
    assert trend.consensus.n == 80


def test_rows_before_it_take_no_part_and_say_so() -> None:
    trend = fitted(T, SPIKED, regime="last")
    assert set(trend.points.reason[:120]) == {"earlier_regime"}
    assert not trend.points.inlier[:120].any()
    assert np.isnan(trend.points.residual[:120]).all()
    assert [item.code for item in trend.notices] == ["earlier_regimes"]
    assert "the present one since 120" in " ".join(trend.summary().split())


def test_a_series_of_one_regime_is_answered_as_without_the_question() -> None:
    y = 3.0 + 0.5 * T + NOISE
    asked, plain = fitted(T, y, regime="last"), fitted(T, y)
    assert starts(asked) == [0.0]
    told = asked.to_dict()
    assert len(told.pop("regimes")) == 1
    assert told == plain.to_dict()


def test_an_excursion_that_comes_back_is_no_regime() -> None:
    y = 0.1 * T + NOISE
    y[80:120] += 30.0
    assert starts(fitted(T, y, regime="last")) == [0.0]


def test_an_excursion_that_has_not_come_back_is_the_present_regime() -> None:
    y = 0.1 * T + NOISE
    y[160:] += 30.0
    assert starts(fitted(T, y, regime="last")) == [0.0, 160.0]


def test_scattered_errors_at_the_end_are_no_regime() -> None:
    y = 0.1 * T + NOISE
    y[160:] = RNG.uniform(-60.0, 60.0, 40)
    assert starts(fitted(T, y, regime="last")) == [0.0]


def test_a_change_of_slope_without_a_jump_is_found() -> None:
    y = np.where(T < 100, 0.0, 0.3 * (T - 100)) + NOISE
    found = starts(fitted(T, y, regime="last"))
    assert len(found) == 2
    assert found[1] == pytest.approx(100.0, abs=12.0)


def test_a_disk_that_is_emptied_every_day_has_filled_since_the_last_time() -> None:
    y = 20.0 * (T % 40) / 40 + NOISE
    trend = fitted(T, y, regime="last", reach=30.0)
    assert starts(trend) == [0.0, 40.0, 80.0, 120.0, 160.0]
    assert trend.parameters["slope"].low < 0.5 < trend.parameters["slope"].high
    assert trend.crossings[0].low < 220.0 < trend.crossings[0].high


def test_times_and_gaps_do_not_matter_and_rows_may_come_in_any_order() -> None:
    order = RNG.permutation(200)
    moments = np.datetime64("2024-01-01", "ns") + (T * 3.6e12).astype("timedelta64[ns]")
    y = SPIKED.copy()
    y[50] = np.nan
    trend = fitted(moments[order], y[order], regime="last")
    assert [regime.start for regime in trend.regimes] == [moments[0], moments[120]]
    assert trend.to_dict()["regimes"][1]["start"] == "2024-01-06T00:00:00Z"
    reasons = np.array(trend.points.reason)[np.argsort(order)]
    assert set(np.flatnonzero(reasons == "earlier_regime")) == set(range(120)) - {50}


@pytest.mark.parametrize("factor", [1e-290, 1e-9, 1e9])
def test_the_regimes_do_not_depend_on_the_unit_of_the_values(factor: float) -> None:
    plain, other = fitted(T, SPIKED, regime="last"), fitted(T, SPIKED * factor, regime="last")
    assert starts(other) == starts(plain)
    for one, two in zip(plain.regimes, other.regimes, strict=True):
        assert two.level.value == pytest.approx(one.level.value * factor, rel=1e-6)


def test_points_of_weight_zero_and_small_weights_do_not_make_a_regime() -> None:
    y = 0.1 * T + NOISE
    y[150:] += 30.0
    weights = np.where(T < 150, 1.0, 1e-6)
    assert starts(fitted(T, y, regime="last", weights=weights)) == [0.0]
    assert starts(fitted(T, y, regime="last", weights=np.where(T < 150, 1.0, 0.0))) == [0.0]


def test_a_season_is_no_change_of_regime_for_a_trend_that_has_one() -> None:
    y = 0.05 * T + 10.0 * np.sin(2 * np.pi * T / 50) + NOISE
    season = fitted(T, y, regime="last", seasonal=[50.0])
    assert starts(season) == [0.0]
    y[140:] -= 40.0
    assert starts(fitted(T, y, regime="last", seasonal=[50.0])) == [0.0, 140.0]


def test_values_without_noise_change_where_they_change() -> None:
    exact = np.where(T < 77, 3.0, 5.0 + 0.25 * T)
    assert starts(fitted(T, exact, regime="last")) == [0.0, 77.0]
    assert starts(fitted(T, 3.0 + T, regime="last")) == [0.0]


def test_a_long_series_is_cut_to_the_reading() -> None:
    n = 20_000
    t = np.arange(float(n))
    y = np.where(t < 13_337, 0.001 * t, -5.0) + np.random.default_rng(2).normal(size=n)
    assert starts(fitted(t, y, regime="last"))[1] == pytest.approx(13_337, abs=2)


@pytest.mark.parametrize("n", [1, 2, 3, 12, 19])
def test_a_short_series_has_one_regime(n: int) -> None:
    answer = fit_trend(T[:n], JUMP[:n], regime="last")
    assert isinstance(answer, NoFit) if n == 1 else starts(answer) == [0.0]


def test_the_same_series_gives_the_same_answer_twice() -> None:
    assert fitted(T, SPIKED, regime="last").to_dict() == fitted(T, SPIKED, regime="last").to_dict()


def test_an_unknown_regime_is_named() -> None:
    with pytest.raises(InputError, match="did you mean 'last'"):
        fit_trend(T, JUMP, regime="lasts")


def test_the_cheapest_path_is_the_cheapest_of_all() -> None:
    loss = np.random.default_rng(3).exponential(size=(7, 3))

    def cost(path: tuple[int, ...]) -> float:
        changes = sum(one != other for one, other in itertools.pairwise(path))
        return float(sum(loss[row, line] for row, line in enumerate(path))) + 0.7 * changes

    ways = (tuple(int(digit) for digit in np.base_repr(k, 3).zfill(7)) for k in range(3**7))
    assert tuple(cheapest_path(loss, 0.7).tolist()) == min(ways, key=cost)


@pytest.mark.parametrize("share", [0.0, 0.2, 0.4])
@pytest.mark.parametrize("kind", ["uniform", "shift", "t2", "returning", "ar1_0.5"])
def test_one_line_is_one_regime(kind: str, share: float) -> None:
    outcomes = [measure(Cell(kind, n, share, draws), seed=6) for n, draws in ((100, 30), (200, 20))]
    assert sum(outcome.several for outcome in outcomes) <= most(50, 0.05)


@pytest.mark.parametrize(("kind", "n", "share", "least"), [
    ("jump", 100, 0.0, 0.97),
    ("jump", 200, 0.2, 0.97),
    ("jump", 200, 0.4, 0.85),
    ("bend", 200, 0.2, 0.9),
    ("sawtooth", 200, 0.2, 0.95),
])  # fmt: skip
def test_changes_of_five_sigma_and_more_are_found(kind: str, n: int, share: float, least: float) -> None:
    outcome = measure(Cell(kind, n, share, 25), seed=7)
    assert outcome.several >= fewest(25, least)
    assert outcome.placed >= fewest(25, least) if kind != "bend" else outcome.placed > 0
