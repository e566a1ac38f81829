import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks import metrics
from benchmarks.bed import draw_rng, make_series

VALUES = st.floats(-50.0, 50.0)


def _clean(index: int = 0):
    return make_series("uniform", 60, 0.5, draw_rng(5, "uniform", 60, 0.5, index))


def test_the_oracle_is_least_squares_on_the_true_inliers() -> None:
    draw = _clean()
    slope, intercept = np.polyfit(draw.t[draw.inlier_mask], draw.y[draw.inlier_mask], 1)
    wanted = metrics.line_errors(slope, intercept, draw)
    np.testing.assert_allclose(metrics.oracle(draw).errors, wanted, atol=1e-9)


def test_the_oracle_scatters_as_its_standard_errors_say() -> None:
    oracles = [metrics.oracle(_clean(index)) for index in range(600)]
    standardised = np.array([item.errors / item.stderr for item in oracles])
    # The standard deviation of 600 normal numbers has a standard error of 2.9 %.
    np.testing.assert_allclose(standardised.std(axis=0), 1.0, atol=0.12)


def test_the_true_line_has_no_error() -> None:
    draw = _clean()
    assert metrics.line_errors(draw.truth_slope, draw.truth_intercept, draw).tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("errors", "stderr", "wrong"),
    [
        ([0.9, -0.9], [0.1, 0.1], False),
        ([0.0, 1.1], [0.1, 0.1], True),
        ([0.0, 1.1], [0.1, 0.3], False),
        ([-1.6, 0.0], [0.3, 0.3], True),
        ([np.nan, np.nan], [0.3, 0.3], True),
    ],
)
def test_a_line_fails_beyond_one_sigma_and_five_oracle_errors(
    errors: list[float], stderr: list[float], wrong: bool
) -> None:
    assert metrics.failed(np.array([errors]), np.array([stderr])).tolist() == [wrong]


@given(first=VALUES, last=VALUES)
def test_the_mean_square_is_the_integral_of_the_squared_line(first: float, last: float) -> None:
    x = np.linspace(0.0, 1.0, 20_001)
    integral = np.mean((first + (last - first) * x) ** 2)
    wanted = metrics.mean_square(np.array([[first, last]]))[0]
    assert wanted == pytest.approx(integral, rel=1e-3, abs=1e-9)


def test_the_oracle_is_one_oracle() -> None:
    errors = np.random.default_rng(1).normal(size=(40, 2))
    counts = np.full(40, 30.0)
    assert metrics.rms_over_oracle(errors, errors, counts) == 1.0
    assert metrics.rms_over_oracle(3.0 * errors, errors, counts) == pytest.approx(3.0)


def test_flags_that_hit_half_and_err_once_have_the_f1_of_their_counts() -> None:
    inlier = np.array([True, True, True, False, False, False, False])
    flagged = np.array([True, False, False, True, True, False, False])
    assert metrics.flag_f1(flagged, inlier) == pytest.approx(2 * 2 / (2 * 2 + 1 + 2))


def test_perfect_flags_have_f1_one_and_clean_data_have_none() -> None:
    inlier = np.array([True, False, True])
    assert metrics.flag_f1(~inlier, inlier) == 1.0
    assert np.isnan(metrics.flag_f1(np.zeros(3, dtype=bool), np.ones(3, dtype=bool)))


def test_an_interval_that_is_not_given_covers_nothing() -> None:
    low, high = np.array([0.0, 0.5, np.nan]), np.array([1.0, 1.0, np.nan])
    assert metrics.covers(low, high, np.full(3, 0.4)).tolist() == [True, False, False]
