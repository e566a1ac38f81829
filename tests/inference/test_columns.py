"""The sandwich variance of a model of any number of columns."""

import numpy as np
import pytest

from estimators.consensus.found import Found, LinearData, Scale
from estimators.consensus.presets import PRESETS
from estimators.inference.columns import ColumnUncertainty, column_uncertainty
from estimators.inference.sandwich import line_uncertainty
from estimators.options import RobustOptions
from estimators.regression.column_influence import column_influence, neighbour_products
from estimators.regression.influence import influence_sums
from estimators.regression.loss import Loss, LossKind


def fitted(method: str, noise: np.ndarray[tuple[int], np.dtype[np.float64]]) -> tuple[LinearData, Found]:
    t = np.linspace(-1.0, 1.0, noise.size)
    data = LinearData(np.vstack([np.ones(t.size), t]), 2.0 * t + noise, t, None)
    found = PRESETS[method].search.run(data, Scale(None, "", None, "", 1e-12), RobustOptions(), 0)
    assert isinstance(found, Found)
    return data, found


def spread_of(data: LinearData, found: Found, *, correct: bool) -> ColumnUncertainty:
    sums = influence_sums(data.t, data.y, found.residual, None, found.sigma, found.threshold, found.loss)
    spread = column_uncertainty(data.columns, found, None, sums, correct_serial_correlation=correct)
    assert spread is not None
    return spread


def test_the_matrices_are_those_of_the_definition() -> None:
    rng = np.random.default_rng(0)
    columns, residual = rng.normal(size=(3, 40)), rng.normal(size=40)
    loss = Loss(LossKind.bisquare, 4.685)
    made = column_influence(columns, residual, None, 0.7, loss)
    u = residual / 0.7
    assert made.curvature == pytest.approx((columns * loss.psi_slope(u)) @ columns.T)
    assert made.scatter == pytest.approx((columns * loss.psi(u) ** 2) @ columns.T)
    assert made.weight == pytest.approx((columns * loss.psi(u) / u) @ columns.T)


def test_neighbour_products_are_the_double_sum() -> None:
    rng = np.random.default_rng(1)
    columns, roots, rho = rng.normal(size=(2, 15)), rng.uniform(0.0, 1.0, 15), 0.6
    lag = np.abs(np.subtract.outer(np.arange(15), np.arange(15)))
    carried = np.where(lag > 0, rho**lag, 0.0) * np.outer(roots, roots)
    assert neighbour_products(columns, roots, rho) == pytest.approx(columns @ carried @ columns.T)


@pytest.mark.parametrize("method", ["auto", "msac", "mm", "ols"])
def test_of_a_line_it_is_the_lines_own_variance(method: str) -> None:
    noise = np.random.default_rng(2).normal(size=200)
    t = np.linspace(-1.0, 1.0, 200)
    data = LinearData(np.vstack([np.ones(200), t]), 2.0 * t + noise, t, None)
    found = PRESETS[method].search.run(data, Scale(1.0, "given", 2.7, "given", 1e-12), RobustOptions(), 0)
    assert isinstance(found, Found)
    sums = influence_sums(data.t, data.y, found.residual, None, found.sigma, found.threshold, found.loss)
    line = line_uncertainty(sums, 200, found.sigma, correct_serial_correlation=False)
    assert line is not None
    spread = spread_of(data, found, correct=False)
    assert spread.stderr(np.array([[0.0, 1.0]]))[0] == pytest.approx(np.sqrt(line.slope_variance), rel=0.02)
    assert spread.dof == pytest.approx(line.dof, rel=0.02)


def test_correlated_noise_widens_slow_columns_and_not_fast_ones() -> None:
    rng = np.random.default_rng(3)
    noise = rng.normal(size=600)
    for i in range(1, 600):
        noise[i] += 0.8 * noise[i - 1]
    t = np.linspace(-1.0, 1.0, 600)
    columns = np.vstack([np.ones(600), t, np.cos(np.pi * np.arange(600) * 0.9)])
    data = LinearData(columns, noise, t, None)
    found = PRESETS["ols"].search.run(data, Scale(None, "", None, "", 1e-12), RobustOptions(), 0)
    assert isinstance(found, Found)
    independent, corrected = spread_of(data, found, correct=False), spread_of(data, found, correct=True)
    ratio = corrected.stderr(np.eye(3)) / independent.stderr(np.eye(3))
    assert ratio[1] > 2.0
    assert ratio[2] < 0.6
    assert 50.0 < corrected.effective_n < 120.0


def test_as_many_inliers_as_coefficients_leave_no_uncertainty() -> None:
    data, found = fitted("ols", np.zeros(2))
    sums = influence_sums(data.t, data.y, found.residual, None, found.sigma, found.threshold, found.loss)
    assert column_uncertainty(data.columns, found, None, sums) is None
