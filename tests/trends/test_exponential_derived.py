"""What follows from a rate: growth, doubling and halving times, the mean over the median; and the bands."""

from __future__ import annotations

import itertools
import json
import math

import numpy as np
import pytest

from estimators.result import Estimate
from estimators.trends.exponential.curve import ExponentialCurve
from estimators.trends.exponential.derived import derived_estimates, is_open
from estimators.trends.presentation.units import PLAIN, TimeUnit
from tests.trends.contaminated import fitted
from tests.trends.growing import growing


def curve(
    noise: str = "additive", sign: float = 1.0, sigma: float = 0.5, rate: float = 0.1
) -> ExponentialCurve:
    return ExponentialCurve(noise, sign, 5.0, math.log(10.0), rate, 0.02, 0.004, sigma, (0.0, 10.0))  # type: ignore[arg-type]


def derived(low: float, value: float, high: float, unit: TimeUnit = PLAIN) -> dict[str, Estimate]:
    rate = Estimate(value, (high - low) / 4.0, low, high)
    return derived_estimates(curve(rate=value), rate, unit, 0.95, 50.0)


def test_a_doubling_time_is_ln_2_over_the_rate_and_so_are_its_limits() -> None:
    time = derived(0.05, 0.1, 0.2)["doubling_time"]
    limits = [math.log(2.0) / rate for rate in (0.1, 0.2, 0.05)]
    assert [time.value, time.low, time.high] == pytest.approx(limits)


def test_a_falling_curve_has_a_halving_time() -> None:
    found = derived(-0.2, -0.1, -0.05)
    time = found["halving_time"]
    assert "doubling_time" not in found
    assert [time.value, time.low, time.high] == pytest.approx(
        [math.log(2.0) / rate for rate in (0.1, 0.2, 0.05)]
    )


def test_a_rate_that_may_be_zero_leaves_the_doubling_time_open() -> None:
    time = derived(-0.1, 0.1, 0.3)["doubling_time"]
    assert time.low == pytest.approx(math.log(2.0) / 0.3)
    assert time.high is None
    assert is_open(Estimate(0.1, 0.1, -0.1, 0.3))
    assert not is_open(Estimate(0.1, 0.1, 0.05, 0.3))


def test_an_open_interval_is_said_in_a_notice_and_is_null_in_the_answer() -> None:
    t = np.arange(60.0)
    y = 100.0 + np.random.default_rng(1).normal(size=60)
    trend = fitted(t, y, model="exponential", noise="additive")
    assert "rate_near_zero" in {item.code.value for item in trend.notices}
    times = [value for name, value in trend.to_dict()["derived"].items() if name.endswith("_time")]
    assert [time["high"] for time in times] == [None]
    assert "no limit)" in trend.summary()


def test_growth_is_stated_per_natural_unit_of_time() -> None:
    t, y, _ = growing("multiplicative")
    days = np.datetime64("2020-01-01") + (t * 100).astype(int).astype("timedelta64[D]")
    trend = fitted(days, y, model="exponential")
    assert trend.derived is not None
    growth = trend.derived["growth_percent_per_year"]
    assert growth.value == pytest.approx(100.0 * math.expm1(0.03 / 100.0 * 365.25), rel=0.1)
    assert growth.low < growth.value < growth.high


def test_growth_that_no_float_can_hold_is_left_out() -> None:
    found = derived(0.9, 1.0, 1.1, TimeUnit("year", 1e9))
    assert [name for name in found if name.startswith("growth")] == []
    assert derived(0.9, 1.0, 1.1)["growth_percent_per_unit"].value == pytest.approx(100.0 * math.expm1(1.0))


def test_the_mean_of_readings_exceeds_the_trend_by_the_mean_factor() -> None:
    t = np.linspace(0.0, 10.0, 4000)
    y = 5.0 * np.exp(0.1 * t) * np.exp(0.5 * np.random.default_rng(2).normal(size=t.size))
    trend = fitted(t, y, model="exponential", noise="multiplicative")
    assert trend.derived is not None
    factor = trend.derived["mean_factor"]
    # METHODS.md 11.3: exp(0.5**2 / 2) = 1.133.
    assert factor.value == pytest.approx(1.133, abs=0.01)
    assert factor.low < 1.133 < factor.high
    ratio = y / trend.geometry.value(t)
    assert float(ratio.mean()) == pytest.approx(factor.value, abs=0.02)
    assert float(np.median(ratio)) == pytest.approx(1.0, abs=0.02)


def test_a_scale_that_hardly_any_readings_tell_gives_a_mean_factor_without_interval() -> None:
    rate = Estimate(0.1, 0.01, 0.08, 0.12)
    factor = derived_estimates(curve("multiplicative"), rate, PLAIN, 0.95, 2.001)["mean_factor"]
    assert factor == Estimate(pytest.approx(math.exp(0.125)), None, None, None)


def test_under_additive_noise_there_is_no_mean_factor() -> None:
    assert "mean_factor" not in derived(0.05, 0.1, 0.2)


@pytest.mark.parametrize("noise", ["additive", "multiplicative"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_bands_lie_about_the_curve_in_order(noise: str, sign: float) -> None:
    bands = curve(noise, sign).bands(np.linspace(-5.0, 20.0, 11), 2.0)
    columns = (
        bands.prediction_low, bands.confidence_low, bands.value, bands.confidence_high, bands.prediction_high
    )  # fmt: skip
    for low, high in itertools.pairwise(columns):
        assert np.all(low < high)
    if noise == "multiplicative":
        assert np.all(np.sign(np.concatenate(columns)) == sign)


def test_under_additive_noise_the_confidence_band_is_that_of_the_delta_method() -> None:
    shape = curve()
    at = np.array([8.0])
    value = 10.0 * math.exp(0.1 * 3.0)
    stderr = value * math.hypot(0.02, 0.004 * 3.0)
    bands = shape.bands(at, 2.0)
    assert bands.confidence_high[0] == pytest.approx(value + 2.0 * stderr)
    assert bands.prediction_high[0] == pytest.approx(value + 2.0 * math.hypot(stderr, 0.5))


@pytest.mark.parametrize("noise", ["additive", "multiplicative"])
def test_the_prediction_band_holds_most_new_readings(noise: str) -> None:
    t, y, outlier = growing(noise, n=400)
    trend = fitted(t[::2], y[::2], model="exponential")
    new = ~outlier[1::2]
    bands = trend.predict(t[1::2])
    held = (bands.prediction_low <= y[1::2]) & (y[1::2] <= bands.prediction_high)
    assert held[new].mean() > 0.9


def test_beyond_the_range_of_floats_a_prediction_is_null() -> None:
    t, y, _ = growing("multiplicative")
    trend = fitted(t, y, model="exponential", predict=[1e6])
    prediction = json.loads(json.dumps(trend.to_dict(), allow_nan=False))["prediction"]
    assert prediction["value"] == [None]


def test_a_curve_in_larger_units_is_the_same_curve() -> None:
    for noise in ("additive", "multiplicative"):
        small, large = curve(noise), curve(noise).in_value_units(8.0)
        at = np.array([0.0, 7.0])
        assert large.value(at) == pytest.approx(8.0 * small.value(at))
        assert large.bands(at, 2.0).prediction_low == pytest.approx(8.0 * small.bands(at, 2.0).prediction_low)
