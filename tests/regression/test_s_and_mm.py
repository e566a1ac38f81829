"""S- and MM-estimates."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.regression.minimal_fits import solve_samples
from estimators.regression.mm import mm_estimate
from estimators.regression.s_estimator import SCREENED_POINTS, s_estimate
from estimators.regression.scale_equation import S_TUNING, solve_scale


def line_columns(t: np.ndarray) -> np.ndarray:
    return np.vstack([np.ones_like(t), t])


def all_pairs(columns: np.ndarray, y: np.ndarray) -> np.ndarray:
    pairs = np.array(list(itertools.combinations(range(y.size), 2)), dtype=np.int64).reshape(-1, 2)
    return solve_samples(columns, y, pairs)


def drawn_pairs(columns: np.ndarray, y: np.ndarray, rng: np.random.Generator, count: int = 60) -> np.ndarray:
    return solve_samples(columns, y, np.array([rng.choice(y.size, 2, replace=False) for _ in range(count)]))


def mean_rho(residual: np.ndarray, scale: float) -> float:
    v = np.minimum((residual / (S_TUNING * scale)) ** 2, 1.0)
    return float(np.sum(1 - (1 - v) ** 3)) / (residual.size - 2)


@given(st.integers(3, 60), st.integers(0, 10_000), st.floats(1e-8, 1e8))
@settings(deadline=None)
def test_the_scale_solves_its_equation(n: int, seed: int, unit: float) -> None:
    residual = unit * np.random.default_rng(seed).standard_t(2, size=n)
    scale = solve_scale(residual, np.ones(n), 0.5 * (n - 2), unit, 1e-20)
    assert mean_rho(residual, scale) == pytest.approx(0.5, abs=1e-9)


def test_the_s_estimate_has_a_scale_at_which_the_mean_loss_is_one_half() -> None:
    rng = np.random.default_rng(0)
    t = np.sort(rng.uniform(-1, 1, 40))
    y = 1 + 2 * t + 0.1 * rng.normal(size=40)
    y[:12] += 5
    columns = line_columns(t)
    fit = s_estimate(columns, y, starts=all_pairs(columns, y), floor=1e-12)
    assert mean_rho(fit.residual, fit.sigma) == pytest.approx(0.5, abs=1e-9)
    assert not fit.is_exact


def test_no_pair_and_no_neighbour_has_a_smaller_scale_than_the_s_estimate() -> None:
    rng = np.random.default_rng(4)
    t = np.sort(rng.uniform(-1, 1, 25))
    y = 1 + 2 * t + 0.3 * rng.normal(size=25)
    columns = line_columns(t)
    starts = all_pairs(columns, y)
    fit = s_estimate(columns, y, starts=starts, floor=1e-12)

    def scale(theta: np.ndarray) -> float:
        return solve_scale(y - theta @ columns, np.ones(25), 11.5, 1.0, 1e-12)

    nearby = fit.theta + 0.05 * rng.normal(size=(200, 2))
    assert fit.sigma <= min(scale(theta) for theta in np.vstack([starts, nearby])) * (1 + 1e-10)


def test_half_of_the_points_on_a_line_make_the_scale_stand_at_its_floor() -> None:
    t = np.arange(9.0) / 4 - 1
    y = 1 + 2 * t
    y[[1, 4, 6]] = [40.0, -7.0, 13.0]
    columns = line_columns(t)
    fit = s_estimate(columns, y, starts=all_pairs(columns, y), floor=1e-13)
    assert fit.is_exact
    assert fit.sigma == 1e-13
    assert fit.theta == pytest.approx([1.0, 2.0], abs=1e-13)


def test_among_exact_fits_the_one_through_most_points_is_taken() -> None:
    # Six readings at one time agree, so that every line through them has scale zero; one passes two more.
    t = np.array([0.0, 0, 0, 0, 0, 0, 0.5, 0.75, 1.0])
    y = np.array([1.0, 1, 1, 1, 1, 1, 2.0, 2.5, -9.0])
    columns = line_columns(t)
    fit = mm_estimate(columns, y, starts=all_pairs(columns, y), floor=1e-13)
    assert fit.theta == pytest.approx([1.0, 2.0], abs=1e-12)


def test_an_mm_estimate_is_95_percent_efficient_at_the_normal_law() -> None:
    rng = np.random.default_rng(20)
    n, draws = 100, 3000
    t = np.linspace(-1, 1, n)
    columns = line_columns(t)
    robust, least = np.empty(draws), np.empty(draws)
    for k in range(draws):
        y = rng.normal(size=n)
        robust[k] = mm_estimate(columns, y, starts=np.zeros((1, 2)), floor=1e-12).theta[1]
        least[k] = np.sum(t * y) / np.sum(t * t)
    # Both see the same noise, so that their ratio is known better than either variance.
    assert np.var(least) / np.var(robust) == pytest.approx(0.95, abs=0.02)


@pytest.mark.parametrize("seed", range(4))
def test_an_mm_estimate_holds_at_45_percent_outliers(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 200
    t = np.sort(rng.uniform(-1, 1, n))
    y = 1 + 2 * t + 0.1 * rng.normal(size=n)
    bad = rng.permutation(n)[: int(0.45 * n)]
    y[bad] = rng.uniform(20, 30, bad.size)
    columns = line_columns(t)
    fit = mm_estimate(columns, y, starts=drawn_pairs(columns, y, rng), floor=1e-12)
    assert fit.theta == pytest.approx([1.0, 2.0], abs=0.1)


@pytest.mark.parametrize("seed", range(2))
def test_many_points_are_screened_on_a_part_and_fitted_on_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 10 * SCREENED_POINTS
    t = np.sort(rng.uniform(-1, 1, n))
    y = 1 + 2 * t + 0.1 * rng.normal(size=n)
    y[rng.permutation(n)[: int(0.4 * n)]] = 5.0
    columns = line_columns(t)
    fit = mm_estimate(columns, y, starts=drawn_pairs(columns, y, rng), floor=1e-12)
    assert fit.theta == pytest.approx([1.0, 2.0], abs=0.01)
    assert mean_rho(fit.initial.residual, fit.initial.sigma) == pytest.approx(0.5, abs=1e-9)


@given(st.integers(0, 1000), st.integers(-40, 40), st.floats(-100, 100), st.floats(-100, 100))
@settings(deadline=None, max_examples=40)
def test_the_fit_moves_with_the_values(seed: int, power: int, level: float, slope: float) -> None:
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(-1, 1, 20))
    y = rng.standard_t(3, size=20)
    columns = line_columns(t)
    once = mm_estimate(columns, y, starts=all_pairs(columns, y), floor=1e-13)
    moved = 2.0**power * (y + level + slope * t)
    again = mm_estimate(columns, moved, starts=all_pairs(columns, moved), floor=2.0**power * 1e-13)
    assert again.theta / 2.0**power == pytest.approx(once.theta + np.array([level, slope]), abs=1e-8)
    assert again.sigma / 2.0**power == pytest.approx(once.sigma, rel=1e-9)


def test_weights_are_precisions() -> None:
    rng = np.random.default_rng(2)
    n = 400
    t = np.linspace(-1, 1, n)
    weights = np.where(np.arange(n) % 2 == 0, 0.02, 1.98)
    y = 1 + 2 * t + 0.1 * rng.normal(size=n) / np.sqrt(weights)
    columns = line_columns(t)
    starts = drawn_pairs(columns, y, rng)
    weighted = mm_estimate(columns, y, weights, starts=starts, floor=1e-12)
    assert weighted.sigma == pytest.approx(0.1, rel=0.1)
    assert weighted.theta == pytest.approx([1.0, 2.0], abs=0.03)


def test_degenerate_samples_have_no_exact_fit() -> None:
    t = np.array([0.0, 0.0, 1.0])
    fits = solve_samples(line_columns(t), np.array([1.0, 2.0, 4.0]), np.array([[0, 1], [0, 2], [1, 2]]))
    assert fits.tolist() == [[1.0, 3.0], [2.0, 2.0]]


@given(st.integers(1, 6), st.integers(0, 1000))
@settings(deadline=None)
def test_exact_fits_pass_through_their_samples(p: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    columns = np.vstack([np.ones(12), rng.uniform(-1, 1, (p - 1, 12))])
    y = rng.normal(size=12)
    sample = rng.choice(12, p, replace=False)
    (theta,) = solve_samples(columns, y, sample[None, :])
    assert theta @ columns[:, sample] == pytest.approx(y[sample], abs=1e-8 * (1 + np.abs(theta).max()))
