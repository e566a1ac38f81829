"""The p-value of the slope stays valid though outliers were removed by the same data."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import kstest

from tests.statistics.bounds import most
from tests.trends.contaminated import contaminated, fitted


def test_without_a_trend_small_p_values_are_as_rare_as_they_say() -> None:
    # 60 points, a fifth of them outliers; the interval may be a little wide, so larger p-values are allowed.
    p_values = []
    for seed in range(300):
        data = contaminated(60, 0.2, seed, slope=0.0)
        p_values.append(fitted(data.t, data.y).p_value)
    assert sum(p < 0.05 for p in p_values) <= most(300, 0.05)
    assert sum(p < 0.01 for p in p_values) <= most(300, 0.01)
    assert kstest(p_values, "uniform", alternative="greater").pvalue > 1e-4
    assert np.median(p_values) < 0.7


def test_a_clear_trend_has_a_tiny_p_value() -> None:
    data = contaminated(60, 0.2, 3)
    assert fitted(data.t, data.y).p_value < 1e-10


def test_the_p_value_and_the_interval_say_the_same_about_zero() -> None:
    for seed in range(40):
        data = contaminated(60, 0.2, seed, slope=0.006)
        trend = fitted(data.t, data.y)
        slope = trend.parameters["slope"]
        assert (slope.low <= 0.0 <= slope.high) == (trend.p_value >= 0.05)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_p_value_is_two_sided(sign: float) -> None:
    data = contaminated(60, 0.0, 22, slope=0.05)
    trend = fitted(data.t, sign * data.y, method="ols")
    assert trend.p_value == pytest.approx(fitted(data.t, data.y, method="ols").p_value, rel=1e-9)
