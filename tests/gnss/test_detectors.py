"""The fingerprint by which each method is known: a property that the others, or least squares, lack."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.special import chdtri, ndtr, ndtri

from estimators import Fix, PositionOptions, locate
from estimators.geodesy.local_frame import enu_axes
from estimators.gnss.methods.araim import Araim
from estimators.gnss.methods.fault_modes import list_fault_modes
from estimators.gnss.methods.glrt import Glrt
from estimators.gnss.methods.greedy import Greedy
from estimators.gnss.methods.huber import TUNING
from estimators.gnss.methods.minimal_subsets import all_subsets, judge_subsets
from estimators.gnss.methods.p_ransac import PRansac
from estimators.gnss.methods.raim import Raim
from estimators.gnss.methods.ranco import Ranco, cover_faults
from estimators.gnss.methods.separation import protection_levels, separate
from estimators.gnss.observations import as_epoch
from estimators.gnss.snapshot.problem import Problem, solve_problem
from tests.gnss.skies import Sky, make_sky

OPTIONS = PositionOptions()
SEEDS = st.integers(0, 10_000)


def problem_of(sky: Sky, system: list[str] | None = None) -> Problem:
    epoch = as_epoch(sky.satellites_m, sky.ranges_m, sky.sigma_m, system, sky.names, rotated=True)
    solved = solve_problem(epoch.table)
    assert solved is not None
    return solved


def squares_of(problem: Problem, kept: np.ndarray) -> float:
    """Sum of squares of least squares over some satellites, solved anew."""
    state, *_ = np.linalg.lstsq(problem.A[kept], problem.z[kept], rcond=None)
    return float(np.sum((problem.z[kept] - problem.A[kept] @ state) ** 2))


def limit(freedom: int) -> float:
    return float(chdtri(freedom, OPTIONS.false_alarm))


def located(sky: Sky, method: str, **options: object) -> Fix:
    found = locate(
        sky.satellites_m,
        sky.ranges_m,
        sigma_m=sky.sigma_m,
        satellite=sky.names,
        method=method,
        options=PositionOptions(**options),  # type: ignore[arg-type]
    )
    assert isinstance(found, Fix)
    return found


# p-ransac


@settings(max_examples=25, deadline=None)
@given(SEEDS)
def test_p_ransac_keeps_the_largest_consensus_that_least_squares_confirms(seed: int) -> None:
    problem = problem_of(make_sky(8, seed).with_faults({0: 150.0, 5: -90.0}))
    n, p = problem.A.shape
    largest = 0
    for subset in itertools.combinations(range(n), p):
        inverse = np.linalg.inv(problem.A[list(subset)])
        pdop = np.sqrt(np.sum((inverse[:3] / problem.table.sigma_m[list(subset)]) ** 2))
        gain = problem.A @ inverse
        spread = np.sqrt(1.0 + np.sum(gain**2, axis=1))
        agrees = np.abs(problem.z - gain @ problem.z[list(subset)]) <= OPTIONS.threshold_sigmas * spread
        agrees[list(subset)] = True
        count = int(agrees.sum())
        if pdop <= 20.0 and count > p and squares_of(problem, agrees) <= limit(count - p):
            largest = max(largest, count)
    verdict = PRansac().judge(problem, OPTIONS)
    assert int(np.sum(~verdict.excluded)) == (largest if largest > 0 else n)


def test_a_subset_that_knows_its_position_badly_judges_nobody() -> None:
    problem = problem_of(make_sky(9, 4).with_faults({2: 200.0}))
    assert PRansac().judge(problem, OPTIONS).excluded[2]
    gate = PRansac(largest_pdop=1e-3).judge(problem, OPTIONS)
    assert not gate.excluded.any()
    assert gate.ledger.invalid > 0


def test_every_minimal_subset_is_solved_or_a_fixed_sample_of_very_many() -> None:
    few, many = problem_of(make_sky(12, 1)), problem_of(make_sky(40, 1))
    assert judge_subsets(few, 3.5).drawn == 495
    assert judge_subsets(few, 3.5).exhaustive
    drawn = judge_subsets(many, 3.5)
    assert not drawn.exhaustive
    assert np.all(np.diff(drawn.members, axis=1) > 0)
    np.testing.assert_array_equal(drawn.members, judge_subsets(many, 3.5).members)


# ranco


def test_ranco_excludes_nothing_when_more_satellites_fail_than_it_reckons_with() -> None:
    sky = make_sky(12, 9).with_faults({1: 300.0, 4: -250.0, 8: 180.0})
    assert located(sky, "ranco", most_faults=2).excluded == ()
    assert located(sky, "ranco", most_faults=3).excluded == ("G02", "G05", "G09")
    assert located(sky, "p-ransac", most_faults=2).excluded == ("G02", "G05", "G09")


def test_ranco_solves_fewer_subsets_than_there_are() -> None:
    problem = problem_of(make_sky(12, 9))
    assert 0 < Ranco().judge(problem, PositionOptions(most_faults=1)).ledger.scored < 12
    assert PRansac().judge(problem, OPTIONS).ledger.scored > 100


@settings(max_examples=30, deadline=None)
@given(SEEDS, st.integers(1, 3))
def test_whoever_fails_one_of_the_covering_subsets_is_healthy(seed: int, faults: int) -> None:
    subsets = all_subsets(9, 4)[np.random.default_rng(seed).permutation(126)]
    chosen = [set(row) for row in subsets[cover_faults(9, faults, subsets)].tolist()]
    for failed in itertools.combinations(range(9), faults):
        assert any(not members & set(failed) for members in chosen)


# glrt


@settings(max_examples=25, deadline=None)
@given(SEEDS, st.integers(0, 3))
def test_glrt_takes_the_likeliest_of_the_smallest_sets_that_pass(seed: int, faults: int) -> None:
    rng = np.random.default_rng(seed)
    sky = make_sky(9, seed).with_faults(dict(zip(range(faults), rng.uniform(30, 300, 3), strict=False)))
    problem = problem_of(sky)
    excluded = Glrt().judge(problem, OPTIONS).excluded
    size = int(excluded.sum())
    left = squares_of(problem, ~excluded)

    def best_of(k: int) -> float:
        return min(
            squares_of(problem, ~np.isin(np.arange(9), failed))
            for failed in itertools.combinations(range(9), k)
        )

    assume(left <= limit(5 - size))
    assert left == pytest.approx(best_of(size), rel=1e-6, abs=1e-9)
    assert all(best_of(k) > limit(5 - k) for k in range(size))


def test_glrt_finds_two_faults_that_mask_each_other_from_one_at_a_time() -> None:
    found = {"glrt": 0, "raim": 0}
    for seed in range(60):
        sky = make_sky(9, seed).with_faults({0: 100.0, 1: 100.0})
        for method in found:
            found[method] += {"G01", "G02"} <= set(located(sky, method).excluded)
    assert found["glrt"] > found["raim"] + 3


def test_sets_too_many_to_enumerate_are_found_by_a_beam() -> None:
    faults = {3: 80.0, 8: -120.0, 12: 300.0, 17: 60.0, 22: -90.0, 29: 500.0}
    verdict = Glrt().judge(problem_of(make_sky(32, 2).with_faults(faults)), OPTIONS)
    assert set(np.flatnonzero(verdict.excluded)) == set(faults)
    assert verdict.search == "closed"


# raim and greedy


def test_raim_detects_but_does_not_exclude_where_one_satellite_is_redundant() -> None:
    sky = make_sky(6, 12).with_faults({2: 400.0})
    assert Raim().judge(problem_of(sky), OPTIONS).excluded[2]
    five = sky.taken([0, 1, 2, 3, 4])
    problem = problem_of(five)
    assert problem.squares > limit(1)
    assert not Raim().judge(problem, OPTIONS).excluded.any()


@settings(max_examples=40, deadline=None)
@given(SEEDS)
def test_raim_excludes_nobody_whose_w_test_passes(seed: int) -> None:
    problem = problem_of(make_sky(10, seed, noise=1.6))
    w = np.abs(problem.z) / np.sqrt(np.diagonal(problem.S))
    accused = problem.squares > limit(6) and w.max() > -ndtri(OPTIONS.false_alarm / 20)
    excluded = Raim().judge(problem, OPTIONS).excluded
    assert bool(excluded.any()) == accused
    if accused:
        assert excluded[np.argmax(w)]


def test_greedy_goes_on_where_no_w_test_accuses_anybody() -> None:
    differ = 0
    for seed in range(200):
        problem = problem_of(make_sky(14, seed, noise=1.6))
        greedy, raim = Greedy().judge(problem, OPTIONS).excluded, Raim().judge(problem, OPTIONS).excluded
        assert not np.any(raim & ~greedy)
        differ += int(greedy.sum()) > int(raim.sum())
    assert differ > 0


@settings(max_examples=25, deadline=None)
@given(SEEDS)
def test_greedy_leaves_an_epoch_that_passes_or_has_no_redundancy_to_spare(seed: int) -> None:
    problem = problem_of(make_sky(9, seed).with_faults({0: 70.0, 3: -110.0, 6: 200.0}))
    excluded = Greedy().judge(problem, OPTIONS).excluded
    freedom = 5 - int(excluded.sum())
    assert freedom == 1 or squares_of(problem, ~excluded) <= limit(freedom) * (1 + 1e-9)


# huber and least squares


def test_huber_solves_its_estimating_equations_and_least_squares_does_not() -> None:
    sky = make_sky(10, 3).with_faults({2: 60.0})

    def balance(fix: Fix) -> float:
        u = fix.satellites.residual_m / sky.sigma_m
        direction = sky.satellites_m - fix.position_ecef_m
        direction /= np.linalg.norm(direction, axis=1)[:, None]
        score = np.clip(u, -TUNING, TUNING) / sky.sigma_m
        return float(np.linalg.norm(direction.T @ score) + abs(score.sum()))

    assert balance(located(sky, "huber")) < 1e-4
    assert balance(located(sky, "ols")) > 1e-2


def test_a_fault_twice_as_large_moves_least_squares_twice_as_far_and_huber_no_farther() -> None:
    sky = make_sky(10, 3)

    def moved(method: str, bias: float) -> float:
        return float(
            np.linalg.norm(located(sky.with_faults({2: bias}), method).position_ecef_m - sky.truth_m)
        )

    assert moved("ols", 4000.0) == pytest.approx(2 * moved("ols", 2000.0), rel=0.05)
    assert moved("huber", 4000.0) == pytest.approx(moved("huber", 2000.0), rel=0.05)


def test_methods_that_leave_nothing_out_say_so() -> None:
    sky = make_sky(10, 3).with_faults({2: 500.0})
    assert located(sky, "ols").excluded == located(sky, "huber").excluded == ()


# araim


def test_the_protection_level_of_an_axis_holds_the_risk_it_was_given() -> None:
    problem = problem_of(make_sky(10, 3))
    present = np.ones(10, dtype=np.bool_)
    modes = list_fault_modes(present, problem.table.clock, 1e-5, 1e-4, 1e-5)
    found = separate(problem, enu_axes(0.0, 0.0), present, modes, 0.75, 1e-3)
    assert found is not None
    _, level = protection_levels(found, 1e-5)

    def tail(x: np.ndarray) -> np.ndarray:
        return np.asarray(ndtr(-x))

    risk = 2 * tail((level - found.bias[0, 2]) / found.sigma[0, 2]) + np.sum(
        1e-5 * tail((level - found.threshold[:, 2] - found.bias[1:, 2]) / found.sigma[1:, 2])
    )
    assert float(risk) == pytest.approx(0.5e-5 * (1 - modes.unmonitored / 1e-5), rel=1e-6)


def test_separations_are_those_of_solutions_without_the_satellite() -> None:
    problem = problem_of(make_sky(9, 1).with_faults({4: 50.0}))
    present = np.ones(9, dtype=np.bool_)
    modes = list_fault_modes(present, problem.table.clock, 1e-5, 1e-4, 1e-5)
    axes = enu_axes(10.0, 20.0)
    found = separate(problem, axes, present, modes, 0.75, 1e-3)
    assert found is not None
    for row in range(9):
        kept = ~found.modes.faulty[row]
        state, *_ = np.linalg.lstsq(problem.A[kept], problem.z[kept], rcond=None)
        np.testing.assert_allclose(found.distance[row], np.abs(axes @ state[:3]), atol=1e-6)


def test_araim_answers_with_protection_levels_of_its_own() -> None:
    sky = make_sky(10, 3)
    fix, auto = located(sky, "araim"), located(sky, "auto")
    assert fix.integrity.method == "solution-separation"
    assert auto.integrity.method == "posterior"
    assert fix.integrity.fault_prior == OPTIONS.satellite_fault
    assert (
        located(sky, "araim", integrity_risk=1e-7).hpl_m
        > fix.hpl_m
        > located(sky, "araim", nominal_bias_m=0.0).hpl_m
    )


def test_araim_bounds_nothing_where_a_fault_cannot_be_watched() -> None:
    assert np.isinf(located(make_sky(4, 3), "araim").hpl_m)


def test_more_faults_are_watched_where_they_are_likelier() -> None:
    present, clock = np.ones(10, dtype=np.bool_), np.zeros(10, dtype=np.int64)
    rare = list_fault_modes(present, clock, 1e-5, 1e-4, 1e-5)
    common = list_fault_modes(present, clock, 1e-2, 1e-4, 1e-5)
    assert rare.faulty.sum(axis=1).max() == 1
    assert common.faulty.sum(axis=1).max() > 2
    assert common.unmonitored <= 1e-6


def test_araim_excludes_a_constellation_that_lies_as_one() -> None:
    sky = make_sky(18, 7)
    elsewhere = sky.truth_m + 400.0 * sky.axes[0]
    lies = np.linalg.norm(sky.satellites_m - elsewhere, axis=1) - np.linalg.norm(
        sky.satellites_m - sky.truth_m, axis=1
    )
    system = ["G"] * 12 + ["E"] * 6
    faulty = dataclasses.replace(sky, ranges_m=sky.ranges_m + np.where(np.arange(18) < 12, 0.0, lies))
    problem = problem_of(faulty, system)
    verdict = Araim().judge(problem, OPTIONS)
    assert not verdict.excluded[:12].any()
    assert int(verdict.excluded[12:].sum()) >= 4
    # Whoever stays sets the constellation's clock and hardly moves the position.
    kept = solve_problem(problem.table, ~verdict.excluded)
    assert kept is not None
    assert np.linalg.norm(problem.state[:3] - sky.truth_m) > 50.0
    assert np.linalg.norm(kept.state[:3] - sky.truth_m) < 10.0
