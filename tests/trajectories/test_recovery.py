"""Faults are found, and the track is better for it."""

import numpy as np
import pytest

from tests.trajectories.drives import drive, f1, with_bursts, with_spikes


@pytest.mark.parametrize("seed", range(4))
def test_spikes_are_flagged_and_nothing_else(seed: int) -> None:
    made = with_spikes(drive(seed), seed + 10)
    track = made.clean()
    assert f1(track, made.faulty) > 0.97
    assert set(np.array(track.points.reason)[made.faulty]) == {"spike"}


@pytest.mark.parametrize("seed", range(4))
def test_bursts_that_fill_their_window_are_flagged_from_end_to_end(seed: int) -> None:
    made = with_bursts(drive(seed))
    track = made.clean()
    assert f1(track, made.faulty) > 0.97
    assert np.all(np.array(track.points.reason)[made.faulty & ~track.points.inlier] == "burst")


def test_a_track_through_bursts_is_as_good_as_one_between_them() -> None:
    made = with_bursts(drive(5))
    track = made.clean()
    off = np.hypot(*(made.places(track) - made.truth).T)
    assert np.sqrt(np.mean(off[made.faulty] ** 2)) < 8.0
    assert made.error(track) < 5.0


@pytest.mark.parametrize("seed", range(4))
def test_good_tracks_keep_their_fixes(seed: int) -> None:
    made = drive(seed)
    track = made.clean()
    assert np.count_nonzero(~track.points.inlier) <= 1
    assert made.error(track) < 4.0


def test_probabilities_tell_faults_from_good_fixes() -> None:
    made = with_spikes(drive(2))
    probability = made.clean().points.probability
    assert probability[made.faulty].mean() < 0.05
    assert probability[~made.faulty].mean() > 0.98


def test_regions_of_95_percent_cover_at_least_91_percent_and_not_all() -> None:
    inside = []
    for seed in range(6):
        made = with_spikes(drive(seed), seed + 20)
        track = made.clean()
        squared = np.sum((made.places(track) - made.truth) ** 2, axis=1) / track.sigma_m**2
        inside.append(np.mean(squared < 5.991))
    assert 0.91 <= np.mean(inside) <= 0.995


def test_the_noise_is_found() -> None:
    track = drive(3, n=1200, sigma=6.0).clean()
    assert track.noise.source == "estimated"
    assert 4.5 < track.noise.sigma_m < 7.5


def test_speed_and_heading_are_those_of_the_motion() -> None:
    made = drive(4)
    track = made.clean()
    velocity = np.gradient(made.truth, axis=0)
    speed, heading = np.hypot(*velocity.T), np.degrees(np.arctan2(*velocity.T))
    inner = slice(5, -5)
    assert np.median(np.abs(track.speed_mps - speed)[inner]) < 1.0
    turned = (track.heading_deg - heading + 180.0) % 360.0 - 180.0
    assert np.median(np.abs(turned)[inner]) < 6.0


def test_a_wrong_height_moves_nothing() -> None:
    made = drive(6)
    rng = np.random.default_rng(0)
    heights = 500.0 + 0.1 * made.t + 3.0 * rng.normal(size=made.t.size)
    heights[100:110] += 400.0
    heights[200:220] = np.nan
    track = made.clean(height_m=heights)
    assert track.height_m is not None
    off = track.height_m - (500.0 + 0.1 * made.t)
    assert np.abs(off).max() < 6.0
    squared = off**2 / track.covariance_enu_m2[:, 2, 2]
    assert np.mean(squared < 3.84) > 0.85


def test_distance_is_that_of_the_motion_not_of_the_faults() -> None:
    made = with_spikes(drive(7, n=1200))
    track = made.clean()
    length = float(np.sum(np.hypot(*np.diff(made.truth, axis=0).T)))
    assert abs(track.distance.cleaned.value / length - 1.0) < 0.01
    assert track.distance.raw_m > 5.0 * length


def test_a_receiver_that_stands_goes_nowhere() -> None:
    rng = np.random.default_rng(3)
    made = drive(0, n=1200)
    still = type(made)(made.t, 4.0 * rng.normal(size=made.fixes.shape), 0.0 * made.truth, made.faulty)
    track = still.clean()
    assert track.distance.cleaned.value < 20.0 / 3.0
    assert [item.kind for item in track.stretches] == ["stopped"]


def test_a_stop_between_two_drives_is_a_stretch_of_its_own() -> None:
    rng = np.random.default_rng(4)
    t = np.arange(600.0)
    along = 12.0 * np.concatenate([np.arange(200.0), np.full(200, 200.0), 200.0 + np.arange(200.0)])
    truth = np.column_stack([along, np.zeros(600)])
    track = type(drive())(t, truth + 3.0 * rng.normal(size=truth.shape), truth, t < 0.0).clean()
    kinds = [item.kind for item in track.stretches]
    assert kinds == ["moving", "stopped", "moving"]
    stop = track.stretches[1]
    assert abs(stop.duration_s - 200.0) < 20.0
    assert abs(track.stretches[0].speed_mps - 12.0) < 0.3
    assert sum(item.duration_s for item in track.stretches) == pytest.approx(599.0)
