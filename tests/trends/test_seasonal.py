"""Trend and seasons fitted together."""

import datetime as dt
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from estimators import InputError, NoFit, Trend, fit_trend
from estimators.arrays import FloatArray
from estimators.trends.bases.design import Season

RNG = np.random.default_rng(21)
T = np.arange(240.0)
NOISE = RNG.normal(size=240)
WAVE = 3.0 * np.cos(2.0 * np.pi * (T - 4.0) / 12.0)
SPIKES = np.where(RNG.permutation(240) < 48, RNG.uniform(-60.0, 60.0, 240), 0.0)
DAYS = np.datetime64("2015-01-01") + (T * 7.0).astype("timedelta64[D]")


def fitted(t: object, y: object, **arguments: object) -> Trend:
    trend = fit_trend(t, y, **arguments)  # type: ignore[arg-type]
    assert isinstance(trend, Trend)
    return trend


def test_a_given_season_is_neither_trend_nor_outlier() -> None:
    trend = fitted(T, 1.0 + 0.05 * T + WAVE + NOISE + SPIKES, seasonal=12)
    assert trend.model == "line"
    for name, truth in (("slope", 0.05), ("season_1_amplitude", 3.0), ("season_1_peak", 4.0)):
        estimate = trend.parameters[name]
        assert estimate.stderr is not None
        assert abs(estimate.value - truth) < 3.5 * estimate.stderr, name
        assert estimate.stderr < 0.15
    assert trend.consensus.sigma == pytest.approx(1.0, abs=0.15)
    assert trend.consensus.inliers == pytest.approx(192, abs=6)


def test_predictions_include_the_season() -> None:
    trend = fitted(T, 0.05 * T + WAVE + NOISE, seasonal=[12])
    ahead = np.arange(240.0, 264.0)
    truth = 0.05 * ahead + 3.0 * np.cos(2.0 * np.pi * (ahead - 4.0) / 12.0)
    assert np.abs(trend.predict(ahead).value - truth).max() < 0.8


def test_a_level_and_a_parabola_take_seasons_too() -> None:
    level = fitted(T, 7.0 + WAVE + NOISE + SPIKES, model="constant", seasonal=12)
    assert level.parameters["level"].value == pytest.approx(7.0, abs=0.3)
    curve = fitted(T, 0.001 * T**2 + WAVE + NOISE, model="linear", degree=2, seasonal=12)
    assert curve.parameters["power_2"].value == pytest.approx(0.001, abs=1e-4)


def test_a_season_that_is_no_sine_is_given_the_harmonics_it_needs() -> None:
    sharp = 8.0 * (T % 12.0 < 2.0)
    trend = fitted(T, 0.05 * T + sharp + 0.3 * NOISE, seasonal=12)
    assert trend.seasons[0].harmonics >= 4
    assert fitted(T, 0.05 * T + WAVE + NOISE, seasonal=12).seasons == (Season(12.0, 2),)
    assert fitted(T, 0.05 * T + WAVE + NOISE, seasonal=12, harmonics=1).seasons == (Season(12.0, 1),)


@pytest.mark.parametrize(
    "period", ["year", np.timedelta64(31557600, "s"), dt.timedelta(days=365.25), 31557600]
)
def test_a_period_may_be_a_name_a_timedelta_or_seconds(period: object) -> None:
    turns = (DAYS - DAYS[0]) / np.timedelta64(31557600, "s")
    y = 2.0 * np.sin(2.0 * np.pi * turns) + 0.2 * NOISE
    trend = fitted(DAYS, y, seasonal=period)
    assert trend.seasons[0].period == pytest.approx(365.25 * 86400.0)
    assert trend.parameters["season_1_amplitude"].value == pytest.approx(2.0, abs=0.1)
    assert trend.parameters["season_1_peak"].value == pytest.approx(0.25 * 31557600.0, rel=0.05)
    assert "season of 1 year" in trend.summary()


@pytest.mark.parametrize(
    ("seasonal", "says"),
    [
        (500.0, "longer than the series"),
        ([12, 12], "given twice"),
        ("year", "needs points in time"),
        ("fortnight", "unknown period"),
        (0.0, "must lie between"),
        (-3.0, "must lie between"),
        (True, "must be a number"),
        ([], "one to 4 periods"),
        (object(), "expected periods"),
    ],
)
def test_periods_that_cannot_be_fitted_are_refused(seasonal: object, says: str) -> None:
    with pytest.raises(InputError, match=says) as caught:
        fitted(T, NOISE, seasonal=seasonal)
    assert caught.value.field == "seasonal"


def test_a_shape_without_seasons_refuses_them() -> None:
    with pytest.raises(InputError, match="no meaning for the model exponential"):
        fitted(T, np.exp(0.01 * T), model="exponential", seasonal=12)


def test_a_period_that_the_sampling_does_not_resolve_is_no_fit() -> None:
    refused = fit_trend(T, NOISE, seasonal=1.0)
    assert isinstance(refused, NoFit)
    assert "longer periods" in refused.message


