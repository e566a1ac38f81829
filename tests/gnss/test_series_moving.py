from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from benchmarks.positions.drives import Drive, car, drive
from estimators import EpochFix, Fixes, locate_series, locate_stream
from estimators.gnss.series.clocks import MILLISECOND_M


def solve(moving: Drive, **arguments: object) -> Fixes:
    fixes = locate_series(moving.epochs, **arguments)  # type: ignore[arg-type]
    assert isinstance(fixes, Fixes)
    return fixes


def horizontal(moving: Drive, fixes: Fixes) -> np.ndarray:
    return np.hypot(*moving.error_enu_m(fixes.position_ecef_m)[:, :2].T)


def test_a_car_is_recognised_and_followed_better_than_epoch_by_epoch() -> None:
    moving = drive(60, seed=1)
    joint, single = solve(moving), solve(moving, motion="independent")
    assert joint.motion == "moving"
    assert np.sqrt(np.mean(horizontal(moving, joint) ** 2)) < 0.8 * np.sqrt(
        np.mean(horizontal(moving, single) ** 2)
    )


@pytest.mark.parametrize("faults", [1, 2])
def test_a_car_is_followed_through_faults(faults: int) -> None:
    moving = drive(60, seed=faults, faults=faults)
    fixes = solve(moving)
    assert horizontal(moving, fixes).max() < 5.0
    left_out = np.array([status == "excluded" for status in fixes.satellites.status])
    assert (left_out >= np.concatenate(moving.faulty)).all()


def test_a_satellite_that_always_lies_does_not_move_the_car() -> None:
    moving = drive(60, seed=4, faults=1, persistent=True)
    assert horizontal(moving, solve(moving)).max() < 5.0


def test_velocities_are_those_of_the_car() -> None:
    moving = drive(60, seed=2)
    fixes = solve(moving)
    truth = np.array([car(t + 0.5) - car(t - 0.5) for t in range(60)])
    assert np.sqrt(np.mean((fixes.velocity_enu_mps - truth)[:, :2] ** 2)) < 1.0


def test_doppler_makes_velocities_better() -> None:
    truth = np.array([car(t + 0.5) - car(t - 0.5) for t in range(60)])
    errors = [
        np.sqrt(np.mean((solve(drive(60, seed=3, doppler=given)).velocity_enu_mps - truth)[:, :2] ** 2))
        for given in (False, True)
    ]
    assert errors[1] < 0.5 * errors[0]


def test_a_clock_that_is_set_by_a_millisecond_changes_the_clock_only() -> None:
    smooth = drive(60, seed=5)
    jumping = drive(60, seed=5, clock=lambda t: 40.0 * t + (MILLISECOND_M if t >= 30.0 else 0.0))
    one, other = solve(smooth), solve(jumping)
    np.testing.assert_allclose(other.position_ecef_m, one.position_ecef_m, atol=1e-3)
    assert other.clocks_m["G"][31] - other.clocks_m["G"][29] == pytest.approx(MILLISECOND_M + 80.0, abs=10.0)


def test_a_clock_without_rhyme_or_reason_is_left_free() -> None:
    moving = drive(60, seed=6, clock=lambda t: 1e5 * math.sin(7.3 * t))
    assert horizontal(moving, solve(moving)).max() < 5.0


def test_causal_answers_do_not_depend_on_later_epochs() -> None:
    moving = drive(60, seed=7)
    whole = solve(moving, motion="moving", surroundings="open", causal=True)
    part = solve(moving.with_epochs(moving.epochs[:40]), motion="moving", surroundings="open", causal=True)
    np.testing.assert_allclose(whole.position_ecef_m[:35], part.position_ecef_m[:35], atol=1e-2)


