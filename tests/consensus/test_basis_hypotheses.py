"""Hypotheses for models of many columns: stretches of a series, and the shortlist of different curves."""

from collections.abc import Callable

import numpy as np
import pytest

from benchmarks.kinds import add_runs, contiguous_runs, excursion_levels
from estimators.arrays import FloatArray
from estimators.consensus.bases.stretches import STRETCHES, stretch_hypotheses
from estimators.consensus.found import Found, LinearData, Scale
from estimators.consensus.search import basis
from estimators.consensus.search.basis import BasisSearch
from estimators.options import RobustOptions
from estimators.trends.bases.design import polynomial_columns, season_columns

NOTHING_KNOWN = Scale(None, "given", None, "given", 1e-12)


def sharp_season(t: FloatArray) -> FloatArray:
    """Eight columns: a line and three harmonics of a season of eight cycles."""
    return np.vstack([polynomial_columns(t, 1), season_columns(8 * np.pi * t, 3)])


def bursts(seed: int) -> tuple[LinearData, FloatArray]:
    """Three runs at levels of their own, 60 % of the points."""
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(-1.0, 1.0, 100))
    columns = sharp_season(t)
    truth = rng.uniform(-20.0, 20.0, 8) @ columns
    runs = contiguous_runs(100, 60, 3, 0.3, rng)
    levels = excursion_levels(len(runs), rng, nearest=8.0, apart=15.0)
    made = add_runs(rng.normal(size=100), runs, levels, t)
    return LinearData(columns, truth + made.offset, t, None), truth


def one_sided(seed: int) -> tuple[LinearData, FloatArray]:
    """60 % of the points are too high."""
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(-1.0, 1.0, 100))
    columns = sharp_season(t)
    truth = rng.uniform(-20.0, 20.0, 8) @ columns
    y = truth + rng.normal(size=100)
    y[rng.permutation(100)[:60]] += 4.0 + rng.exponential(15.0, 60)
    return LinearData(columns, y, t, None), truth


def times_found(make: Callable[[int], tuple[LinearData, FloatArray]]) -> int:
    found = 0
    for seed in range(12):
        data, truth = make(seed)
        answer = BasisSearch().run(data, NOTHING_KNOWN, RobustOptions(), 0)
        found += isinstance(answer, Found) and bool(np.abs(data.y - answer.residual - truth).max() < 4.0)
    return found


def test_eight_columns_are_found_among_sixty_per_cent_one_sided_outliers() -> None:
    assert times_found(one_sided) >= 11


def test_eight_columns_are_found_beside_bursts_that_hold_sixty_per_cent() -> None:
    assert times_found(bursts) >= 10


def test_without_stretches_bursts_hide_the_model(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(columns: FloatArray, *_: FloatArray) -> FloatArray:
        return np.empty((0, columns.shape[0]))

    whole = times_found(bursts)
    monkeypatch.setattr(basis, "stretch_hypotheses", none)
    assert times_found(bursts) < whole


def test_stretches_of_clean_data_are_near_the_truth() -> None:
    rng = np.random.default_rng(0)
    t = np.linspace(-1.0, 1.0, 200)
    columns = polynomial_columns(t, 2)
    truth = np.array([1.0, -3.0, 2.0])
    y = truth @ columns + 0.01 * rng.normal(size=200)
    thetas = stretch_hypotheses(columns, y, t, np.ones(200))
    assert thetas.shape == (sum(STRETCHES.values()), 3)
    assert np.median(np.abs(thetas - truth).max(axis=1)) < 0.05


def test_few_points_have_no_stretches() -> None:
    t = np.linspace(-1.0, 1.0, 9)
    assert stretch_hypotheses(polynomial_columns(t, 3), t, t, np.ones(9)).shape == (0, 4)