def test_auto_finds_the_period_among_outliers_and_gaps() -> None:
    kept = RNG.permutation(240)[:200]
    trend = fitted(T[kept], (0.05 * T + WAVE + NOISE + SPIKES)[kept], seasonal="auto")
    assert [season.chosen for season in trend.seasons] == [True]
    assert trend.seasons[0].period == pytest.approx(12.0, rel=0.01)
    assert trend.parameters["slope"].value == pytest.approx(0.05, abs=0.006)


def test_auto_finds_two_periods() -> None:
    t = np.arange(600.0)
    other = 2.5 * np.sin(2.0 * np.pi * t / 31.0)
    y = 3.0 * np.cos(2.0 * np.pi * t / 12.0) + other + np.random.default_rng(2).normal(size=600)
    assert [season.period for season in fitted(t, y, seasonal="auto").seasons] == pytest.approx(
        [31.0, 12.0], rel=0.01
    )


@pytest.mark.parametrize("correlation", [0.0, 0.8])
def test_auto_finds_no_season_in_noise_of_any_colour(correlation: float) -> None:
    for seed in range(8):
        noise = np.random.default_rng(seed).normal(size=240)
        for i in range(1, 240):
            noise[i] += correlation * noise[i - 1]
        assert fitted(T, 0.05 * T + noise, seasonal="auto").seasons == ()


def test_auto_finds_no_season_of_which_the_series_holds_less_than_two() -> None:
    y = 10.0 * np.sin(2.0 * np.pi * T / 300.0) + 0.1 * NOISE
    assert all(season.period < 120.0 for season in fitted(T, y, seasonal="auto").seasons)


def test_auto_takes_the_calendars_period_for_a_peak_near_it() -> None:
    hours = np.datetime64("2025-03-01T00") + np.arange(24 * 30).astype("timedelta64[h]")
    y = 5.0 * np.sin(2.0 * np.pi * np.arange(720) / 24.0) + np.random.default_rng(4).normal(size=720)
    assert [season.period for season in fitted(hours, y, seasonal="auto").seasons] == [86400.0]


def test_seasons_are_told_on_the_wire_and_left_out_where_there_are_none() -> None:
    told = fitted(T, WAVE + NOISE, seasonal=12).to_dict(points=False)
    assert told["seasons"] == [{"period": 12.0, "harmonics": 2, "chosen": False}]
    assert "seasons" not in fitted(T, NOISE).to_dict(points=False)


def monthly(trend_data: Path) -> tuple[Any, FloatArray]:
    rows = (trend_data / "climate" / "co2_mm_mlo.csv").read_text().split("\n")[1:]
    cells = [row.split(",") for row in rows if row]
    moments = np.array([cell[0] for cell in cells], dtype="datetime64[M]").astype("datetime64[D]")
    values = np.array([float(cell[2]) for cell in cells])
    return moments, np.where(values > 0.0, values, np.nan)


def weekly(trend_data: Path) -> tuple[Any, FloatArray]:
    rows = (trend_data / "climate" / "sm_co2_weekly.csv").read_text().split("\n")[1:]
    cells = [row.split(",") for row in rows if row]
    values = np.array([float(cell[1]) if cell[1] else np.nan for cell in cells])
    return np.array([cell[0] for cell in cells], dtype="datetime64[D]"), values


@pytest.mark.parametrize("series", [monthly, weekly])
@pytest.mark.parametrize("seasonal", ["year", "auto"])
def test_the_carbon_dioxide_of_mauna_loa_breathes_by_three_parts_per_million(
    trend_data: Path, series: object, seasonal: str
) -> None:
    moments, values = series(trend_data)  # type: ignore[operator]
    trend = fitted(moments, values, model="linear", degree=2, seasonal=seasonal)
    assert [season.period for season in trend.seasons] == [365.25 * 86400.0]
    assert trend.parameters["season_1_amplitude"].value == pytest.approx(3.15, abs=0.2)
    # It is highest in May.
    peak = moments[0] + np.timedelta64(round(trend.parameters["season_1_peak"].value), "s")
    assert 4 <= peak.astype("datetime64[M]").astype(int) % 12 + 1 <= 6
    assert 1.2 < trend.parameters["slope"].value * 365.25 * 86400.0 < 1.8
    assert trend.consensus.inlier_ratio > 0.98


@pytest.mark.parametrize("series", [monthly, weekly])
def test_readings_spoilt_at_mauna_loa_are_flagged_and_the_peaks_of_its_season_are_not(
    trend_data: Path, series: Callable[[Path], tuple[Any, FloatArray]]
) -> None:
    moments, values = series(trend_data)
    known = np.flatnonzero(np.isfinite(values))
    spoilt = known[7::25]
    values[spoilt] += np.where(np.arange(spoilt.size) % 3 == 0, -9.0, 12.0)
    trend = fitted(moments, values, model="linear", degree=2, seasonal="auto")
    assert [season.period for season in trend.seasons] == [365.25 * 86400.0]
    assert trend.parameters["season_1_amplitude"].value == pytest.approx(3.15, abs=0.2)
    assert not trend.points.inlier[spoilt].any()
    months = moments.astype("datetime64[M]").astype(int) % 12 + 1
    peaks = np.setdiff1d(known[np.isin(months[known], (5, 9))], spoilt)
    assert trend.points.inlier[peaks].mean() > 0.97
