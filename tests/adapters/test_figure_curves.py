"""Where curves are looked at: a picture of a season is not another season, and a line is two points."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators.adapters.figure_curves import TOLERANCE_PX, drawn_rows, fine_times
from estimators.adapters.figure_sheet import PALETTES, Sheet
from estimators.adapters.plotting import render, trend_figure
from estimators.arrays import FloatArray
from estimators.trends.bases.design import Season
from estimators.trends.trend import Trend
from tests.trends.made import made_trend


@dataclasses.dataclass(frozen=True)
class Wave:
    """A curve that is a season of amplitude 10, known at any time."""

    period: float
    span: tuple[float, float]

    def value(self, at: FloatArray) -> FloatArray:
        return np.asarray(10.0 * np.sin(2.0 * np.pi * at / self.period))


def seasonal(cycles: float, count: int = 400) -> Trend:
    trend = made_trend(np.linspace(0.0, 100.0, count), np.zeros(count), slope=0.0, level=0.0)
    return dataclasses.replace(trend, seasons=(Season(100.0 / cycles, 1),))


@pytest.mark.parametrize("cycles", [3, 40, 128, 300])
def test_every_cycle_of_a_season_is_drawn(cycles: int) -> None:
    trend = seasonal(cycles)
    at = fine_times(trend, 800)
    value = Wave(100.0 / cycles, (0.0, 100.0)).value(at)
    drawn = value[drawn_rows(at, np.vstack([value] * 5), (0.0, 100.0), 800)]
    tops = (drawn[1:-1] > 9.0) & (drawn[1:-1] >= drawn[:-2]) & (drawn[1:-1] > drawn[2:])
    assert np.count_nonzero(tops) == cycles


def test_seasons_too_fine_for_the_pixels_fill_what_they_sweep_with_few_points() -> None:
    at = fine_times(seasonal(5000), 800)
    value = Wave(0.02, (0.0, 100.0)).value(at)
    rows = drawn_rows(at, np.vstack([value] * 5), (0.0, 100.0), 800)
    assert rows.size <= 2 * 800 + 4
    column = np.minimum((at[rows] / 100.0 * 800).astype(int), 799)
    for extreme in (np.minimum, np.maximum):
        reached = np.zeros(800)
        extreme.at(reached, column, value[rows])
        assert np.abs(reached).min() > 9.5


def test_a_straight_line_without_bands_is_drawn_with_its_corners_only() -> None:
    at = np.linspace(-5.0, 20.0, 900)
    straight = np.vstack([3.0 * at, *np.full((4, 900), np.nan)])
    rows = drawn_rows(at, straight, (float(at[100]), float(at[600])), 800)
    assert rows.tolist() == [0, 100, 600, 899]


@given(st.integers(0, 1000))
def test_strokes_between_the_rows_drawn_miss_no_curve_by_more_than_the_tolerance(seed: int) -> None:
    rng = np.random.default_rng(seed)
    at = np.sort(rng.uniform(0.0, 10.0, 300))
    curves = rng.uniform(-40.0, 40.0, (5, 4)) @ np.vstack([np.ones(300), at, np.sin(at), np.exp(at / 3.0)])
    rows = drawn_rows(at, curves, (float(at[0]), float(at[-1])), 300)
    for curve in curves:
        assert np.abs(np.interp(at, at[rows], curve[rows]) - curve).max() <= TOLERANCE_PX * (1.0 + 1e-9)


def test_a_single_time_can_be_drawn() -> None:
    trend = made_trend([3.0, 3.0, 3.0], [1.0, 1.1, 0.9], slope=0.0, level=1.0)
    assert render(trend_figure(trend), "svg")


def test_predictions_on_either_side_are_drawn_to_their_ends() -> None:
    trend = made_trend(np.arange(50.0), np.arange(50.0), slope=1.0, level=0.0, predict=[-10.0, 70.0])
    time = Sheet.of(trend, PALETTES["light"], 800, 450).curves.time
    assert (time[0], time[-1]) == (-10.0, 70.0)
    assert {0.0, 49.0} <= set(time.tolist())


def test_the_picture_of_a_line_is_small() -> None:
    trend = made_trend(np.arange(50.0), np.arange(50.0), slope=1.0, level=0.0)
    assert len(render(trend_figure(trend, width_px=2000), "svg")) < 40_000
