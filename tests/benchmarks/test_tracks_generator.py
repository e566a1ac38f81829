"""The bed of tracks: what it draws, and whether its labels and its oracle are right."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.tracks import motions, noises, offsets, samplings
from benchmarks.tracks.faults import Bursts, Draft, Spikes, Stuck
from benchmarks.tracks.generator import Group, Split, record
from benchmarks.tracks.oracle import rts_smooth, smooth_knowing
from benchmarks.tracks.recording import FAULTY, GOOD, Recording, from_plane, length_m
from benchmarks.tracks.scenarios import GROUPS, SCENARIOS
from benchmarks.tracks.scores import root_mean_square

NAMES = list(SCENARIOS)


def _raw_error(recording: Recording) -> np.ndarray:
    return np.hypot(*recording.error_m(recording.lat_deg, recording.lon_deg).T)


def test_there_are_enough_types_in_all_groups_and_half_of_them_are_held_out() -> None:
    assert len(SCENARIOS) >= 31
    assert set(GROUPS) == set(get_args(Group))
    splits = [scenario.split for scenario in SCENARIOS.values()]
    assert abs(splits.count("tune") - splits.count("held_out")) <= 1
    for group in GROUPS:
        assert {s.split for s in SCENARIOS.values() if s.group == group} == set(get_args(Split))


@pytest.mark.parametrize("name", NAMES)
def test_the_same_seed_draws_the_same_track(name: str) -> None:
    one, other = (record(SCENARIOS[name], 3) for _ in range(2))
    for field in ("t_s", "lat_deg", "lon_deg", "true_lat_deg", "true_lon_deg", "label", "faulty", "sigma_m"):
        assert getattr(one, field).tobytes() == getattr(other, field).tobytes()


@pytest.mark.parametrize("name", NAMES)
def test_another_seed_draws_another_track(name: str) -> None:
    one, other = record(SCENARIOS[name], 3), record(SCENARIOS[name], 4)
    assert one.lat_deg.tobytes() != other.lat_deg.tobytes()


@pytest.mark.parametrize("name", NAMES)
def test_a_type_has_the_share_of_faults_that_it_promises(name: str) -> None:
    scenario = SCENARIOS[name]
    recording = record(replace(scenario, disorder=()), 5)
    assert int(recording.faulty.sum()) == pytest.approx(scenario.share * len(recording), abs=1.5)


@pytest.mark.parametrize("name", NAMES)
def test_what_was_injected_is_what_is_labelled(name: str) -> None:
    recording = record(SCENARIOS[name], 6)
    assert np.all(recording.faulty[recording.label == FAULTY])
    assert not np.any(recording.faulty[recording.label == GOOD])
    error, sigma = _raw_error(recording), recording.sigma_m
    # Good rows are within five sigmas (and rounding), faulty ones three off before their noise.
    assert np.all(error[recording.label == GOOD] <= 7.0 * sigma[recording.label == GOOD])
    assert np.median((error / sigma)[recording.label == FAULTY] if recording.faulty.any() else 9.0) > 3.0


@pytest.mark.parametrize("name", NAMES)
def test_coordinates_are_on_earth_and_times_are_numbers(name: str) -> None:
    recording = record(SCENARIOS[name], 7)
    assert np.all(np.isfinite(recording.t_s))
    assert np.all(np.abs(recording.lat_deg) <= 90.0)
    assert np.all(np.abs(recording.lon_deg) <= 180.0)
    assert recording.accuracy_m is None or np.all(recording.accuracy_m > 0.0)


LASTING = {"city, wandering 30-90 s, 25 %", "stop and go, creeping 30-60 s, 20 %"}
"""Whoever drops a minute of a drive foretells worse than the faults are, and knowing them does not help."""


@pytest.mark.parametrize("name", [name for name in NAMES if name not in LASTING])
def test_whoever_knows_the_faults_is_not_worse_than_the_raw_track(name: str) -> None:
    recording = record(SCENARIOS[name], 8)
    raw = root_mean_square(recording.error_m(recording.lat_deg, recording.lon_deg))
    assert smooth_knowing(recording) < raw


def test_the_oracle_has_the_textbook_variance_of_a_constant() -> None:
    n = 400
    rng = np.random.default_rng(9)
    errors = []
    for _ in range(40):
        fixes = 3.0 * rng.normal(size=(n, 2))
        used, variance = np.ones(n, dtype=np.bool_), np.full(n, 9.0)
        (smoothed,) = rts_smooth(np.arange(n, dtype=float), fixes, variance, used, np.array([1e-12]))
        errors.append(smoothed[n // 2])
    # In the middle of a straight line the mean of n fixes: sigma / sqrt(n).
    assert np.std(errors) == pytest.approx(3.0 / np.sqrt(n), rel=0.25)


@given(share=st.floats(0.02, 0.45), seed=st.integers(0, 1000), longest=st.floats(3.0, 60.0))
def test_runs_are_disjoint_and_of_exactly_the_share_asked_for(
    share: float, seed: int, longest: float
) -> None:
    n = 300
    draft = Draft(np.arange(n, dtype=float), np.zeros((n, 2)), np.zeros(n, dtype=np.bool_))
    for fault in (Bursts(share, offsets.constant(50.0, 60.0), 2.0, longest), Stuck(share, 2.0, longest)):
        rows, off = fault.strike(draft, np.random.default_rng(seed))
        assert rows.size == np.unique(rows).size == round(share * n)
        assert rows.min() >= 0
        assert rows.max() < n
        assert off.shape == (rows.size, 2)


def test_spikes_leave_rows_alone_that_lie_already() -> None:
    draft = Draft(np.arange(100.0), np.zeros((100, 2)), np.arange(100) < 60)
    rows, _ = Spikes(0.3, offsets.scattered(10.0, 20.0)).strike(draft, np.random.default_rng(1))
    assert rows.size == 30
    assert rows.min() >= 60


def test_families_of_offsets_do_what_they_are_called() -> None:
    age, rng = np.arange(20.0), np.random.default_rng(2)
    still = offsets.constant(50.0, 60.0)(age, rng)
    np.testing.assert_array_equal(still, np.repeat(still[:1], 20, axis=0))
    for low_m, high_m in ((10.0, 20.0), (300.0, 4000.0)):
        length = np.hypot(*offsets.scattered(low_m, high_m)(age, rng).T)
        assert low_m <= length.min() <= length.max() <= high_m
    assert np.all(np.diff(np.hypot(*offsets.ramp(50.0, 60.0)(age, rng).T)) > 0.0)
    assert np.all(np.diff(np.hypot(*offsets.returning(50.0, 60.0, 5.0)(age, rng).T)) < 0.0)
    assert np.hypot(*offsets.clumped(400.0)(age, rng).T).min() >= 40.0 - 1e-9
    for family in (offsets.random_walk(50.0, 60.0, 1.0), offsets.wandering(50.0, 60.0, 0.2, 5.0)):
        assert np.unique(family(age, rng), axis=0).shape[0] == 20


@pytest.mark.parametrize(
    "law",
    [noises.normal(3.0), noises.laplace(3.0), noises.coloured(1.0, np.sqrt(8.0), 5.0)],
    ids=["normal", "laplace", "coloured"],
)
def test_a_noise_has_the_spread_that_it_states(law: noises.NoiseLaw) -> None:
    noise = law(np.arange(20000.0), np.random.default_rng(3))
    assert np.std(noise.error_m) == pytest.approx(3.0, rel=0.05)
    np.testing.assert_allclose(noise.sigma_m, 3.0)


def test_lasting_noise_lasts_as_long_as_it_says() -> None:
    drawn = noises.correlated(np.arange(0.0, 40000.0, 2.0), 1.0, 10.0, np.random.default_rng(4))[:, 0]
    assert np.mean(drawn[1:] * drawn[:-1]) == pytest.approx(np.exp(-0.2), abs=0.05)


def test_the_reported_accuracy_is_the_radius_of_two_thirds_of_the_fixes() -> None:
    noise = noises.reported(2.0, 25.0)(np.arange(20000.0), np.random.default_rng(5))
    assert noise.accuracy_m is not None
    assert np.mean(np.hypot(*noise.error_m.T) <= noise.accuracy_m) == pytest.approx(0.68, abs=0.02)


@pytest.mark.parametrize(
    ("motion", "top_mps"),
    [(motions.stationary, 0.0), (motions.walk, 2.5), (motions.city, 15.1), (motions.train, 83.4)],
)
def test_nothing_moves_faster_than_it_can(motion: motions.Motion, top_mps: float) -> None:
    path = motion(600.0, np.random.default_rng(6))
    speed = np.hypot(*np.diff(path, axis=0).T) / motions.GRID_S
    assert speed.max() <= top_mps
    assert speed.max() >= 0.8 * top_mps - 0.5


@given(seed=st.integers(0, 1000))
def test_times_ascend_within_the_duration(seed: int) -> None:
    for sampling in (
        samplings.every(0.1),
        samplings.jittered(1.0, 0.8),
        samplings.at_random(20.0, 5.0),
        samplings.with_gaps(1.0, 3, 20.0, 60.0),
    ):
        t = sampling(300.0, np.random.default_rng(seed))
        assert np.all(np.diff(t) > 0.0)
        assert t[0] >= 0.0
        assert t[-1] <= 300.0


@pytest.mark.parametrize("place", [(48.0, 11.0), (-16.8, 179.9995), (89.999, 30.0)])
def test_distances_are_the_same_wherever_the_track_is(place: tuple[float, float]) -> None:
    plane = np.array([[0.0, 0.0], [300.0, 0.0], [300.0, 400.0]])
    assert length_m(*from_plane(plane, place)) == pytest.approx(700.0, abs=0.01)
