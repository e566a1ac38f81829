from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from benchmarks.positions.drives import Drive, drive, mast
from estimators import Epoch, Fixes, locate_series


def solve(standing: Drive, **arguments: object) -> Fixes:
    fixes = locate_series(standing.epochs, **arguments)  # type: ignore[arg-type]
    assert isinstance(fixes, Fixes)
    return fixes


def epochs_cleared(standing: Drive, fixes: Fixes) -> float:
    """Share of epochs in which every satellite that lies is left out."""
    left_out = np.array([status == "excluded" for status in fixes.satellites.status])
    parts = np.split(left_out, fixes.offsets[1:-1])
    return float(
        np.mean([not (lying & ~out).any() for lying, out in zip(standing.faulty, parts, strict=True)])
    )


@pytest.mark.parametrize("faults", [1, 2, 3, 4])
def test_twenty_epochs_find_the_random_faults_of_each(faults: int) -> None:
    cleared, errors = [], []
    for seed in range(4):
        standing = drive(20, path=mast, step_s=300.0, start_s=5000.0 * seed, seed=seed, faults=faults)
        fixes = solve(standing, motion="static")
        cleared.append(epochs_cleared(standing, fixes))
        errors.append(float(np.linalg.norm(standing.error_enu_m(fixes.position_ecef_m)[0])))
    assert np.mean(cleared) >= (0.995 if faults < 4 else 0.95)
    assert max(errors) < 3.0


def test_clocks_that_wander_by_chance_cost_the_position_nothing() -> None:
    standing = drive(20, path=mast, step_s=300.0, seed=3, faults=3, clock=lambda t: 1e5 * math.sin(7.3 * t))
    fixes = solve(standing, motion="static")
    assert np.linalg.norm(standing.error_enu_m(fixes.position_ecef_m)[0]) < 2.0
    assert epochs_cleared(standing, fixes) >= 0.95


@pytest.mark.parametrize("faults", [1, 2])
def test_satellites_that_always_lie_are_found(faults: int) -> None:
    standing = drive(20, path=mast, step_s=60.0, seed=7, faults=faults, persistent=True)
    fixes = solve(standing)
    assert fixes.motion == "static"
    assert epochs_cleared(standing, fixes) == 1.0
    assert not fixes.ambiguous.any()


def test_a_standing_receiver_is_recognised_in_spite_of_faults() -> None:
    fixes = solve(drive(12, path=mast, step_s=120.0, seed=5, faults=2))
    assert (fixes.motion, fixes.surroundings) == ("static", "open")
    assert (fixes.position_ecef_m == fixes.position_ecef_m[0]).all()
    assert (fixes.velocity_enu_mps == 0.0).all()


def test_regions_of_95_percent_hold_the_truth_about_as_often() -> None:
    inside = []
    for seed in range(60):
        standing = drive(10, path=mast, step_s=300.0, start_s=900.0 * seed, seed=seed)
        fixes = solve(standing, motion="static")
        error = standing.error_enu_m(fixes.position_ecef_m)[0]
        inside.append(error @ np.linalg.solve(fixes.covariance_enu_m2[0], error) < 7.815)
    assert 0.88 <= np.mean(inside) <= 1.0


def test_two_places_that_explain_half_of_the_satellites_each_are_ambiguous() -> None:
    standing = drive(20, path=mast, step_s=30.0, seed=2, noise=0.2)
    elsewhere = standing.truth_m[0] + 400.0 * standing.axes[0]
    always = set.intersection(*(set(epoch.satellite or ()) for epoch in standing.epochs))
    chosen = sorted(always)[:8]
    assert len(chosen) == 8
    epochs = []
    for epoch in standing.epochs:
        rows = [k for k, name in enumerate(epoch.satellite or ()) if name in chosen]
        places = np.asarray(epoch.satellites_m)[rows]
        ranges = np.asarray(epoch.pseudoranges_m)[rows].copy()
        half = slice(0, len(rows) // 2)
        shift = np.linalg.norm(places - elsewhere, axis=1) - np.linalg.norm(
            places - standing.truth_m[0], axis=1
        )
        ranges[half] += shift[half]
        names = [(epoch.satellite or ())[k] for k in rows]
        epochs.append(Epoch(epoch.time, places, ranges, 2.0, "G", names))
    fixes = solve(standing.with_epochs(epochs), motion="static")
    assert fixes.ambiguous.all()
    assert max(rival.distance_m for rival in fixes.rivals) > 100.0
    assert fixes.hpl_m[0] > 100.0
    assert any(item.code == "ambiguous_faults" for item in fixes.notices)


def test_the_order_of_satellites_and_epochs_changes_nothing() -> None:
    standing = drive(8, path=mast, step_s=120.0, seed=11, faults=1)
    rng = np.random.default_rng(0)
    turned = []
    for epoch in standing.epochs:
        order = rng.permutation(len(np.asarray(epoch.pseudoranges_m)))
        turned.append(
            dataclasses.replace(
                epoch,
                satellites_m=np.asarray(epoch.satellites_m)[order],
                pseudoranges_m=np.asarray(epoch.pseudoranges_m)[order],
                sigma_m=np.asarray(epoch.sigma_m)[order],
                system=[(epoch.system or ())[k] for k in order],
                satellite=[(epoch.satellite or ())[k] for k in order],
            )
        )
    one, other = solve(standing), solve(standing.with_epochs(turned[::-1]))
    np.testing.assert_allclose(other.position_ecef_m[::-1], one.position_ecef_m, atol=1e-4)
    assert [other[k].excluded for k in range(7, -1, -1)] == [
        tuple(sorted(one[k].excluded, key=other[7 - k].excluded.index)) for k in range(8)
    ]
    assert any(item.code == "unsorted_times" for item in other.notices)


def test_half_a_millisecond_on_all_clocks_changes_the_clocks_only() -> None:
    standing = drive(8, path=mast, step_s=120.0, seed=11, faults=1)
    late = [
        dataclasses.replace(epoch, pseudoranges_m=np.asarray(epoch.pseudoranges_m) + 149896.229)
        for epoch in standing.epochs
    ]
    one, other = solve(standing), solve(standing.with_epochs(late))
    np.testing.assert_allclose(other.position_ecef_m, one.position_ecef_m, atol=1e-4)
    np.testing.assert_allclose(other.clocks_m["G"] - one.clocks_m["G"], 149896.229, atol=1e-3)


def test_an_epoch_of_three_satellites_keeps_its_row_and_takes_the_place_of_the_others() -> None:
    standing = drive(6, path=mast, step_s=60.0, seed=1)
    short = standing.epochs[2]
    standing.epochs[2] = dataclasses.replace(
        short,
        satellites_m=np.asarray(short.satellites_m)[:3],
        pseudoranges_m=np.asarray(short.pseudoranges_m)[:3],
        sigma_m=np.asarray(short.sigma_m)[:3],
        system=(short.system or ())[:3],
        satellite=(short.satellite or ())[:3],
    )
    fixes = solve(standing)
    assert fixes.status == ("solved", "solved", "bridged", "solved", "solved", "solved")
    assert len(fixes[2].satellites) == 3


def test_equal_input_gives_equal_bytes() -> None:
    standing = drive(10, path=mast, step_s=60.0, seed=9, faults=2)
    one, other = solve(standing), solve(standing)
    assert one.position_ecef_m.tobytes() == other.position_ecef_m.tobytes()
    assert one.hpl_m.tobytes() == other.hpl_m.tobytes()
