"""The search of ``auto`` for models of any number of columns."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.arrays import BoolArray, FloatArray
from estimators.consensus.found import Found, LinearData, Scale
from estimators.consensus.presets import PRESETS
from estimators.consensus.search.basis import BasisSearch
from estimators.options import RobustOptions
from estimators.result import NoFit
from estimators.trends.bases.design import polynomial_columns, season_columns

NOTHING_KNOWN = Scale(None, "given", None, "given", 1e-12)


def columns_of(t: FloatArray, degree: int, harmonics: int) -> FloatArray:
    """Polynomial and a season of eight cycles over [-1, 1]."""
    return np.vstack([polynomial_columns(t, degree), season_columns(8 * np.pi * t, harmonics)])


def contaminated(
    degree: int, harmonics: int, n: int, share: float, kind: str, seed: int
) -> tuple[LinearData, FloatArray, BoolArray]:
    """Data with noise of scale 1, the true curve, and which points are outliers."""
    rng = np.random.default_rng([degree, harmonics, n, seed])
    t = np.sort(rng.uniform(-1.0, 1.0, n))
    columns = columns_of(t, degree, harmonics)
    truth = rng.uniform(-20.0, 20.0, columns.shape[0]) @ columns
    outlier = np.zeros(n, dtype=np.bool_)
    outlier[rng.permutation(n)[: round(share * n)]] = True
    errors = {
        "scattered": rng.uniform(-60.0, 60.0, n),
        "one-sided": 4.0 + rng.exponential(15.0, n),
    }[kind]
    y = truth + rng.normal(size=n) + np.where(outlier, errors, 0.0)
    return LinearData(np.ascontiguousarray(columns), y, t, None), truth, outlier


def found_by_auto(data: LinearData, scale: Scale = NOTHING_KNOWN, seed: int = 0) -> Found:
    found = BasisSearch().run(data, scale, RobustOptions(), seed)
    assert isinstance(found, Found)
    return found


@pytest.mark.parametrize("kind", ["scattered", "one-sided"])
@pytest.mark.parametrize(("degree", "harmonics"), [(0, 0), (2, 0), (4, 0), (1, 1), (1, 2), (0, 3)])
def test_it_finds_the_model_among_forty_per_cent_outliers(degree: int, harmonics: int, kind: str) -> None:
    for seed in range(4):
        data, truth, outlier = contaminated(degree, harmonics, 150, 0.4, kind, seed)
        found = found_by_auto(data)
        assert np.max(np.abs(data.y - found.residual - truth)) < 2.0
        assert 0.75 < found.sigma < 1.3
        assert np.mean(found.inlier == ~outlier) > 0.93


@pytest.mark.parametrize(("degree", "harmonics"), [(2, 0), (4, 0), (1, 2)])
def test_it_finds_the_model_among_sixty_per_cent_scattered_outliers(degree: int, harmonics: int) -> None:
    for seed in range(4):
        data, truth, _ = contaminated(degree, harmonics, 400, 0.6, "scattered", seed)
        assert np.max(np.abs(data.y - found_by_auto(data).residual - truth)) < 1.5


@pytest.mark.parametrize(("degree", "harmonics"), [(0, 0), (2, 0), (1, 3)])
def test_clean_noise_is_fitted_as_least_squares_would(degree: int, harmonics: int) -> None:
    data, _, _ = contaminated(degree, harmonics, 200, 0.0, "scattered", 1)
    found = found_by_auto(data)
    least = np.linalg.lstsq(data.columns.T, data.y, rcond=None)[0]
    assert np.max(np.abs((found.theta - least) @ data.columns)) < 0.25
    assert found.inlier.mean() > 0.97


def test_the_answer_does_not_depend_on_the_seed() -> None:
    data, _, _ = contaminated(3, 0, 120, 0.3, "scattered", 0)
    assert found_by_auto(data, seed=0).theta.tobytes() == found_by_auto(data, seed=77).theta.tobytes()


def test_a_line_goes_the_way_of_lines_whatever_holds_its_columns() -> None:
    rng = np.random.default_rng(3)
    t = np.linspace(-1.0, 1.0, 80)
    data = LinearData(np.vstack([np.ones(80), t]), 2.0 + 3.0 * t + rng.normal(size=80), t, None)
    found = PRESETS["auto"].search.run(data, NOTHING_KNOWN, RobustOptions(), 0)
    assert isinstance(found, Found)
    assert found.ledger.drawn == 300


def test_a_given_noise_scale_is_kept_and_sets_the_threshold() -> None:
    data, _, _ = contaminated(2, 0, 100, 0.2, "scattered", 0)
    found = found_by_auto(data, Scale(0.8, "given", None, "given", 1e-12))
    assert (found.sigma, found.sigma_source) == (0.8, "given")
    assert found.threshold == pytest.approx(0.8 * RobustOptions().threshold_sigmas)


def test_a_given_threshold_labels_the_points() -> None:
    data, _, _ = contaminated(2, 0, 100, 0.2, "scattered", 0)
    found = found_by_auto(data, Scale(None, "given", 1.5, "given", 1e-12))
    assert found.threshold == 1.5
    assert np.array_equal(found.inlier, np.abs(found.residual) <= 1.5)


def test_exact_data_are_found_exactly() -> None:
    t = np.linspace(-1.0, 1.0, 60)
    columns = columns_of(t, 3, 0)
    theta = np.array([1.0, -2.0, 3.0, 0.5])
    y = theta @ columns
    y[::5] += 10.0
    found = found_by_auto(LinearData(columns, y, t, None))
    assert found.theta == pytest.approx(theta, abs=1e-9)
    assert np.flatnonzero(~found.inlier).tolist() == list(range(0, 60, 5))


def test_points_of_weight_next_to_nothing_have_no_say() -> None:
    rng = np.random.default_rng(5)
    t = np.linspace(-1.0, 1.0, 90)
    columns = columns_of(t, 2, 0)
    y = np.array([1.0, 2.0, 3.0]) @ columns + rng.normal(scale=0.1, size=90)
    weights = np.where(np.arange(90) < 60, 1.5, 1e-9)
    y[60:] += 5.0
    found = found_by_auto(LinearData(columns, y, t, weights))
    assert np.abs(found.residual[:60]).max() < 0.5


def test_two_curves_of_nearly_equal_support_are_both_reported() -> None:
    rng = np.random.default_rng(8)
    t = np.linspace(-1.0, 1.0, 200)
    columns = columns_of(t, 2, 0)
    second = np.arange(200) % 5 < 2
    y = np.where(second, np.array([30.0, -5.0, 4.0]) @ columns, np.array([0.0, 4.0, 9.0]) @ columns)
    found = found_by_auto(LinearData(columns, y + rng.normal(size=200), t, None))
    assert np.mean(found.inlier == ~second) > 0.95
    assert found.runner_up is not None
    assert found.runner_up.theta == pytest.approx([30.0, -5.0, 4.0], abs=1.5)


def test_too_few_points_are_refused() -> None:
    t = np.array([-1.0, 0.0, 1.0])
    refused = BasisSearch().run(
        LinearData(columns_of(t, 4, 0), t, t, None), NOTHING_KNOWN, RobustOptions(), 0
    )
    assert isinstance(refused, NoFit)


@settings(max_examples=15, deadline=None)
@given(unit=st.sampled_from([1e-9, 1e-3, 8.0, 1e7]), shift=st.floats(-50.0, 50.0), seed=st.integers(0, 20))
def test_units_and_added_curves_change_the_answer_as_they_should(
    unit: float, shift: float, seed: int
) -> None:
    data, _, _ = contaminated(2, 1, 90, 0.3, "scattered", seed)
    found = found_by_auto(data)
    added = np.full(data.p, shift)
    moved = LinearData(data.columns, (data.y + added @ data.columns) * unit, data.t, None)
    again = found_by_auto(moved, Scale(None, "given", None, "given", 1e-12 * unit))
    assert again.theta == pytest.approx((found.theta + added) * unit, abs=0.02 * found.sigma * unit)
    assert again.sigma == pytest.approx(found.sigma * unit, rel=0.02)
