"""Answers that others published for real data (R robustbase 0.95, MASS, NASA), by this library's methods."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from estimators.consensus.stopping import draws_needed, log_miss_per_draw
from tests.trends.contaminated import fitted

Column = Callable[[dict[str, str]], bool]


def columns(file: Path, x: str, y: str, keep: Column = lambda _row: True) -> tuple[np.ndarray, np.ndarray]:
    with file.open() as stream:
        rows = [row for row in csv.DictReader(stream) if keep(row)]
    return np.array([float(row[x]) for row in rows]), np.array([float(row[y]) for row in rows])


def slope_of(t: np.ndarray, y: np.ndarray, method: str) -> float:
    return fitted(t, y, method=method).parameters["slope"].value


@pytest.mark.parametrize("method", ["auto", "mm"])
def test_belgian_phone_calls_grow_by_a_tenth_a_year(method: str, trend_data: Path) -> None:
    t, y = columns(trend_data / "robustbase" / "telef.csv", "Year", "Calls")
    trend = fitted(t, y, method=method)
    assert trend.parameters["slope"].value == pytest.approx(0.110, abs=0.002)
    # Of 1964 to 1969 the minutes were recorded instead of the calls.
    assert not trend.points.inlier[(t >= 64) & (t <= 69)].any()


@pytest.mark.parametrize("method", ["auto", "mm"])
def test_the_same_calls_in_millions_are_the_phones_of_mass(method: str, trend_data: Path) -> None:
    # MASS::phones holds the calls of robustbase::telef times ten.
    t, y = columns(trend_data / "robustbase" / "telef.csv", "Year", "Calls")
    assert slope_of(t, 10.0 * y, method) == pytest.approx(1.10, abs=0.02)
    assert slope_of(t, 10.0 * y, "ols") == pytest.approx(5.04, abs=0.005)


def test_the_kootenay_river_at_newgate_follows_that_at_libby(trend_data: Path) -> None:
    t, y = columns(trend_data / "robustbase" / "kootenay.csv", "Libby", "Newgate")
    trend = fitted(t, y, method="mm")
    assert trend.parameters["slope"].value == pytest.approx(0.62, abs=0.005)
    assert y[~trend.points.inlier].tolist() == [15.7]


def test_stars_of_the_main_sequence_rise_whatever_the_giants_do(trend_data: Path) -> None:
    t, y = columns(trend_data / "robustbase" / "starsCYG.csv", "log.Te", "log.light")
    assert slope_of(t, y, "mm") == pytest.approx(2.25, abs=0.005)
    trend = fitted(t, y)
    # The four giants are outliers; without them the published answers go from 2.25 (MM) to 3.05 (LTS).
    assert not trend.points.inlier[t < 3.6].any()
    slope = trend.parameters["slope"]
    assert slope.low <= 2.25
    assert slope.high >= 3.05
    assert abs(slope.value - 3.05) <= slope.stderr


@pytest.mark.parametrize("method", ["auto", "mm"])
def test_brains_grow_with_the_three_quarter_power_of_bodies(method: str, trend_data: Path) -> None:
    body, brain = columns(trend_data / "robustbase" / "Animals2.csv", "body", "brain")
    trend = fitted(np.log10(body), np.log10(brain), method=method)
    assert trend.parameters["slope"].value == pytest.approx(0.746, abs=0.006)
    dinosaurs = (body > 9000.0) & (brain < 200.0)
    assert np.count_nonzero(dinosaurs) == 3
    assert not trend.points.inlier[dinosaurs].any()


@pytest.mark.parametrize("method", ["auto", "msac", "mm"])
def test_the_earth_warms_by_two_hundredths_of_a_kelvin_a_year(method: str, trend_data: Path) -> None:
    t, y = columns(
        trend_data / "climate" / "gistemp_annual.csv",
        "Year",
        "Mean",
        lambda row: row["Source"] == "GISTEMP" and int(row["Year"]) >= 1970,
    )
    trend = fitted(t.astype(int), y, method=method)
    slope = trend.parameters["slope"]
    assert 0.01915 <= slope.value <= 0.01935
    assert 0.015 < slope.low < slope.value < slope.high < 0.024
    assert trend.p_value < 1e-6


@pytest.mark.parametrize("method", ["auto", "mm"])
def test_transistors_double_every_other_year(method: str, trend_data: Path) -> None:
    table = np.loadtxt(trend_data / "climate" / "rupp_transistors.dat")
    assert slope_of(table[:, 0], np.log2(table[:, 1]), method) == pytest.approx(0.50, abs=0.005)


@pytest.fixture(scope="module")
def seed_example() -> tuple[np.ndarray, np.ndarray]:
    """70 points on y = 2 x + 1 with sigma 0.5 and 30 uniform ones in a square, by the field's usual seed."""
    rng = np.random.RandomState(42)
    x = rng.uniform(0.0, 10.0, 70)
    y = 2.0 * x + 1.0 + rng.normal(0.0, 0.5, 70)
    return np.append(x, rng.uniform(0.0, 10.0, 30)), np.append(y, rng.uniform(0.0, 10.0, 30))


@pytest.mark.parametrize("method", ["ransac", "msac", "lo-ransac", "auto"])
def test_the_seed_example_of_the_field_is_reproduced(
    method: str, seed_example: tuple[np.ndarray, np.ndarray]
) -> None:
    trend = fitted(*seed_example, method=method, threshold=1.0)
    slope, intercept = (trend.parameters[name] for name in ("slope", "intercept"))
    assert slope.value == pytest.approx(2.0, abs=0.05)
    assert intercept.value == pytest.approx(1.0, abs=0.25)
    assert slope.low <= 2.0 <= slope.high
    assert 66 <= trend.consensus.inliers <= 74


def test_the_seed_example_needs_no_threshold(seed_example: tuple[np.ndarray, np.ndarray]) -> None:
    trend = fitted(*seed_example)
    assert trend.parameters["slope"].value == pytest.approx(2.0, abs=0.05)
    assert trend.consensus.sigma == pytest.approx(0.5, abs=0.15)


def test_seven_draws_suffice_for_the_seed_example_by_the_classic_formula() -> None:
    # k = ln(1 - 0.99) / ln(1 - 0.7^2) = 6.8; the 66 in print is a slip.
    assert draws_needed(log_miss_per_draw(0.7**2), 0.99) == 7
