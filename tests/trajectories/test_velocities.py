"""Reported speeds and courses: they help where they are measured, and do no harm where they are not."""

import numpy as np
import pytest

from estimators import InputError, NoFit, Track, clean_trajectory
from estimators.arrays import FloatArray
from estimators.geodesy.plane import Plane
from estimators.trajectories.columns import velocities_of
from estimators.trajectories.rows import read_rows
from estimators.trajectories.velocities import velocities, velocity_variance
from tests.trajectories.drives import MUNICH, Drive, drive, f1, with_bursts, with_spikes

FAULTY = with_bursts(with_spikes(drive(3), share=0.05), length=20)


def true_velocity(made: Drive) -> FloatArray:
    return np.asarray(np.gradient(made.truth, made.t, axis=0))


def doppler(made: Drive, sigma: float = 0.3, seed: int = 0) -> FloatArray:
    return true_velocity(made) + sigma * np.random.default_rng(seed).normal(size=made.truth.shape)


def reported(velocity: FloatArray) -> dict[str, FloatArray]:
    east, north = velocity.T
    return {"speed_mps": np.hypot(east, north), "bearing_deg": np.degrees(np.arctan2(east, north))}


def smoothed_differences(made: Drive) -> FloatArray:
    """What a receiver shows that computes speeds from its positions and calms them."""
    velocity = np.zeros_like(made.fixes)
    for k in range(1, len(velocity)):
        velocity[k] = 0.7 * velocity[k - 1] + 0.3 * (made.fixes[k] - made.fixes[k - 1])
    return velocity


def test_measured_velocities_make_a_track_better() -> None:
    plain, helped = FAULTY.clean(), FAULTY.clean(**reported(doppler(FAULTY)))
    assert FAULTY.error(helped) < 0.85 * FAULTY.error(plain)
    assert f1(helped, FAULTY.faulty) >= f1(plain, FAULTY.faulty)


def test_regions_hold_with_velocities_too() -> None:
    track = FAULTY.clean(**reported(doppler(FAULTY)))
    off = np.sum((FAULTY.places(track) - FAULTY.truth) ** 2, axis=1)
    assert np.mean(off / track.sigma_m**2 < 5.991) > 0.9


@pytest.mark.parametrize(
    "velocity",
    [
        3.6 * doppler(FAULTY),
        np.gradient(FAULTY.fixes, axis=0),
        np.diff(FAULTY.fixes, axis=0, prepend=FAULTY.fixes[:1]),
        smoothed_differences(FAULTY),
        -true_velocity(FAULTY),
        np.full((400, 2), np.nan),
    ],
    ids=["another unit", "central differences", "differences", "calmed differences", "backward", "none"],
)
def test_velocities_that_are_none_do_no_harm(velocity: FloatArray) -> None:
    plain, misled = FAULTY.clean(), FAULTY.clean(**reported(velocity))
    assert FAULTY.error(misled) < 1.1 * FAULTY.error(plain)
    assert f1(misled, FAULTY.faulty) > f1(plain, FAULTY.faulty) - 0.02


def test_a_fifth_of_wrong_velocities_does_no_harm() -> None:
    velocity, rng = doppler(FAULTY), np.random.default_rng(1)
    wrong = rng.random(400) < 0.2
    velocity[wrong] = rng.uniform(-30.0, 30.0, (int(wrong.sum()), 2))
    assert FAULTY.error(FAULTY.clean(**reported(velocity))) < 1.1 * FAULTY.error(FAULTY.clean())


@pytest.mark.parametrize("frozen", [True, False])
def test_a_speed_that_stays_what_it_was_does_little_harm(frozen: bool) -> None:
    velocity = doppler(FAULTY)
    for first in range(60, 300, 130):
        velocity[first : first + 60] = velocity[first] if frozen else 0.0
    assert FAULTY.error(FAULTY.clean(**reported(velocity))) < 1.1 * FAULTY.error(FAULTY.clean())


