"""Levels, polynomials and the caller's own columns."""

import numpy as np
import pytest

from estimators import InputError, NoFit, Trend, fit_trend

RNG = np.random.default_rng(11)
T = np.sort(RNG.uniform(0.0, 100.0, 160))
NOISE = RNG.normal(size=160)
OUT = np.arange(160) % 4 == 0
ERRORS = np.where(OUT, RNG.uniform(20.0, 90.0, 160), 0.0)


def fitted(y: object, **arguments: object) -> Trend:
    trend = fit_trend(T, y, **arguments)  # type: ignore[arg-type]
    assert isinstance(trend, Trend)
    return trend


def covers(trend: Trend, name: str, truth: float) -> bool:
    estimate = trend.parameters[name]
    assert estimate.low is not None
    assert estimate.high is not None
    return estimate.low <= truth <= estimate.high


def test_a_level_is_found_among_one_sided_outliers() -> None:
    trend = fitted(7.0 + NOISE + ERRORS, model="constant")
    assert list(trend.parameters) == ["level"]
    assert covers(trend, "level", 7.0)
    assert trend.points.inlier.sum() == pytest.approx(120, abs=3)
    assert trend.p_value is None


def test_a_level_needs_no_two_times() -> None:
    trend = fit_trend([3.0, 3.0, 3.0, 3.0], [1.0, 1.1, 0.9, 1.0], model="constant")
    assert isinstance(trend, Trend)
    assert trend.parameters["level"].value == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("method", ["auto", "msac", "lo-ransac", "mm", "huber", "ols"])
def test_a_parabola_is_found_by_every_method_for_columns(method: str) -> None:
    truth = 5.0 + 0.3 * T + 0.02 * (T - 50.0) ** 2
    errors = ERRORS if method not in ("huber", "ols") else 0.0
    trend = fitted(truth + NOISE + errors, model="linear", degree=2, method=method)
    assert np.abs(trend.predict(T).value - truth).max() < 1.5
    assert trend.parameters["power_2"].value == pytest.approx(0.02, abs=0.002)
    mean_slope = (truth[-1] - truth[0]) / (T[-1] - T[0])
    assert trend.parameters["slope"].value == pytest.approx(mean_slope, abs=0.03)
    assert trend.parameters["slope_end"].value == pytest.approx(0.3 + 0.04 * (T[-1] - 50.0), rel=0.1)


@pytest.mark.parametrize("method", ["theil-sen", "siegel"])
def test_methods_of_lines_refuse_a_parabola(method: str) -> None:
    with pytest.raises(InputError, match="fits lines only"):
        fitted(NOISE, model="linear", degree=2, method=method)


def test_a_polynomial_of_degree_one_is_the_line() -> None:
    y = 2.0 - 0.4 * T + NOISE + ERRORS
    line, linear = fitted(y), fitted(y, model="linear")
    for name in ("slope", "intercept"):
        one, other = line.parameters[name], linear.parameters[name]
        assert one.value == pytest.approx(other.value, rel=1e-9)
        assert one.stderr == pytest.approx(other.stderr, rel=0.05)
    assert np.array_equal(line.points.inlier, linear.points.inlier)


def test_the_parameters_describe_the_curve() -> None:
    trend = fitted(0.001 * (T - 40.0) ** 3 + 0.2 * T + NOISE, model="linear", degree=3)
    first, last = trend.geometry.span
    ends = trend.predict([T[0], T[-1]]).value
    origin = trend.predict([0.0]).value[0]
    nearly_end = trend.predict([T[-1] - 1e-4, T[-1]]).value
    assert trend.parameters["slope"].value == pytest.approx((ends[1] - ends[0]) / (last - first))
    assert trend.parameters["intercept"].value == pytest.approx(origin)
    assert trend.parameters["slope_end"].value == pytest.approx(np.diff(nearly_end)[0] / 1e-4, rel=1e-4)
    assert trend.parameters["power_3"].value == pytest.approx(0.001, abs=0.0003)


def test_own_columns_take_their_share_of_the_values() -> None:
    load = RNG.uniform(0.0, 50.0, 160)
    trend = fitted(3.0 + 0.2 * T + 1.5 * load + NOISE + ERRORS, model="linear", columns={"load": load})
    assert covers(trend, "load", 1.5)
    assert covers(trend, "slope", 0.2)
    assert covers(trend, "intercept", 3.0)
    residual = trend.points.residual
    fit = np.array(trend.to_dict()["points"]["fit"])
    assert fit == pytest.approx(3.0 + 0.2 * T + 1.5 * load + NOISE + ERRORS - residual)


