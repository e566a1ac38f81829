"""Other units and origins change the numbers of the answer as they must, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import InputError, Trend, fit_trend
from tests.trends.contaminated import contaminated, fitted

SIZES = st.floats(-9.0, 9.0).map(lambda power: 10.0**power)


def check_transformed(plain: Trend, moved: Trend, c: float, d: float, g: float, h: float) -> None:
    """``moved`` is the fit of ``c y + d`` at ``g t + h`` where ``plain`` is that of y at t."""
    slope, level = plain.parameters["slope"], plain.parameters["intercept"]
    a, b = moved.parameters["slope"], moved.parameters["intercept"]
    assert a.value == pytest.approx(c / g * slope.value, rel=1e-9, abs=1e-9 * c / g * slope.stderr)
    for bound in ("stderr", "low", "high"):
        assert getattr(a, bound) == pytest.approx(c / g * getattr(slope, bound), rel=1e-9, abs=1e-9 * c / g)
    at_zero = c * (level.value - slope.value * h / g) + d
    size = abs(c * level.value) + abs(c * slope.value * h / g) + abs(d)
    assert b.value == pytest.approx(at_zero, abs=1e-9 * size)
    assert moved.consensus.sigma == pytest.approx(c * plain.consensus.sigma, rel=1e-9)
    assert moved.rmse == pytest.approx(c * plain.rmse, rel=1e-7)
    np.testing.assert_array_equal(moved.points.inlier, plain.points.inlier)
    assert moved.points.reason == plain.points.reason
    np.testing.assert_allclose(moved.points.probability, plain.points.probability, rtol=1e-6, atol=1e-9)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 30), c=SIZES, g=SIZES)
def test_units_of_values_and_times_are_arbitrary(seed: int, c: float, g: float) -> None:
    data = contaminated(60, 0.3, seed)
    check_transformed(fitted(data.t, data.y), fitted(g * data.t, c * data.y), c, 0.0, g, 0.0)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 30), d=st.floats(-1e3, 1e3), h=st.floats(-1e4, 1e4))
def test_origins_of_values_and_times_are_arbitrary(seed: int, d: float, h: float) -> None:
    data = contaminated(60, 0.3, seed)
    check_transformed(fitted(data.t, data.y), fitted(data.t + h, data.y + d), 1.0, d, 1.0, h)


@pytest.mark.parametrize("c", [1e9, 1e-9, 1e-60, 1e-100, 1e-200, 1e-290])
@pytest.mark.parametrize("method", ["auto", "msac", "mm", "theil-sen", "siegel", "huber", "ols"])
def test_large_and_tiny_values_are_fitted_alike(method: str, c: float) -> None:
    data = contaminated(60, 0.3, 14)
    plain, scaled = fitted(data.t, data.y, method=method), fitted(data.t, c * data.y, method=method)
    for name, estimate in plain.parameters.items():
        assert scaled.parameters[name].value / c == pytest.approx(estimate.value, rel=1e-9)
        assert scaled.parameters[name].stderr / c == pytest.approx(estimate.stderr, rel=1e-7)
    assert scaled.p_value == pytest.approx(plain.p_value, rel=1e-6)
    assert scaled.r2 == pytest.approx(plain.r2, rel=1e-9)
    np.testing.assert_array_equal(scaled.points.inlier, plain.points.inlier)
    np.testing.assert_allclose(scaled.points.residual / c, plain.points.residual, atol=1e-9)
    bands, expected = scaled.predict([120.0]), plain.predict([120.0])
    assert bands.prediction_high[0] / c == pytest.approx(expected.prediction_high[0], rel=1e-9)


def test_values_with_hardly_any_digits_left_still_have_a_trend() -> None:
    data = contaminated(60, 0.3, 14)
    trend = fitted(data.t, 1e-312 * data.y)
    assert trend.parameters["slope"].value == pytest.approx(0.5e-312, rel=0.2)
    assert 0.0 < trend.p_value < 1e-6


def test_a_tiny_series_keeps_the_sigma_and_the_threshold_given_for_it() -> None:
    data = contaminated(60, 0.3, 14)
    small = 2.0**-240
    trend = fitted(data.t, small * data.y, sigma=2e-60, threshold=5e-60)
    assert (trend.consensus.sigma, trend.consensus.threshold) == (2e-60, 5e-60)


@pytest.mark.parametrize("largest", [1.01e60, -1e100, 1e300, 1.7e308])
def test_values_whose_squares_overflow_are_refused(largest: float) -> None:
    y = np.arange(20.0)
    y[7] = largest
    with pytest.raises(InputError, match="row 7 is beyond") as caught:
        fit_trend(np.arange(20.0), y)
    assert caught.value.field == "y"


@pytest.mark.parametrize("method", ["auto", "msac", "mm", "theil-sen", "siegel", "huber", "ols"])
def test_the_largest_values_and_the_extreme_times_give_numbers(method: str) -> None:
    data = contaminated(60, 0.3, 15)
    for factor, stretch in [(1e60 / np.abs(data.y).max(), 1e-30 / data.t[0]), (1e57, 1e28), (1e-280, 1e20)]:
        trend = fitted(stretch * data.t, np.clip(factor * data.y, -1e60, 1e60), method=method)
        for estimate in trend.parameters.values():
            assert np.isfinite([estimate.value, estimate.stderr, estimate.low, estimate.high]).all()
        assert trend.parameters["slope"].value > 0.0
        assert np.isfinite(trend.predict(stretch * data.t).prediction_high).all()
