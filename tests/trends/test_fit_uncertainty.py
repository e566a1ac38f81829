"""Inference on request: ``fit_trend(uncertainty=...)``."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest

from estimators import InputError, RobustOptions, Trend, fit_trend
from estimators.consensus.cancellation import Cancelled, cancelled_by
from estimators.trends.resampling import UNCERTAINTIES
from tests.statistics.bounds import most

FEW = RobustOptions(resamples=99)


def _series(seed: int = 0, n: int = 60, slope: float = 0.1) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.exponential(size=n))
    y = 3.0 + slope * t + rng.normal(size=n)
    y[::7] += 25.0
    return t, y


def _fit(uncertainty: str, **options: object) -> Trend:
    trend = fit_trend(*_series(), uncertainty=uncertainty, options=FEW, **options)
    assert isinstance(trend, Trend)
    return trend


def test_the_default_is_the_formula_of_effective_n() -> None:
    plain = fit_trend(*_series())
    assert plain.to_dict() == fit_trend(*_series(), uncertainty="effective-n").to_dict()
    assert plain.uncertainty.method == "effective-n"
    assert plain.uncertainty.resamples is None


@pytest.mark.parametrize("uncertainty", UNCERTAINTIES)
def test_every_method_finds_the_same_line_and_names_itself(uncertainty: str) -> None:
    trend = _fit(uncertainty)
    default = _fit("effective-n")
    assert trend.uncertainty.method == uncertainty
    assert trend.parameters["slope"].value == default.parameters["slope"].value
    np.testing.assert_array_equal(trend.points.inlier, default.points.inlier)
    width = trend.parameters["slope"].high - trend.parameters["slope"].low
    usual = default.parameters["slope"].high - default.parameters["slope"].low
    # Five or so degrees of freedom leave the long-run variance uncertain by half.
    assert 0.3 < width / usual < 3.0
    assert trend.p_value < 0.05


@pytest.mark.parametrize("uncertainty", UNCERTAINTIES)
@pytest.mark.parametrize("method", ["msac", "mm", "theil-sen", "ols"])
def test_every_preset_offers_every_method(uncertainty: str, method: str) -> None:
    trend = _fit(uncertainty, method=method)
    assert 0.0 < trend.p_value <= 1.0
    assert trend.parameters["slope"].low < trend.parameters["slope"].high


@pytest.mark.parametrize("uncertainty", ["bootstrap", "permutation"])
def test_the_same_seed_gives_the_same_answer_and_another_hardly_a_different_one(uncertainty: str) -> None:
    assert _fit(uncertainty, seed=4).to_dict() == _fit(uncertainty, seed=4).to_dict()
    one, other = _fit(uncertainty, seed=4), _fit(uncertainty, seed=5)
    assert one.to_dict() != other.to_dict()
    assert one.parameters["slope"].value == other.parameters["slope"].value


def test_the_bootstrap_says_how_often_it_found_the_same_structure() -> None:
    uncertainty = _fit("bootstrap").uncertainty
    assert uncertainty.resamples == 99
    assert 0.9 <= uncertainty.stability <= 1.0
    assert uncertainty.block >= 1


def test_a_line_that_few_readings_follow_is_an_unstable_answer() -> None:
    rng = np.random.default_rng(2)
    t = np.arange(40.0)
    y = 0.2 * t + rng.normal(size=40)
    y[rng.choice(40, 30, replace=False)] += rng.uniform(4.0, 30.0, 30)
    assert fit_trend(t, y, uncertainty="bootstrap", options=FEW).uncertainty.stability < 0.8


def test_a_permutation_p_value_counts_the_series_itself_and_leaves_intervals_alone() -> None:
    trend, default = _fit("permutation"), _fit("effective-n")
    assert (trend.p_value * 100) == pytest.approx(round(trend.p_value * 100))
    assert trend.p_value >= 0.01
    assert trend.parameters == default.parameters


@pytest.mark.parametrize("uncertainty", ["hac", "bootstrap"])
def test_the_p_value_and_the_interval_agree_at_the_level(uncertainty: str) -> None:
    for seed in range(8):
        t, y = _series(seed, slope=0.02)
        trend = fit_trend(t, y, uncertainty=uncertainty, options=FEW)
        slope = trend.parameters["slope"]
        assert (trend.p_value < 0.05) == (not slope.low <= 0.0 <= slope.high)


@pytest.mark.parametrize("uncertainty", ["hac", "bootstrap", "permutation"])
def test_the_unit_of_the_values_is_arbitrary(uncertainty: str) -> None:
    t, y = _series()
    one = fit_trend(t, y, uncertainty=uncertainty, options=FEW)
    other = fit_trend(t, 2.0**20 * y, uncertainty=uncertainty, options=FEW)
    assert other.p_value == pytest.approx(one.p_value, rel=1e-6, abs=1e-12)
    assert other.parameters["slope"].stderr == pytest.approx(2.0**20 * one.parameters["slope"].stderr)


@pytest.mark.parametrize("uncertainty", ["hac", "bootstrap", "permutation"])
def test_equal_weights_change_nothing(uncertainty: str) -> None:
    t, y = _series()
    plain = fit_trend(t, y, uncertainty=uncertainty, options=FEW)
    weighted = fit_trend(t, y, weights=np.full(t.size, 3.0), uncertainty=uncertainty, options=FEW)
    assert weighted.p_value == pytest.approx(plain.p_value, rel=1e-6)
    assert weighted.parameters["slope"].stderr == pytest.approx(plain.parameters["slope"].stderr, rel=1e-6)


@pytest.mark.parametrize("uncertainty", UNCERTAINTIES)
@pytest.mark.parametrize("n", [2, 3, 5])
def test_few_points_and_points_without_noise_fall_back_to_the_formula(uncertainty: str, n: int) -> None:
    t = np.arange(float(n))
    for y in (2.0 * t, 2.0 * t + np.resize([0.1, -0.1], n)):
        answer = fit_trend(t, y, uncertainty=uncertainty, options=FEW)
        default = fit_trend(t, y)
        assert answer.parameters == default.parameters
        assert answer.uncertainty == default.uncertainty


SHAPES = {
    "constant": ({"model": "constant"}, "level"),
    "parabola": ({"model": "linear", "degree": 2}, "slope"),
    "season": ({"model": "line", "seasonal": [12.0], "harmonics": 1}, "slope"),
    "additive": ({"model": "exponential", "noise": "additive"}, "rate"),
    "multiplicative": ({"model": "exponential", "noise": "multiplicative"}, "rate"),
}


def _shape(name: str, n: int = 72) -> tuple[np.ndarray, np.ndarray]:
    """Series with a clear trend of a shape (but for the level), noise and outliers."""
    rng = np.random.default_rng(3)
    t = np.arange(float(n))
    noise = rng.normal(size=n)
    y = {
        "constant": 5.0 + noise,
        "parabola": 0.2 * t + 0.002 * (t - 36.0) ** 2 + noise,
        "season": 0.1 * t + 4.0 * np.sin(2.0 * np.pi * t / 12.0 + 1.0) + noise,
        "additive": 10.0 * np.exp(0.03 * t) + noise,
        "multiplicative": 10.0 * np.exp(0.03 * t + 0.1 * noise),
    }[name]
    y[::11] += 40.0
    return t, y


@pytest.mark.parametrize(
    ("shape", "uncertainty"),
    [pair for pair in itertools.product(SHAPES, UNCERTAINTIES) if pair != ("constant", "permutation")],
)
def test_every_shape_offers_every_method(shape: str, uncertainty: str) -> None:
    settings, name = SHAPES[shape]
    t, y = _shape(shape)
    trend = fit_trend(t, y, uncertainty=uncertainty, options=FEW, **settings)
    default = fit_trend(t, y, **settings)
    assert trend.uncertainty.method == uncertainty
    assert trend.parameters[name].value == default.parameters[name].value
    np.testing.assert_array_equal(trend.points.inlier, default.points.inlier)
    # Resamples of a level in which chance draws a fine line widen its interval; they do happen.
    assert 0.3 < trend.parameters[name].stderr / default.parameters[name].stderr < 6.0
    assert trend.p_value is None if shape == "constant" else trend.p_value < 0.05
    resampled = uncertainty in ("bootstrap", "permutation")
    assert (trend.uncertainty.resamples == 99) == resampled


@pytest.mark.parametrize("uncertainty", ["hac", "bootstrap"])
def test_bands_are_those_of_the_method_that_was_asked_for(uncertainty: str) -> None:
    settings, _ = SHAPES["season"]
    t, y = _shape("season")
    trend = fit_trend(t, y, uncertainty=uncertainty, options=FEW, **settings)
    default = fit_trend(t, y, **settings)
    asked, usual = (fit.predict(t) for fit in (trend, default))
    np.testing.assert_array_equal(asked.value, usual.value)
    assert not np.allclose(asked.confidence_low, usual.confidence_low)


@pytest.mark.parametrize("shape", ["parabola", "season", "additive"])
def test_resampled_shapes_are_the_same_with_the_same_seed_and_in_any_unit(shape: str) -> None:
    settings, name = SHAPES[shape]
    t, y = _shape(shape)
    one = fit_trend(t, y, uncertainty="bootstrap", options=FEW, **settings)
    assert one.to_dict() == fit_trend(t, y, uncertainty="bootstrap", options=FEW, **settings).to_dict()
    other = fit_trend(t, 1024.0 * y, uncertainty="bootstrap", options=FEW, **settings)
    scale = 1.0 if name == "rate" else 1024.0
    assert other.parameters[name].stderr == pytest.approx(scale * one.parameters[name].stderr, rel=1e-6)


def test_a_season_stays_in_place_while_the_trend_is_permuted() -> None:
    rng = np.random.default_rng(5)
    t = np.arange(60.0)
    y = 20.0 * np.sin(2.0 * np.pi * t / 12.0) + 0.04 * t + rng.normal(size=60)
    trend = fit_trend(t, y, uncertainty="permutation", options=FEW, **SHAPES["season"][0])
    # A permuted season would be noise of 14 sigma, in which no trend so small could be seen.
    assert trend.p_value <= 0.02


def test_a_level_has_no_trend_to_permute_and_says_so() -> None:
    with pytest.raises(InputError, match="has none") as caught:
        fit_trend(*_shape("constant"), model="constant", uncertainty="permutation")
    assert caught.value.field == "uncertainty"


def test_the_noise_of_an_exponential_is_told_before_its_uncertainty_is_asked() -> None:
    t, y = _shape("additive")
    settings = {"model": "exponential", "options": FEW}
    trend, plain = fit_trend(t, y, uncertainty="bootstrap", **settings), fit_trend(t, y, **settings)
    assert trend.noise == plain.noise
    given = fit_trend(t, y, uncertainty="bootstrap", noise=plain.noise.domain, **settings)
    assert trend.parameters == given.parameters


def test_both_answers_of_an_undetermined_noise_have_the_uncertainty_that_was_asked_for() -> None:
    rng = np.random.default_rng(0)
    t = np.arange(40.0)
    y = 20.0 * np.exp(0.01 * t) + rng.normal(size=40)
    trend = fit_trend(t, y, model="exponential", uncertainty="hac")
    assert trend.noise.selection == "undetermined"
    assert trend.alternative.uncertainty.method == trend.uncertainty.method == "hac"
    assert "undetermined_noise" in [item.code for item in trend.notices]


@pytest.mark.parametrize(("shape", "model"), [("additive", "exponential"), ("constant", "constant")])
def test_the_shape_is_told_before_its_uncertainty_is_asked(shape: str, model: str) -> None:
    t, y = _shape(shape)
    trend = fit_trend(t, y, model="auto", uncertainty="hac")
    assert trend.model == model
    assert trend.uncertainty.method == "hac"
    assert [row.log_evidence for row in trend.evidence] == [
        row.log_evidence for row in fit_trend(t, y, model="auto").evidence
    ]


def test_a_level_that_was_told_from_the_data_keeps_its_formula_under_permutation() -> None:
    trend = fit_trend(*_shape("constant"), model="auto", uncertainty="permutation", options=FEW)
    assert trend.model == "constant"
    assert trend.uncertainty.method == "effective-n"


def test_unknown_methods_and_counts_of_resamples_are_refused() -> None:
    with pytest.raises(InputError, match="did you mean 'bootstrap'"):
        fit_trend(*_series(), uncertainty="bootstraps")
    with pytest.raises(InputError, match="resamples: must lie between 99 and 10 000"):
        RobustOptions(resamples=10)


@pytest.mark.parametrize("uncertainty", ["bootstrap", "permutation"])
def test_a_cancelled_caller_does_not_wait_for_the_resamples(uncertainty: str) -> None:
    flag = np.ones(1, dtype=np.uint8)
    with cancelled_by(flag), pytest.raises(Cancelled):
        fit_trend(*_series(), uncertainty=uncertainty, options=dataclasses.replace(FEW, resamples=10_000))


def test_a_fine_line_among_scattered_readings_is_not_called_a_trend() -> None:
    fooled = 0
    for seed in range(300):
        y = np.random.default_rng([8, seed]).normal(size=80)
        fooled += fit_trend(np.arange(80.0), y).p_value < 0.001
    assert fooled <= most(300, 0.001)


def test_an_inlier_threshold_below_the_noise_proves_no_trend() -> None:
    fooled = 0
    for seed in range(200):
        y = np.random.default_rng([9, seed]).normal(size=60)
        fooled += fit_trend(np.arange(60.0), y, method="ransac", threshold=0.5).p_value < 0.05
    assert fooled <= most(200, 0.05)
