"""Arguments that cannot be used are named; those that can are honoured and their source is stated."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import estimators
from estimators import InputError, RobustOptions, fit_trend
from tests.trends.contaminated import contaminated, fitted

DATA = contaminated(60, seed=8)
every_method = pytest.mark.parametrize("method", list(estimators.methods()))


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("threshold", 0.0),
        ("threshold", -1.0),
        ("threshold", float("nan")),
        ("threshold", 1e61),
        ("threshold", True),
        ("threshold", "3"),
        ("sigma", float("inf")),
        ("sigma", 1e-61),
        ("sigma", [1.0]),
        ("level", 0.0),
        ("level", 1.0),
        ("level", "0.9"),
        ("level", float("nan")),
        ("seed", -1),
        ("seed", 2**63),
        ("seed", 1.5),
        ("seed", None),
        ("seed", True),
        ("method", None),
        ("method", ["auto"]),
        ("model", {}),
        ("options", {"confidence": 0.9}),
        ("weights", np.full(60, -1.0)),
        ("weights", np.full(60, np.nan)),
        ("weights", np.full(60, np.inf)),
        ("weights", np.ones(59)),
    ],
)
def test_an_argument_that_cannot_be_used_is_named(field: str, value: Any) -> None:
    with pytest.raises(InputError) as caught:
        fit_trend(DATA.t, DATA.y, **{field: value})
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("t", "y", "field"),
    [
        ([0.0, 1.0], [1.0], "y"),
        ([0.0, 1.0], ["a", "b"], "y"),
        ([0.0, 1.0], [True, False], "y"),
        ([0.0, 1.0], [None, "1"], "y"),
        ([0.0, 1.0], [[1.0], [2.0]], "y"),
        ([0.0, 1.0], [[1.0], [2.0, 3.0]], "y"),
        ([0.0, 1.0], [10**400, 1], "y"),
        ([0.0, 1.0], [1j, 2.0], "y"),
        ([0.0, 1.0], None, "y"),
        (["2024-01-01", "2024-01-02"], [1.0, 2.0], "t"),
        ([True, False], [1.0, 2.0], "t"),
        (np.arange(2).astype("timedelta64[s]"), [1.0, 2.0], "t"),
        (5.0, [1.0], "t"),
    ],
)
def test_columns_of_the_wrong_kind_are_named(t: Any, y: Any, field: str) -> None:
    with pytest.raises(InputError) as caught:
        fit_trend(t, y)
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("field", "name", "close"),
    [
        ("method", "ransack", "ransac"),
        ("method", "MSAC", "msac"),
        ("method", "theilsen", "theil-sen"),
        ("model", "lines", "line"),
    ],
)
def test_an_unknown_name_suggests_the_close_one(field: str, name: str, close: str) -> None:
    with pytest.raises(InputError, match=f"did you mean '{close}'"):
        fit_trend(DATA.t, DATA.y, **{field: name})


def test_a_name_like_no_other_gets_the_list_and_no_guess() -> None:
    with pytest.raises(InputError, match="known: auto, ransac") as caught:
        fit_trend(DATA.t, DATA.y, method="zzzz")
    assert "did you mean" not in caught.value.message


@every_method
def test_a_given_threshold_makes_the_labels_and_is_stated(method: str) -> None:
    trend = fitted(DATA.t, DATA.y, method=method, threshold=2.25)
    assert (trend.consensus.threshold, trend.consensus.threshold_source) == (2.25, "given")
    np.testing.assert_array_equal(trend.points.inlier, np.abs(trend.points.residual) <= 2.25)


@every_method
def test_a_given_sigma_is_kept_and_sets_the_threshold(method: str) -> None:
    trend = fitted(DATA.t, DATA.y, method=method, sigma=1.25)
    assert (trend.consensus.sigma, trend.consensus.sigma_source) == (1.25, "given")
    assert trend.consensus.threshold_source == "sigma"
    assert trend.consensus.threshold == pytest.approx(2.7 * 1.25)


def test_threshold_and_sigma_may_be_given_together() -> None:
    trend = fitted(DATA.t, DATA.y, threshold=2.0, sigma=1.0)
    assert (trend.consensus.threshold, trend.consensus.sigma) == (2.0, 1.0)


def test_the_threshold_in_sigmas_is_an_option() -> None:
    trend = fitted(DATA.t, DATA.y, options=RobustOptions(threshold_sigmas=3.5))
    assert trend.consensus.threshold == pytest.approx(3.5 * trend.consensus.sigma)


@every_method
def test_without_either_the_scale_is_estimated_and_its_source_is_stated(method: str) -> None:
    trend = fitted(DATA.t, DATA.y, method=method)
    assert trend.consensus.sigma_source in ("mixture", "residuals", "s-estimate")
    assert trend.consensus.threshold_source == "sigma"


def test_a_higher_level_widens_the_intervals() -> None:
    narrow, wide = (fitted(DATA.t, DATA.y, level=level).parameters["slope"] for level in (0.8, 0.99))
    assert wide.low < narrow.low < narrow.value < narrow.high < wide.high


def test_without_correction_for_serial_correlation_the_intervals_are_those_of_independent_points() -> None:
    trend = fitted(DATA.t, DATA.y, options=RobustOptions(correct_serial_correlation=False))
    assert trend.uncertainty.method == "sandwich"
    assert trend.uncertainty.lag1 == 0.0
