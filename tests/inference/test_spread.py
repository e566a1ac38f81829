"""Axes of a covariance, and uncertainties exchanged along them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators.inference.columns import ColumnUncertainty
from estimators.inference.sandwich import LineUncertainty
from estimators.inference.spread import covariance_from_axes, uncorrelated_axes


def _covariance(seed: int, p: int) -> np.ndarray:
    root = np.random.default_rng(seed).normal(size=(p, p + 3)) * 10.0 ** np.arange(p)[:, None]
    return root @ root.T


@given(seed=st.integers(0, 10_000), p=st.integers(1, 8))
def test_axes_are_uncorrelated_and_the_first_is_the_one_asked_for(seed: int, p: int) -> None:
    covariance = _covariance(seed, p)
    first = np.random.default_rng([seed, 1]).normal(size=p)
    axes = uncorrelated_axes(covariance, first)
    np.testing.assert_array_equal(axes[0], first)
    along = axes @ covariance @ axes.T
    scale = np.sqrt(np.diag(along))
    np.testing.assert_allclose(along / np.outer(scale, scale), np.eye(p), atol=1e-6)
    np.testing.assert_allclose(covariance_from_axes(axes, along) / covariance, 1.0, rtol=1e-4)


def test_a_line_and_columns_say_the_same_of_the_same_covariance() -> None:
    line = LineUncertainty("effective-n", 0.3, 2.0, 5.0, 40.0, 0.1, 30.0)
    matrix = covariance_from_axes(line.axes, np.diag([5.0, 2.0]))
    columns = ColumnUncertainty("effective-n", matrix, matrix, 40.0, 0.1, 30.0)
    directions = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 0.3], [1.0, -1.0]])
    np.testing.assert_allclose(line.stderr(directions), columns.stderr(directions))


@pytest.mark.parametrize("correlation", [0.0, 0.6])
def test_a_covariance_along_axes_comes_back(correlation: float) -> None:
    line = LineUncertainty("effective-n", 0.3, 2.0, 5.0, 40.0, 0.1, 30.0)
    off = correlation * np.sqrt(18.0 * 3.0)
    given_along = np.array([[18.0, off], [off, 3.0]])
    for spread in (line, ColumnUncertainty("effective-n", np.eye(2), np.eye(2), 40.0, 0.1, 30.0)):
        moved = spread.along(line.axes, given_along, "hac", 12.0, 7.0)
        np.testing.assert_allclose(moved.stderr(line.axes) ** 2, [18.0, 3.0])
        both = moved.stderr(line.axes.sum(axis=0, keepdims=True))[0] ** 2
        assert both == pytest.approx(21.0 + 2.0 * off)
        assert (moved.method, moved.effective_n, moved.lag1, moved.dof) == ("hac", 12.0, 0.1, 7.0)
