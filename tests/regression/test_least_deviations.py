import numpy as np
import pytest
from scipy.optimize import linprog

from estimators.regression.least_deviations import least_deviations


def contaminated(rows: int = 60, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    columns = np.vstack([np.ones(rows), random.uniform(-1.0, 1.0, (2, rows))])
    y = np.array([1.0, 2.0, -3.0]) @ columns + 0.1 * random.standard_normal(rows)
    y[::4] += 20.0
    return columns, y


@pytest.mark.parametrize("seed", range(5))
def test_the_sum_of_deviations_is_nearly_that_of_the_linear_program(seed: int) -> None:
    columns, y = contaminated(seed=seed)
    p, n = columns.shape
    # min sum(u + v) with theta @ columns + u - v = y; u, v >= 0.
    program = linprog(
        np.r_[np.zeros(p), np.ones(2 * n)],
        A_eq=np.hstack([columns.T, np.eye(n), -np.eye(n)]),
        b_eq=y,
        bounds=[(None, None)] * p + [(0, None)] * (2 * n),
    )
    found = np.sum(np.abs(y - least_deviations(columns, y) @ columns))
    assert program.fun <= found <= 1.001 * program.fun


def test_vertical_outliers_hardly_move_it() -> None:
    columns, y = contaminated()
    np.testing.assert_allclose(least_deviations(columns, y), [1.0, 2.0, -3.0], atol=0.15)


def test_a_weight_counts_by_its_square_root() -> None:
    columns, y = contaminated(30)
    twice = np.concatenate([columns, columns[:, ::3]], axis=1), np.concatenate([y, y[::3]])
    weights = np.where(np.arange(30) % 3 == 0, 4.0, 1.0)
    np.testing.assert_allclose(least_deviations(columns, y, weights), least_deviations(*twice), atol=0.02)


@pytest.mark.parametrize("factor", [1e-100, 1e-9, 1e9, 1e50])
def test_the_unit_of_the_values_changes_only_the_unit_of_the_answer(factor: float) -> None:
    columns, y = contaminated()
    np.testing.assert_allclose(
        least_deviations(columns, factor * y) / factor, least_deviations(columns, y), rtol=1e-6
    )


def test_an_exact_fit_is_kept() -> None:
    columns, _ = contaminated()
    theta = np.array([0.5, -1.0, 4.0])
    np.testing.assert_allclose(least_deviations(columns, theta @ columns), theta, rtol=1e-12)