def test_regions_of_95_percent_hold_the_truth_about_as_often_and_levels_always() -> None:
    inside, beyond = [], 0
    for seed in range(8):
        moving = drive(60, seed=seed, start_s=3000.0 * seed)
        fixes = solve(moving)
        error = moving.error_enu_m(fixes.position_ecef_m)
        inside.append(np.einsum("ki,kij,kj->k", error, np.linalg.inv(fixes.covariance_enu_m2), error) < 7.815)
        beyond += int((horizontal(moving, fixes) > fixes.hpl_m).sum())
    assert 0.90 <= np.mean(inside) <= 0.99
    assert beyond == 0


def test_epochs_of_three_satellites_are_bridged() -> None:
    moving = drive(40, seed=8)
    for k in (15, 16, 17):
        epoch = moving.epochs[k]
        moving.epochs[k] = dataclasses.replace(
            epoch,
            satellites_m=np.asarray(epoch.satellites_m)[:3],
            pseudoranges_m=np.asarray(epoch.pseudoranges_m)[:3],
            sigma_m=np.asarray(epoch.sigma_m)[:3],
            system=(epoch.system or ())[:3],
            satellite=(epoch.satellite or ())[:3],
        )
    fixes = solve(moving)
    assert [fixes.status[k] for k in (14, 15, 16, 17, 18)] == [
        "solved",
        "bridged",
        "bridged",
        "bridged",
        "solved",
    ]
    assert horizontal(moving, fixes)[14:19].max() < 5.0


def test_ranges_that_are_missing_keep_their_rows() -> None:
    moving = drive(30, seed=9)
    ranges = np.asarray(moving.epochs[4].pseudoranges_m).copy()
    ranges[0] = np.nan
    moving.epochs[4] = dataclasses.replace(moving.epochs[4], pseudoranges_m=ranges)
    fixes = solve(moving)
    assert fixes[4].satellites.status[0] == "missing"
    assert np.isnan(fixes[4].satellites.residual_m[0])
    assert len(fixes.satellites) == sum(len(np.asarray(epoch.pseudoranges_m)) for epoch in moving.epochs)


def test_epochs_of_equal_times_are_both_answered() -> None:
    moving = drive(30, seed=10)
    moving.epochs.insert(11, moving.epochs[10])
    fixes = solve(moving)
    assert np.linalg.norm(fixes.position_ecef_m[10] - fixes.position_ecef_m[11]) < 0.5
    assert any(item.code == "duplicate_times" for item in fixes.notices)


def test_reflections_make_a_city() -> None:
    moving = drive(60, seed=11, systems="GE")
    rng = np.random.default_rng(11)
    late = [
        dataclasses.replace(
            epoch,
            pseudoranges_m=np.asarray(epoch.pseudoranges_m)
            + rng.exponential(25.0, len(np.asarray(epoch.pseudoranges_m)))
            * (rng.random(len(np.asarray(epoch.pseudoranges_m))) < 0.6),
        )
        for epoch in moving.epochs
    ]
    fixes = solve(moving.with_epochs(late))
    assert (fixes.motion, fixes.surroundings) == ("moving", "city")
    assert "too long" in fixes.surroundings_reason


def test_a_stream_answers_every_epoch_once_and_as_the_series_does() -> None:
    moving = drive(450, seed=12)
    streamed = list(locate_stream(iter(moving.epochs), surroundings="open"))
    assert [fix.time for fix in streamed if isinstance(fix, EpochFix)] == [e.time for e in moving.epochs]
    whole = solve(moving, motion="moving", surroundings="open")
    positions = np.array([fix.position_ecef_m for fix in streamed if isinstance(fix, EpochFix)])
    assert np.linalg.norm(positions - whole.position_ecef_m, axis=1).max() < 1.0


def test_a_stream_holds_a_bounded_number_of_epochs() -> None:
    moving = drive(450, seed=12)
    taken = 0

    def count() -> object:
        nonlocal taken
        for epoch in moving.epochs:
            taken += 1
            yield epoch

    ahead = [taken - k for k, _ in enumerate(locate_stream(count(), surroundings="open"))]  # type: ignore[arg-type]
    assert max(ahead) <= 250