def test_velocities_with_gaps_are_used_where_they_are() -> None:
    velocity = doppler(FAULTY)
    velocity[::3] = np.nan
    assert FAULTY.error(FAULTY.clean(**reported(velocity))) < FAULTY.error(FAULTY.clean())


def test_a_track_that_stands_may_leave_out_the_course() -> None:
    rng = np.random.default_rng(2)
    fixes = 4.0 * rng.normal(size=(300, 2))
    made = Drive(np.arange(300.0), fixes, np.zeros((300, 2)), np.zeros(300, dtype=np.bool_))
    speeds = np.abs(rng.normal(0.0, 0.1, 300))
    assert made.error(made.clean(speed_mps=speeds)) <= 1.02 * made.error(made.clean())


def test_courses_are_true_far_from_the_middle_of_the_plane_and_at_the_pole() -> None:
    for place in (Plane(89.9999, 30.0), Plane(-89.9999, 30.0), Plane(48.0, 179.9)):
        fixes = np.array([[0.0, 0.0], [30_000.0, 20_000.0]])
        lat, lon = place.locate(fixes)
        found = velocities(place, lat, lon, np.full(2, 10.0), np.array([0.0, 90.0]))
        ahead = place.project(
            lat + np.array([1e-5, 0.0]), lon + np.array([0.0, 1e-5 / np.cos(np.radians(lat[1]))])
        )
        way = (ahead - fixes) / np.hypot(*(ahead - fixes).T)[:, None]
        if place.latitude_deg < 89.0:
            np.testing.assert_allclose(found, 10.0 * way, atol=1e-2)
        np.testing.assert_allclose(np.hypot(*found.T), 10.0)


def test_the_variance_of_velocities_follows_their_errors() -> None:
    made = drive(4, n=900)
    fine, coarse = (velocity_variance(made.t, made.fixes, doppler(made, sigma))[5] for sigma in (0.5, 3.0))
    assert 0.2 < np.sqrt(fine) < 2.0
    assert 2.0 < np.sqrt(coarse) < 6.0


def test_velocities_are_not_used_where_fixes_are_far_between() -> None:
    made = drive(5)
    assert np.isinf(velocity_variance(30.0 * made.t, made.fixes, doppler(made))).all()


def test_speeds_that_no_receiver_means_are_left_out() -> None:
    lat, lon = MUNICH.locate(drive(0, n=6).fixes)
    plane = read_rows(np.arange(6.0), lat, lon).plane
    speed = np.array([-1.0, np.nan, np.inf, 1e9, 5.0, 5.0])
    bearing = np.array([0.0, 0.0, 0.0, 0.0, 725.0, np.inf])
    found = velocities_of(speed, bearing, plane, lat, lon, None)
    assert found is not None
    assert np.isfinite(found[:, 0]).tolist() == [False] * 4 + [True, False]
    np.testing.assert_allclose(
        found[4], [5.0 * np.sin(np.radians(5.0)), 5.0 * np.cos(np.radians(5.0))], atol=1e-4
    )


def test_a_course_without_a_speed_changes_nothing() -> None:
    made = drive(6)
    plain, turned = made.clean(), made.clean(bearing_deg=np.full(400, 90.0))
    assert plain.lat_deg.tobytes() == turned.lat_deg.tobytes()


def test_a_column_of_another_length_is_refused() -> None:
    with pytest.raises(InputError, match="speed_mps"):
        clean_trajectory([0.0, 1.0], [48.0, 48.0], [11.0, 11.0], speed_mps=[1.0])


@pytest.mark.parametrize("fixes", [1, 2, 5])
def test_few_fixes_with_velocities_are_answered(fixes: int) -> None:
    made = drive(7, n=fixes)
    found = clean_trajectory(
        made.t, *MUNICH.locate(made.fixes), speed_mps=np.ones(fixes), bearing_deg=np.zeros(fixes)
    )
    assert isinstance(found, Track)
    assert not isinstance(found, NoFit)
