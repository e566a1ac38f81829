"""Quantisation of values and the least scale that is believed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators.noise import find_quantisation, scale_floor


@given(st.integers(-6, 6), st.integers(0, 1000))
def test_the_quantum_of_rounded_noise_is_found_in_any_unit(power: int, seed: int) -> None:
    step = 10.0**power
    y = step * np.round(np.random.default_rng(seed).normal(scale=4.0, size=300))
    found = find_quantisation(y)
    assert found.is_quantised
    assert found.quantum == pytest.approx(step, rel=1e-9)


def test_continuous_noise_is_not_quantised() -> None:
    found = find_quantisation(np.random.default_rng(0).normal(size=1000))
    assert not found.is_quantised
    assert found.tied_share == 0.0


def test_outliers_off_the_grid_do_not_hide_it() -> None:
    rng = np.random.default_rng(0)
    y = np.round(rng.normal(20.0, 1.0, 400), 1)
    y[::20] = rng.uniform(-50.0, 50.0, 20)
    assert find_quantisation(y).quantum == pytest.approx(0.1)


def test_tied_values_off_any_grid_have_no_quantum() -> None:
    y = np.repeat(np.random.default_rng(0).normal(size=50), 4)
    found = find_quantisation(y)
    assert found.tied_share == 1.0
    assert found.quantum == 0.0


def test_a_reading_recorded_twice_is_not_a_tie() -> None:
    t = np.repeat(np.arange(40.0), 2)
    assert find_quantisation(3.0 * t, t).tied_share == 0.0
    assert find_quantisation(3.0 * t).tied_share == 1.0


def test_integers_on_a_perfect_line_are_not_quantised() -> None:
    assert not find_quantisation(3.0 + 2.0 * np.arange(30.0)).is_quantised


@pytest.mark.parametrize("y", [np.empty(0), np.zeros(5), np.full(5, 7.0), np.array([1.0])])
def test_constant_values_have_no_quantum_and_a_positive_floor(y: np.ndarray) -> None:
    found = find_quantisation(y)
    assert found.quantum == 0.0
    assert scale_floor(y, found) > 0.0


def test_a_million_values_are_sampled() -> None:
    y = np.round(np.random.default_rng(0).normal(scale=3.0, size=1_000_000))
    assert find_quantisation(y).quantum == 1.0


def test_the_floor_of_continuous_values_is_their_rounding() -> None:
    y = np.array([-5.0, 1.0, 3.0])
    assert scale_floor(y) == 4.0 * np.spacing(5.0)


def test_the_floor_of_quantised_values_is_the_deviation_of_rounding() -> None:
    y = 0.5 * np.round(np.random.default_rng(0).normal(scale=4.0, size=300))
    assert scale_floor(y, find_quantisation(y)) == pytest.approx(0.5 / np.sqrt(12.0))


@given(st.integers(-300, 300))
def test_the_floor_scales_with_the_values(power: int) -> None:
    y = np.random.default_rng(0).normal(size=20)
    assert scale_floor(2.0**power * y) == 2.0**power * scale_floor(y)
