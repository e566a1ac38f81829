"""Probability that a point follows the model, from its residual alone."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from benchmarks.coverage import calibration_error
from estimators.inference.probability import inlier_probability

RESIDUALS = hnp.arrays(np.float64, st.integers(1, 60), elements=st.floats(-1e6, 1e6))


@settings(max_examples=200, deadline=None)
@given(residual=RESIDUALS, sigma=st.floats(1e-6, 1e3))
def test_probabilities_lie_between_0_and_1_and_fall_with_the_residual_on_either_side(
    residual: np.ndarray, sigma: float
) -> None:
    z = inlier_probability(residual, None, sigma)
    assert ((z >= 0.0) & (z <= 1.0)).all()
    for side in (residual > 0.0, residual <= 0.0):
        order = np.argsort(np.abs(residual[side]))
        assert (np.diff(z[side][order]) <= 1e-12).all()


@settings(max_examples=100, deadline=None)
@given(residual=RESIDUALS, scale=st.sampled_from([2.0**-30, 0.5, 2.0**40]))
def test_the_unit_of_the_residuals_is_arbitrary(residual: np.ndarray, scale: float) -> None:
    # A residual that underflows in one of the units changes sides.
    residual = np.where(np.abs(residual) < 1e-200, 0.0, residual)
    np.testing.assert_allclose(
        inlier_probability(scale * residual, None, scale), inlier_probability(residual, None, 1.0), rtol=1e-9
    )


def test_weights_whiten_the_residuals() -> None:
    rng = np.random.default_rng(0)
    residual, root = rng.normal(size=50), rng.uniform(0.5, 2.0, 50)
    np.testing.assert_array_equal(
        inlier_probability(residual, root, 1.0), inlier_probability(residual * root, None, 1.0)
    )


def test_stated_probabilities_are_the_shares_that_come_true() -> None:
    rng = np.random.default_rng(1)
    truth = rng.random(20_000) < 0.6
    residual = np.where(truth, rng.normal(size=20_000), rng.uniform(-15.0, 15.0, 20_000))
    z = inlier_probability(residual, None, 1.0)
    for low in (0.2, 0.4, 0.6, 0.8):
        bin_ = (z >= low) & (z < low + 0.2)
        assert truth[bin_].mean() == pytest.approx(z[bin_].mean(), abs=0.06)
    assert z.mean() == pytest.approx(0.6, abs=0.02)


def _calibration(truth: np.ndarray, residual: np.ndarray) -> float:
    z = inlier_probability(residual, None, 1.0)
    return calibration_error(z, truth)


def test_errors_that_keep_away_from_the_model_cast_no_doubt_on_its_followers() -> None:
    rng = np.random.default_rng(2)
    truth = rng.random(5_000) < 0.5
    residual = np.where(truth, rng.normal(size=5_000), 5.0 + rng.exponential(15.0, 5_000))
    z = inlier_probability(residual, None, 1.0)
    assert z[truth].mean() > 0.98
    assert z[~truth].mean() < 0.01


def test_heavy_tails_are_told_from_errors_by_how_they_thin_out() -> None:
    rng = np.random.default_rng(3)
    truth = rng.random(5_000) < 0.8
    residual = np.where(truth, rng.standard_t(2, 5_000), rng.uniform(-60.0, 60.0, 5_000))
    assert _calibration(truth, residual) < 0.02
    z = inlier_probability(residual, None, 1.0)
    near = truth & (np.abs(residual) > 3.0) & (np.abs(residual) < 5.0)
    assert z[near].mean() > 0.6


def test_a_gross_error_among_heavy_tails_is_still_an_error() -> None:
    residual = np.append(np.random.default_rng(4).standard_t(2, 300), 1e9)
    assert inlier_probability(residual, None, 1.0)[-1] < 1e-9


def test_a_clean_series_is_hardly_doubted() -> None:
    z = inlier_probability(np.random.default_rng(5).normal(size=50), None, 1.0)
    assert z.mean() > 0.98


@pytest.mark.parametrize("points", [1, 2, 3])
def test_few_residuals_have_probabilities_too(points: int) -> None:
    z = inlier_probability(np.linspace(-0.5, 0.5, points), None, 1.0)
    assert ((z > 0.5) & (z < 1.0)).all()


def test_a_long_series_is_judged_by_a_part_of_it_and_answered_in_full() -> None:
    rng = np.random.default_rng(6)
    residual = np.where(rng.random(200_000) < 0.7, rng.normal(size=200_000), rng.uniform(-60, 60, 200_000))
    whole = inlier_probability(residual, None, 1.0)
    part = inlier_probability(residual[::4].copy(), None, 1.0)
    np.testing.assert_allclose(whole[::4], part, atol=0.05)


def test_a_residual_beyond_all_floats_of_the_normal_law_has_next_to_no_probability() -> None:
    assert inlier_probability(np.array([0.1, -0.2, 1e9]), None, 1.0)[2] < 1e-12


def test_the_followers_of_a_line_that_chance_drew_through_noise_leave_the_others_in_doubt() -> None:
    rng = np.random.default_rng(2)
    # Eight of fifty normal readings lie within a fiftieth of their scale of some line; none is an error.
    residual = np.concatenate([0.02 * rng.normal(size=8), rng.normal(size=42)])
    by_chance = inlier_probability(residual, None, 0.02)
    # Thirty readings do so by no chance.
    followed = np.concatenate([0.02 * rng.normal(size=30), rng.normal(size=20)])
    in_earnest = inlier_probability(followed, None, 0.02)
    assert by_chance[8:].mean() > 0.1
    assert in_earnest[30:].mean() < 0.1
    assert in_earnest[:30].min() > 0.8


def test_few_followers_among_errors_far_away_are_believed() -> None:
    rng = np.random.default_rng(3)
    residual = np.concatenate([rng.normal(size=15), rng.uniform(-60.0, 60.0, 35)])
    z = inlier_probability(residual, None, 1.0)
    assert z[:15].mean() > 0.8
    assert z[np.abs(residual) > 8.0].max() < 0.2


def _clean_t2(n: int, draws: int, seed: int) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    return [inlier_probability(rng.standard_t(2, n), None, 1.0) for _ in range(draws)]


@pytest.mark.parametrize(("n", "doubt"), [(50, 0.05), (200, 0.02), (1000, 0.01)])
def test_clean_heavy_tails_are_believed_the_more_the_more_of_them_there_are(n: int, doubt: float) -> None:
    assert np.mean([1.0 - z.mean() for z in _clean_t2(n, 40, 7)]) < doubt


def test_the_farthest_reading_of_clean_heavy_tails_is_believed_where_the_others_lead_up_to_it() -> None:
    assert np.median([z.min() for z in _clean_t2(1000, 40, 8)]) > 0.9


@pytest.mark.parametrize("sides", [(1.0, 1.0), (1.0, -1.0)])
def test_two_spikes_among_near_normal_readings_are_no_tail(sides: tuple[float, float]) -> None:
    rng = np.random.default_rng(9)
    spikes = 30.0 * np.array(sides)
    z = [inlier_probability(np.append(rng.normal(size=98), spikes), None, 1.0) for _ in range(20)]
    assert np.mean([row[-2:].max() for row in z]) < 0.05
    assert max(row[-2:].max() for row in z) < 0.5
    assert min(row[:98].mean() for row in z) > 0.98


def test_a_lone_spike_is_doubted_the_more_the_more_readings_show_no_tail() -> None:
    rng = np.random.default_rng(10)
    spike = [
        np.mean([inlier_probability(np.append(rng.normal(size=n), 20.0), None, 1.0)[-1] for _ in range(20)])
        for n in (20, 200, 1000)
    ]
    assert spike[0] < 0.6
    assert spike[1] < 0.5 * spike[0]
    assert spike[2] < 0.01


def test_a_few_errors_in_a_long_heavy_tailed_series_are_not_believed_because_the_bulk_fits_no_law_well() -> (
    None
):
    rng = np.random.default_rng(11)
    truth = np.arange(10_000) >= 100
    residual = np.where(truth, rng.standard_t(3, 10_000), rng.uniform(30.0, 60.0, 10_000))
    z = inlier_probability(residual, None, 1.0)
    assert z[~truth].max() < 0.1
    assert z[truth].mean() > 0.97
