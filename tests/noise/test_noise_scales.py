"""Noise scales of residuals and of differences."""

from __future__ import annotations

import numpy as np
import pytest

from estimators.noise import (
    difference_scale,
    interquartile_difference_scale,
    mad_scale,
    residual_scale,
)


def normal(n: int, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=n)


def test_the_mad_scale_is_consistent_for_the_normal_law() -> None:
    assert mad_scale(3.0 * normal(200_000)) == pytest.approx(3.0, rel=0.01)


def test_weights_are_precisions_for_the_mad_scale() -> None:
    weights = np.where(np.arange(100_000) % 2 == 0, 0.4, 1.6)
    assert mad_scale(normal(100_000) / np.sqrt(weights), weights) == pytest.approx(1.0, rel=0.02)


def test_the_residual_scale_makes_up_for_fitted_parameters() -> None:
    residual = normal(20)
    assert residual_scale(residual, parameters=2) == pytest.approx(mad_scale(residual) * 20 / 18)


@pytest.mark.parametrize("n", [1, 2])
def test_residuals_of_an_exact_fit_have_no_scale(n: int) -> None:
    assert residual_scale(np.ones(n), parameters=2) == 0.0


@pytest.mark.parametrize("scale", [difference_scale, interquartile_difference_scale])
def test_difference_scales_see_the_noise_and_not_the_trend(scale: object) -> None:
    y = 0.2 * np.arange(50_000) + 2.0 * normal(50_000)
    assert scale(y) == pytest.approx(2.0, rel=0.02)  # type: ignore[operator]


def test_the_lower_quartile_of_differences_withstands_forty_percent_outliers() -> None:
    y = normal(5_000)
    bad = np.random.default_rng(2).random(5_000) < 0.4
    y[bad] += 1000.0 * normal(int(bad.sum()), seed=3)
    assert interquartile_difference_scale(y) < 4.0
    assert difference_scale(y) > 100.0


def test_difference_scales_take_precisions() -> None:
    weights = np.tile([0.4, 0.4, 1.6, 1.6], 10_000)
    assert difference_scale(normal(40_000) / np.sqrt(weights), weights) == pytest.approx(1.0, rel=0.02)


@pytest.mark.parametrize("n", [0, 1, 2])
def test_fewer_than_three_points_have_no_difference_scale(n: int) -> None:
    assert difference_scale(np.arange(float(n))) == 0.0


def test_a_perfect_line_has_no_difference_scale() -> None:
    assert difference_scale(2.0 * np.arange(50.0)) == 0.0
