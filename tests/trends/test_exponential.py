"""Exponential growth and decay: what is found, in which noise, and what becomes of impossible values."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import InputError, fit_trend
from estimators.result import NoFitReason
from tests.trends.contaminated import fitted, refused
from tests.trends.growing import growing

NOISES = ("additive", "multiplicative")


def codes(trend: object) -> set[str]:
    return {item.code.value for item in trend.notices}  # type: ignore[attr-defined]


@pytest.mark.parametrize("noise", NOISES)
@pytest.mark.parametrize("share", [0.0, 0.3, 0.6])
def test_the_rate_is_found_and_the_noise_told_whatever_the_outliers(noise: str, share: float) -> None:
    t, y, outlier = growing(noise, share=share)
    trend = fitted(t, y, model="exponential")
    assert trend.noise is not None
    assert (trend.noise.domain, trend.noise.selection) == (noise, "selected")
    rate, level = trend.parameters["rate"], trend.parameters["level"]
    assert rate.value == pytest.approx(0.03, abs=5 * rate.stderr)
    assert rate.stderr < 0.001
    assert level.value == pytest.approx(2.0, abs=5 * level.stderr)
    assert not trend.points.inlier[outlier].any()
    assert trend.points.inlier[~outlier].mean() > 0.9


@pytest.mark.parametrize("noise", NOISES)
def test_decay_is_found_as_growth_is(noise: str) -> None:
    t, y, _ = growing(noise, rate=-0.03, level=40.0)
    trend = fitted(t, y, model="exponential")
    assert trend.noise is not None
    assert trend.noise.domain == noise
    assert trend.parameters["rate"].value == pytest.approx(-0.03, abs=0.002)


@pytest.mark.parametrize("noise", NOISES)
def test_most_intervals_of_the_rate_hold_the_truth(noise: str) -> None:
    rates = [
        fitted(*growing(noise, n=60, seed=seed)[:2], model="exponential").parameters["rate"]
        for seed in range(40)
    ]
    held = sum(rate.low <= 0.03 <= rate.high for rate in rates)
    # 95 % intervals: 33 or fewer of 40 are a chance of one in a thousand.
    assert held >= 34


@pytest.mark.parametrize("noise", NOISES)
def test_a_series_below_zero_has_the_mirrored_answer(noise: str) -> None:
    t, y, _ = growing(noise)
    above, below = fitted(t, y, model="exponential"), fitted(t, -y, model="exponential")
    assert below.parameters["level"].value == pytest.approx(-above.parameters["level"].value, rel=1e-9)
    assert below.parameters["rate"].value == pytest.approx(above.parameters["rate"].value, rel=1e-9)
    assert below.parameters["level"].low <= below.parameters["level"].high


def test_values_below_zero_are_data_under_additive_noise() -> None:
    t = np.arange(100.0)
    y = 20.0 * np.exp(-0.08 * t) + np.random.default_rng(2).normal(size=100)
    trend = fitted(t, y, model="exponential")
    assert trend.noise is not None
    assert trend.noise.domain == "additive"
    assert trend.consensus.n == 100
    assert trend.points.inlier[y <= 0.0].mean() > 0.9
    assert trend.parameters["rate"].value == pytest.approx(-0.08, abs=0.01)


def test_under_multiplicative_noise_they_are_invalid_and_counted() -> None:
    t, y, _ = growing("multiplicative")
    y[[5, 50]] = [0.0, -3.0]
    trend = fitted(t, y, model="exponential", noise="multiplicative")
    assert [trend.points.reason[row] for row in (5, 50)] == ["invalid", "invalid"]
    assert np.isnan(trend.points.residual[[5, 50]]).all()
    (told,) = [item for item in trend.notices if item.code.value == "nonpositive_values"]
    assert told.detail == {"rows": 2}
    assert "invalid_values" not in codes(trend)
    assert trend.points.inlier.size == t.size


def test_the_few_values_of_the_other_sign_are_the_impossible_ones() -> None:
    t, y, _ = growing("multiplicative")
    y = -y
    y[7] = 4.0
    trend = fitted(t, y, model="exponential", noise="multiplicative")
    assert trend.points.reason[7] == "invalid"
    assert trend.parameters["level"].value < 0.0


def test_at_a_low_dynamic_range_both_answers_are_reported() -> None:
    t = np.arange(60.0)
    y = 100.0 * np.exp(0.001 * t) + np.random.default_rng(3).normal(size=60)
    trend = fitted(t, y, model="exponential", predict=[70.0])
    other = trend.alternative
    assert trend.noise is not None
    assert trend.noise.selection == "undetermined"
    assert other is not None
    assert other.noise is not None
    assert {trend.noise.domain, other.noise.domain} == set(NOISES)
    assert other.parameters["rate"].value == pytest.approx(trend.parameters["rate"].value, rel=0.05)
    assert other.prediction is not None
    assert "undetermined_noise" in codes(trend)
    answer = trend.to_dict()
    assert answer["alternative"]["noise"]["domain"] == other.noise.domain
    assert "points" not in answer["alternative"]


@pytest.mark.parametrize("noise", NOISES)
def test_noise_that_is_given_is_not_asked_of_the_data(noise: str) -> None:
    t, y, _ = growing("additive", share=0.0, level=10.0)
    trend = fitted(t, y, model="exponential", noise=noise)
    assert trend.noise is not None
    assert (trend.noise.domain, trend.noise.selection, trend.noise.margin) == (noise, "given", None)
    assert trend.alternative is None


@pytest.mark.parametrize("method", ["msac", "mm", "theil-sen", "ransac"])
def test_other_methods_fit_the_logarithms_and_say_so(method: str) -> None:
    t, y, _ = growing("multiplicative", share=0.2)
    trend = fitted(t, y, model="exponential", method=method)
    assert trend.noise is not None
    assert (trend.noise.domain, trend.noise.selection) == ("multiplicative", "method")
    assert trend.parameters["rate"].value == pytest.approx(0.03, abs=0.003)


@pytest.mark.parametrize(
    ("field", "arguments"),
    [
        ("noise", {"noise": "pink"}),
        ("method", {"method": "msac", "noise": "additive"}),
        ("threshold", {"threshold": 1.0}),
        ("sigma", {"sigma": 1.0}),
        ("threshold", {"threshold": 1.0, "method": "msac"}),
    ],
)
def test_arguments_that_contradict_one_another_are_named(field: str, arguments: dict[str, object]) -> None:
    t, y, _ = growing("additive")
    with pytest.raises(InputError) as caught:
        fit_trend(t, y, model="exponential", **arguments)  # type: ignore[arg-type]
    assert caught.value.field == field


@pytest.mark.parametrize("noise", NOISES)
def test_a_given_threshold_labels_in_the_units_of_the_noise(noise: str) -> None:
    t, y, _ = growing(noise)
    threshold = 1.5 if noise == "additive" else 0.3
    trend = fitted(t, y, model="exponential", noise=noise, threshold=threshold)
    assert trend.consensus.threshold == pytest.approx(threshold)
    assert np.array_equal(np.abs(trend.points.residual) <= threshold, trend.points.inlier)


def test_a_given_sigma_is_kept() -> None:
    t, y, _ = growing("additive")
    trend = fitted(t, y, model="exponential", noise="additive", sigma=0.5)
    assert (trend.consensus.sigma, trend.consensus.sigma_source) == (pytest.approx(0.5), "given")


@pytest.mark.parametrize(
    ("t", "y", "noise", "reason"),
    [
        ([0.0, 1.0, 2.0], [0.0, 0.0, 0.0], "auto", NoFitReason.no_consensus),
        ([0.0], [1.0], "auto", NoFitReason.too_few_points),
        ([2.0, 2.0], [1.0, 3.0], "auto", NoFitReason.constant_time),
        ([0.0, 1.0], [1.0, -1.0], "auto", NoFitReason.no_consensus),
        ([0.0, 1.0, 2.0], [1.0, 0.0, -1.0], "multiplicative", NoFitReason.too_few_points),
        ([0.0, 1.0, 1.0], [0.0, 1.0, 2.0], "multiplicative", NoFitReason.constant_time),
    ],
)
def test_series_without_an_exponential_are_refused_with_a_reason(
    t: list[float], y: list[float], noise: str, reason: NoFitReason
) -> None:
    assert refused(t, y, model="exponential", noise=noise).reason is reason


def test_impossible_values_are_named_where_nothing_else_is_left() -> None:
    answer = refused([0.0, 1.0, 2.0], [1.0, 0.0, -1.0], model="exponential", noise="multiplicative")
    assert answer.points.reason == ["ok", "invalid", "invalid"]
    assert codes(answer) == {"nonpositive_values"}


def test_two_readings_are_joined_without_uncertainty() -> None:
    trend = fitted([0.0, 2.0], [3.0, 12.0], model="exponential")
    assert trend.parameters["rate"].value == pytest.approx(np.log(2.0))
    assert trend.parameters["rate"].stderr is None
    assert {"no_redundancy", "undetermined_noise"} <= codes(trend)


def test_equal_values_have_rate_zero_and_no_doubling_time() -> None:
    trend = fitted(np.arange(20.0), np.full(20, 5.0), model="exponential")
    assert trend.parameters["rate"].value == 0.0
    assert trend.parameters["level"].value == pytest.approx(5.0)
    assert trend.derived is not None
    assert {"doubling_time", "halving_time"}.isdisjoint(trend.derived)
    assert "constant_values" in codes(trend)


def test_an_exact_exponential_is_found_exactly_whatever_the_noise() -> None:
    t = np.arange(50.0)
    for noise in ("auto", *NOISES):
        trend = fitted(t, 1e-20 * np.exp(2.0 * t), model="exponential", noise=noise)
        assert trend.parameters["rate"].value == pytest.approx(2.0, rel=1e-9)
        assert trend.parameters["level"].value == pytest.approx(1e-20, rel=1e-6)


@pytest.mark.parametrize("noise", NOISES)
@pytest.mark.parametrize("unit", [1e-300, 1e-62, 1e-9, 1e57])
def test_values_of_any_magnitude_have_the_same_rate(noise: str, unit: float) -> None:
    t, y, _ = growing(noise)
    plain, scaled = fitted(t, y, model="exponential"), fitted(t, y * unit, model="exponential")
    assert scaled.noise is not None
    assert scaled.noise.domain == noise
    assert scaled.parameters["rate"].value == pytest.approx(plain.parameters["rate"].value, rel=1e-3)
    assert scaled.parameters["level"].value / unit == pytest.approx(plain.parameters["level"].value, rel=1e-2)
    assert scaled.consensus.sigma / (unit if noise == "additive" else 1.0) == pytest.approx(
        plain.consensus.sigma, rel=0.05
    )
    json.dumps(scaled.to_dict(), allow_nan=False)


@settings(deadline=None, max_examples=10)
@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e3), st.sampled_from(NOISES))
def test_another_clock_changes_the_unit_of_the_rate_and_nothing_else(
    shift: float, unit: float, noise: str
) -> None:
    t, y, _ = growing(noise, n=50)
    plain = fitted(t, y, model="exponential")
    other = fitted(shift + unit * t, y, model="exponential")
    assert other.parameters["rate"].value * unit == pytest.approx(plain.parameters["rate"].value, rel=1e-4)
    assert other.parameters["level"].value == pytest.approx(plain.parameters["level"].value, rel=1e-3)
    assert np.mean(other.points.inlier == plain.points.inlier) > 0.97


def test_the_level_holds_at_the_first_time_also_of_epoch_nanoseconds() -> None:
    t, y, _ = growing("additive")
    start = 1_700_000_000_000_000_123
    trend = fitted(start + np.round(t * 1e9).astype(np.int64), y, model="exponential")
    assert trend.to_dict()["origin"] == start
    assert trend.parameters["level"].value == pytest.approx(2.0, abs=0.3)
    assert trend.parameters["rate"].value == pytest.approx(0.03e-9, rel=0.05)


@pytest.mark.parametrize("noise", NOISES)
def test_the_order_of_the_rows_does_not_matter(noise: str) -> None:
    t, y, _ = growing(noise)
    order = np.random.default_rng(1).permutation(t.size)
    plain, mixed = fitted(t, y, model="exponential"), fitted(t[order], y[order], model="exponential")
    assert mixed.parameters == plain.parameters
    assert np.array_equal(mixed.points.inlier, plain.points.inlier[order])


def test_weights_tell_readings_that_are_worth_little() -> None:
    t, y, _ = growing("additive", share=0.0)
    rng = np.random.default_rng(4)
    poor = rng.permutation(t.size) < 60
    y[poor] += 5.0 * rng.normal(size=60)
    weights = np.where(poor, 0.01, 1.0)
    with_weights = fitted(t, y, weights=weights, model="exponential", noise="additive")
    assert with_weights.parameters["rate"].value == pytest.approx(0.03, abs=0.001)
    assert with_weights.points.inlier[poor].mean() > 0.9


def test_fill_values_of_1e36_do_not_drown_the_rest() -> None:
    t, y, _ = growing("additive", share=0.0)
    y[[3, 40, 90]] = [1e36, -1e36, 1e36]
    trend = fitted(t, y, model="exponential")
    assert trend.noise is not None
    assert trend.noise.domain == "additive"
    assert trend.parameters["rate"].value == pytest.approx(0.03, abs=0.001)
    assert not trend.points.inlier[[3, 40, 90]].any()


def test_correlated_noise_widens_the_interval_of_an_additive_exponential() -> None:
    t = np.arange(300.0)
    rng = np.random.default_rng(5)
    noise = np.zeros(300)
    for i in range(1, 300):
        noise[i] = 0.7 * noise[i - 1] + rng.normal()
    y = 30.0 * np.exp(0.004 * t) + noise
    trend = fitted(t, y, model="exponential", noise="additive")
    assert trend.uncertainty.lag1 > 0.4
    assert trend.uncertainty.effective_n < 150
    assert "serial_correlation" in codes(trend)


def test_a_second_exponential_that_others_follow_is_the_runner_up() -> None:
    rng = np.random.default_rng(6)
    t = np.arange(200.0)
    first = rng.permutation(200) < 115
    y = np.where(first, 5.0 * np.exp(0.01 * t), 60.0 * np.exp(-0.01 * t)) + 0.4 * rng.normal(size=200)
    trend = fitted(t, y, model="exponential", noise="additive")
    assert trend.parameters["rate"].value == pytest.approx(0.01, abs=0.001)
    assert trend.runner_up is not None
    assert trend.runner_up.parameters["rate"] == pytest.approx(-0.01, abs=0.002)
    assert trend.runner_up.parameters["level"] == pytest.approx(60.0, rel=0.1)


def test_transistor_counts_double_every_two_years(trend_data: Path) -> None:
    year, thousands = np.loadtxt(trend_data / "climate" / "rupp_transistors.dat").T
    trend = fitted(year, thousands, model="exponential")
    assert trend.noise is not None
    assert trend.noise.domain == "multiplicative"
    assert trend.parameters["rate"].value / np.log(2.0) == pytest.approx(0.50, abs=0.01)
    assert trend.derived is not None
    assert trend.derived["doubling_time"].value == pytest.approx(2.0, abs=0.05)
