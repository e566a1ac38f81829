"""Uncertainty from groups of points."""

from __future__ import annotations

import numpy as np
import pytest

from estimators.arrays import FloatArray
from estimators.regression.group_uncertainty import (
    delete_group_jackknife,
    group_uncertainty,
    interpenetrating_groups,
)
from estimators.regression.least_squares import least_squares


def mean_of(_: FloatArray, y: FloatArray) -> FloatArray:
    return np.array([y.mean()])


def line_of(t: FloatArray, y: FloatArray) -> FloatArray:
    return least_squares(np.vstack([np.ones_like(t), t]), y)[0]


def test_deleting_points_one_by_one_gives_the_standard_error_of_a_mean_exactly() -> None:
    y = np.random.default_rng(0).normal(size=12)
    found = delete_group_jackknife(mean_of, np.arange(12.0), y)
    assert found is not None
    assert found.stderr[0] == pytest.approx(np.std(y, ddof=1) / np.sqrt(12))
    assert found.dof == 11.0


@pytest.mark.parametrize("method", [delete_group_jackknife, interpenetrating_groups])
def test_groups_give_the_covariance_of_a_line_on_average(method: object) -> None:
    rng = np.random.default_rng(1)
    t = np.linspace(0, 1, 400)
    columns = np.vstack([np.ones(400), t])
    expected = np.linalg.inv(columns @ columns.T)
    average = np.mean(
        [method(line_of, t, rng.normal(size=400)).covariance for _ in range(300)],  # type: ignore[operator]
        axis=0,
    )
    assert average == pytest.approx(expected, rel=0.1)


def test_large_series_are_split_and_small_ones_are_thinned() -> None:
    sizes: list[int] = []

    def spy(t: FloatArray, y: FloatArray) -> FloatArray:
        sizes.append(t.size)
        return mean_of(t, y)

    for n in (999, 1000):
        group_uncertainty(spy, np.arange(float(n)), np.arange(float(n)))
    assert max(sizes[20:]) == 50
    assert min(sizes[:20]) > 900


@pytest.mark.parametrize("n", [2, 3])
def test_too_few_points_to_leave_any_out_have_no_uncertainty(n: int) -> None:
    assert delete_group_jackknife(line_of, np.arange(float(n)), np.arange(float(n))) is None


def test_a_fit_that_hangs_on_one_point_has_no_uncertainty() -> None:
    t = np.array([0.0, 0.0, 0.0, 0.0, 1.0])
    assert delete_group_jackknife(line_of, t, np.arange(5.0)) is None
