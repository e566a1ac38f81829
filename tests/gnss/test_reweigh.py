"""Weights of ranges that agree less than the others: what they solve, what they cost, what they mend."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.stats import norm

from estimators.gnss.snapshot.reweigh import TUNING, reweigh
from tests.gnss.skies import make_sky
from tests.gnss.solving import located

SEEDS = st.integers(0, 10_000)


def design(seed: int, n: int = 12, p: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Whitened design, and residuals that least squares leaves of Gaussian noise with one gross value."""
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(n, p))
    z = rng.normal(size=n)
    z[0] += 8.0
    return A, z - A @ np.linalg.lstsq(A, z, rcond=None)[0]


def reweighed(A: np.ndarray, z: np.ndarray, used: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Move and weights."""
    state, weight = np.zeros(A.shape[1]), np.empty(z.size)
    reweigh(A, z, np.ones(z.size, dtype=np.bool_) if used is None else used, state, weight)
    return state, weight


@settings(deadline=None)
@given(SEEDS)
def test_state_and_scale_solve_hubers_equations_together(seed: int) -> None:
    A, z = design(seed)
    state, weight = reweighed(A, z)
    residual = z - A @ state
    # Least squares can hide a gross value of great leverage.
    assume(weight.min() < 1.0)
    scale = np.max(weight[weight < 1.0] * np.abs(residual[weight < 1.0])) / TUNING
    bounded = np.clip(residual / scale, -TUNING, TUNING)
    np.testing.assert_allclose(A.T @ bounded, 0.0, atol=1e-4)
    inside = norm.expect(lambda u: u * u, lb=-TUNING, ub=TUNING)
    beta = inside + 2.0 * TUNING**2 * norm.sf(TUNING)
    assert np.sum(bounded**2) == pytest.approx(beta * (z.size - 4), rel=1e-3)


@settings(deadline=None)
@given(SEEDS, st.floats(0.01, 100.0))
def test_the_unit_of_the_noise_does_not_matter(seed: int, unit: float) -> None:
    A, z = design(seed)
    state, weight = reweighed(A, z)
    scaled, same = reweighed(A / unit, z / unit)
    np.testing.assert_allclose(scaled, state, atol=1e-4)
    np.testing.assert_allclose(same, weight, atol=1e-4)


@settings(deadline=None)
@given(SEEDS, st.integers(4, 6))
def test_two_redundant_ranges_cannot_tell_which_errs(seed: int, n: int) -> None:
    A, z = design(seed, n)
    state, weight = reweighed(A, z)
    assert not state.any()
    assert (weight == 1.0).all()


@settings(deadline=None)
@given(SEEDS)
def test_ranges_that_are_not_used_have_no_say(seed: int) -> None:
    A, z = design(seed)
    used = np.arange(z.size) != 3
    state, weight = reweighed(A, z, used)
    alone, others = reweighed(np.ascontiguousarray(A[used]), z[used])
    assert weight[3] == 0.0
    np.testing.assert_array_equal(state, alone)
    np.testing.assert_array_equal(weight[used], others)


def test_gaussian_noise_costs_little() -> None:
    errors = {"auto": 0.0, "ols": 0.0}
    for seed in range(300):
        sky = make_sky(12, seed)
        for method in errors:
            error = located(sky, method).error_enu_m(sky.truth_m)
            errors[method] += float(error[0] ** 2 + error[1] ** 2)
    # 95 % efficiency is for very many ranges; with few the weights have less to go by and do less.
    assert errors["auto"] < 1.05 * errors["ols"]


def test_an_error_too_small_to_be_a_fault_moves_the_position_less_than_least_squares() -> None:
    apart = {"auto": [], "ols": []}
    for seed in range(60):
        sky = make_sky(11, seed, noise=0.15)
        wrong = sky.with_faults({4: 4.0})
        for method, found in apart.items():
            fix = located(wrong, method)
            assert fix.excluded == ()
            found.append(np.linalg.norm(fix.error_enu_m(sky.truth_m)))
    assert np.median(apart["auto"]) < 0.7 * np.median(apart["ols"])


def test_a_fix_says_what_each_range_counts() -> None:
    sky = make_sky(11, 2, noise=0.15).with_faults({4: 4.0, 7: 300.0})
    weight = located(sky, "auto").satellites.weight
    assert weight[7] == 0.0
    assert 0.0 < weight[4] < 1.0
    assert weight[4] == np.min(weight[weight > 0.0])
    assert set(located(sky, "glrt").satellites.weight) == {0.0, 1.0}


def test_weights_leave_the_tests_of_an_epoch_to_least_squares() -> None:
    sky = make_sky(11, 2, noise=0.15).with_faults({4: 4.0})
    weighed, plain = located(sky, "auto"), located(sky, "ols")
    assert np.linalg.norm(weighed.position_ecef_m - plain.position_ecef_m) > 0.1
    assert weighed.global_test.statistic == pytest.approx(plain.global_test.statistic, rel=1e-6)
    np.testing.assert_allclose(weighed.satellites.statistic, plain.satellites.statistic, rtol=1e-5, atol=1e-6)
    assert weighed.sigma_scale == pytest.approx(plain.sigma_scale, rel=1e-6)