def test_predictions_take_own_columns_or_their_means() -> None:
    load = RNG.uniform(0.0, 50.0, 160)
    trend = fitted(3.0 + 0.2 * T + 1.5 * load + NOISE, model="linear", columns=load)
    given = trend.predict([10.0, 10.0], columns=[0.0, 20.0]).value
    assert given[1] - given[0] == pytest.approx(30.0, abs=0.5)
    assert trend.predict([10.0]).value[0] == pytest.approx(
        trend.predict([10.0], columns=[load.mean()]).value[0]
    )
    with pytest.raises(InputError, match="column_1"):
        trend.predict([10.0], columns={"other": [1.0]})
    with pytest.raises(InputError, match="one each"):
        trend.predict([10.0], columns=[1.0, 2.0])


def test_the_frame_of_a_trend_with_own_columns_has_their_fit() -> None:
    load = RNG.uniform(0.0, 50.0, 160)
    trend = fitted(1.5 * load + NOISE, model="linear", columns={"load": load})
    frame = trend.to_frame()
    assert np.allclose(frame["value"] - frame["fit"], frame["residual"])


@pytest.mark.parametrize(
    ("arguments", "field", "says"),
    [
        ({"degree": 2}, "degree", "no meaning for the model line; it has for: linear"),
        ({"model": "linear", "degree": 6}, "degree", "from 0 to 5"),
        ({"model": "linear", "degree": True}, "degree", "integer"),
        ({"model": "linear", "columns": [1.0, 2.0]}, "columns", "160 rows"),
        ({"model": "linear", "columns": np.full(160, 2.0)}, "columns", "all entries are equal"),
        ({"model": "linear", "columns": np.where(OUT, np.nan, T**2)}, "columns", "missing or infinite"),
        ({"model": "linear", "columns": np.ones((160, 9))}, "columns", "at most 8"),
        ({"model": "linear", "columns": {"x": ["a"] * 160}}, "columns", "expected numbers"),
        ({"columns": T}, "columns", "no meaning for the model line"),
        ({"harmonics": 2}, "harmonics", "goes with seasonal"),
        ({"model": "linear", "degree": 0, "uncertainty": "permutation"}, "uncertainty", "has none"),
    ],
)
def test_what_cannot_be_fitted_is_refused_by_name(
    arguments: dict[str, object], field: str, says: str
) -> None:
    with pytest.raises(InputError, match=says) as caught:
        fitted(NOISE, **arguments)
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("t", "y", "arguments", "reason"),
    [
        ([1.0, 2.0], [1.0, 2.0], {"model": "linear", "degree": 2}, "too_few_points"),
        ([1.0, 1.0, 1.0], [1.0, 2.0, 3.0], {"model": "linear"}, "constant_time"),
        ([1.0, 1.0, 2.0, 2.0], [1.0, 2.0, 3.0, 5.0], {"model": "linear", "degree": 2}, "too_few_points"),
    ],
)
def test_data_that_do_not_determine_the_trend_are_no_fit(
    t: list[float], y: list[float], arguments: dict[str, object], reason: str
) -> None:
    refused = fit_trend(t, y, **arguments)  # type: ignore[arg-type]
    assert isinstance(refused, NoFit)
    assert refused.reason == reason
    assert refused.message


def test_own_columns_that_follow_from_others_are_no_fit() -> None:
    refused = fit_trend(T, NOISE, model="linear", columns={"twice": 2.0 * T + 1.0})
    assert isinstance(refused, NoFit)
    assert "leave out columns" in refused.message


def test_the_summary_says_what_was_fitted() -> None:
    text = fitted(5.0 + 0.02 * (T - 50.0) ** 2 + NOISE, model="linear", degree=2).summary()
    assert "linear by auto" in text
    assert "x²" in text
    assert "slope at the end" in text
    assert "samples drawn" in text
    assert "level" in fitted(5.0 + NOISE, model="constant").summary()


@pytest.mark.parametrize("unit", [1e-200, 1e-12, 1e9])
def test_values_of_any_magnitude_give_the_same_answer(unit: float) -> None:
    y = 5.0 + 0.02 * (T - 50.0) ** 2 + NOISE + ERRORS
    one, other = fitted(y, model="linear", degree=2), fitted(y * unit, model="linear", degree=2)
    for name, estimate in one.parameters.items():
        assert other.parameters[name].value == pytest.approx(estimate.value * unit, rel=1e-4, abs=1e-3 * unit)
        assert other.parameters[name].stderr == pytest.approx(estimate.stderr * unit, rel=0.01)  # type: ignore[operator]


def test_a_picture_can_be_drawn_of_every_shape() -> None:
    y = 5.0 + 0.02 * (T - 50.0) ** 2 + NOISE + ERRORS
    for arguments in ({"model": "constant"}, {"model": "linear", "degree": 2}, {"seasonal": 12}):
        assert fitted(y, **arguments).plot() is not None
