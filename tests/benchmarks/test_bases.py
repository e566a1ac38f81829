"""The benchmark of models of many columns."""

import numpy as np
import pytest

from benchmarks.bases import CONTENDERS, SHAPES, Shape, draw, fit_plumbline, has_failed


@pytest.mark.parametrize("shape", SHAPES)
def test_the_truth_has_not_failed_and_another_curve_has(shape: Shape) -> None:
    t, _, truth, inlier = draw(shape, "uniform", 100, 0.4, np.random.default_rng(0))
    assert int(inlier.sum()) == 60
    assert not has_failed(shape, t, truth, truth, inlier)
    assert has_failed(shape, t, truth + 8.0, truth, inlier)
    assert has_failed(shape, t, np.full(t.size, np.nan), truth, inlier)


@pytest.mark.parametrize("name", list(CONTENDERS))
def test_every_contender_fits_clean_data(name: str) -> None:
    shape = Shape(2, 0)
    t, y, truth, inlier = draw(shape, "uniform", 100, 0.0, np.random.default_rng(1))
    assert not has_failed(shape, t, CONTENDERS[name](shape, t, y), truth, inlier)


def test_a_season_is_fitted_with_the_columns_of_the_truth() -> None:
    shape = Shape(1, 2)
    t, y, truth, inlier = draw(shape, "shift", 400, 0.4, np.random.default_rng(2))
    assert not has_failed(shape, t, fit_plumbline(shape, t, y), truth, inlier)
