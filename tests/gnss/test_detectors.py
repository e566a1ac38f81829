"""The fingerprint by which each method is known: a property that the others, or least squares, lack."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.special import ndtri

from estimators import Fix, PositionOptions
from estimators.gnss.methods.glrt import Glrt
from estimators.gnss.methods.greedy import Greedy
from estimators.gnss.methods.huber import TUNING
from estimators.gnss.methods.minimal_subsets import all_subsets, judge_subsets
from estimators.gnss.methods.p_ransac import PRansac
from estimators.gnss.methods.raim import Raim
from estimators.gnss.methods.ranco import Ranco, cover_faults
from tests.gnss.skies import make_sky
from tests.gnss.solving import OPTIONS, limit, located, problem_of, squares_of

SEEDS = st.integers(0, 10_000)


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
