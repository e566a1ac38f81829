"""The table of methods, and what holds for each of them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.positions.sky import STATIONS, Sky, read_station
from estimators import Fix, NoFit, locate
from estimators.gnss.methods.registry import POSITION_METHODS
from tests.gnss import skies

METHODS = ("auto", "p-ransac", "ranco", "glrt", "raim", "greedy", "araim", "huber", "ols")
EXCLUDING = METHODS[:-2]
SPEED_OF_LIGHT = 299792458.0


def located(sky: skies.Sky, method: str) -> Fix:
    found = locate(sky.satellites_m, sky.ranges_m, sigma_m=sky.sigma_m, satellite=sky.names, method=method)
    assert isinstance(found, Fix)
    return found


def recorded(sky: Sky, method: str, bias: np.ndarray | float = 0.0) -> Fix:
    found = locate(
        sky.satellites_m,
        sky.ranges_m + bias,
        sigma_m=sky.sigma_m,
        system=sky.system,
        satellite=sky.name,
        method=method,
    )
    assert isinstance(found, Fix)
    return found


def test_the_methods_are_those_that_are_promised_and_auto_comes_first() -> None:
    assert next(iter(POSITION_METHODS)) == "auto"
    assert set(POSITION_METHODS) == set(METHODS)


@pytest.mark.parametrize("name", METHODS)
def test_a_method_says_what_it_is_when_to_use_it_and_where_it_comes_from(name: str) -> None:
    row = POSITION_METHODS[name]
    assert row.name == name
    for text in (row.title, row.summary, row.when_to_use, row.source):
        assert text == text.strip() != ""
    assert row.summary.endswith(".")
    assert row.when_to_use.endswith(".")


def test_only_the_methods_that_leave_nothing_out_are_not_robust() -> None:
    assert {name for name, row in POSITION_METHODS.items() if not row.robust} == {"huber", "ols"}


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000), shuffler=st.randoms())
def test_the_order_of_the_satellites_does_not_matter(method: str, seed: int, shuffler: object) -> None:
    sky = skies.make_sky(9, seed).with_faults({1: 90.0, 4: -140.0})
    order = list(range(9))
    shuffler.shuffle(order)  # type: ignore[attr-defined]
    first, second = located(sky, method), located(sky.taken(order), method)
    assert set(first.excluded) == set(second.excluded)
    np.testing.assert_allclose(first.position_ecef_m, second.position_ecef_m, atol=1e-4)
    assert first.hpl_m == pytest.approx(second.hpl_m, rel=1e-4)


def test_the_order_does_not_matter_to_subsets_that_are_drawn() -> None:
    sky = skies.make_sky(36, 3).with_faults({1: 90.0, 4: -140.0, 20: 60.0})
    order = np.random.default_rng(1).permutation(36).tolist()
    first, second = located(sky, "p-ransac"), located(sky.taken(order), "p-ransac")
    assert first.consensus.search == "sampled"
    assert set(first.excluded) == set(second.excluded) == {"G02", "G05", "G21"}


@pytest.mark.parametrize("method", METHODS)
def test_a_clock_error_of_half_a_millisecond_changes_nothing_but_the_clock(method: str) -> None:
    sky = skies.make_sky(10, 8).with_faults({3: 120.0})
    shift = 0.5e-3 * SPEED_OF_LIGHT
    before, after = located(sky, method), located(sky.with_faults(dict.fromkeys(range(10), shift)), method)
    assert before.excluded == after.excluded
    np.testing.assert_allclose(before.position_ecef_m, after.position_ecef_m, atol=1e-3)
    assert after.clocks_m["G"] - before.clocks_m["G"] == pytest.approx(shift, abs=1e-3)


@pytest.mark.parametrize("method", EXCLUDING)
@pytest.mark.parametrize("bias", [1e3, -1e5, 2e6])
def test_one_fault_is_found_however_large_it_is(method: str, bias: float) -> None:
    sky = skies.make_sky(11, 2).with_faults({5: bias})
    fix = located(sky, method)
    assert fix.excluded == ("G06",)
    assert np.linalg.norm(fix.position_ecef_m - sky.truth_m) < 20.0


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("n", [4, 5, 6])
def test_few_satellites_get_an_answer_from_every_method(method: str, n: int) -> None:
    sky = skies.make_sky(n, 6)
    fix = located(sky, method)
    assert fix.excluded == ()
    assert np.linalg.norm(fix.position_ecef_m - sky.truth_m) < 200.0


@pytest.mark.parametrize("method", METHODS)
def test_three_satellites_are_too_few_for_every_method(method: str) -> None:
    sky = skies.make_sky(4, 6).taken([0, 1, 2])
    found = locate(sky.satellites_m, sky.ranges_m, sigma_m=sky.sigma_m, method=method)
    assert isinstance(found, NoFit)


@pytest.mark.parametrize("method", EXCLUDING)
@pytest.mark.parametrize("station", STATIONS, ids=lambda station: station.title)
def test_recorded_epochs_without_faults_lose_no_satellite(
    method: str, station: object, gnss_data: object
) -> None:
    everything = read_station(station, gnss_data)  # type: ignore[arg-type]
    for sky in everything[:: len(everything) // 12]:
        assert recorded(sky, method).excluded == ()


@pytest.mark.parametrize("method", ["auto", "p-ransac", "glrt", "raim", "greedy", "araim"])
def test_a_fault_of_100_m_on_a_recorded_epoch_is_found_in_95_of_100(method: str, gnss_data: object) -> None:
    epochs = read_station(STATIONS[0], gnss_data)  # type: ignore[arg-type]
    rng = np.random.default_rng(20)
    found = 0
    for sky in epochs:
        bias = np.zeros(len(sky.name))
        bias[rng.integers(bias.size)] = 100.0 * rng.choice([-1.0, 1.0])
        found += not np.any(recorded(sky, method, bias).satellites.inlier & (bias != 0.0))
    assert found >= 0.95 * len(epochs)
