"""Weights are precisions: 1/variance up to scale."""

from __future__ import annotations

import numpy as np
import pytest

from tests.trends.contaminated import contaminated, fitted

WEIGHTED = ["auto", "ransac", "msac", "prosac", "mm", "huber", "ols"]


@pytest.mark.parametrize("method", ["auto", "prosac", "mm", "ols"])
@pytest.mark.parametrize("seed", range(4))
def test_a_half_of_the_points_that_is_known_to_be_worse_loses(method: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(0.0, 100.0, 120))
    good = rng.permutation(120) < 60
    sd = np.where(good, 0.5, 10.0)
    y = np.where(good, 1.0 + 0.5 * t, 60.0 - 0.4 * t) + sd * rng.normal(size=120)
    trend = fitted(t, y, weights=1.0 / sd**2, method=method)
    assert trend.parameters["slope"].value == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize("method", WEIGHTED)
@pytest.mark.parametrize("factor", [1e-300, 1e-9, 7.0, 1e300])
def test_only_the_ratios_of_weights_count(method: str, factor: float) -> None:
    data = contaminated(60, seed=9)
    weights = np.random.default_rng(0).uniform(0.5, 2.0, 60)
    plain = fitted(data.t, data.y, weights=weights, method=method)
    scaled = fitted(data.t, data.y, weights=factor * weights, method=method)
    assert scaled.parameters["slope"].value == pytest.approx(plain.parameters["slope"].value, rel=1e-9)
    np.testing.assert_array_equal(scaled.points.inlier, plain.points.inlier)


@pytest.mark.parametrize("method", WEIGHTED)
def test_a_weight_of_zero_leaves_its_row_out(method: str) -> None:
    data = contaminated(60, seed=10)
    weights = np.ones(60)
    weights[::4] = 0.0
    kept = weights > 0.0
    trend = fitted(data.t, data.y, weights=weights, method=method)
    alone = fitted(data.t[kept], data.y[kept], method=method)
    assert trend.parameters["slope"].value == pytest.approx(alone.parameters["slope"].value, rel=1e-9)
    assert {trend.points.reason[row] for row in range(0, 60, 4)} == {"zero_weight"}
    assert trend.consensus.n == 45


def test_weights_that_are_all_zero_leave_no_data() -> None:
    from tests.trends.contaminated import refused

    answer = refused([0.0, 1.0, 2.0], [0.0, 1.0, 2.0], weights=[0, 0, 0])
    assert answer.reason.value == "no_data"
    assert answer.points.reason == ["zero_weight"] * 3


@pytest.mark.parametrize("method", WEIGHTED)
@pytest.mark.parametrize("ratio", [1e-300, 1e-100, 1e-12, 1e-6])
def test_however_far_weights_lie_apart_the_answer_has_numbers(method: str, ratio: float) -> None:
    data = contaminated(60, seed=11)
    trend = fitted(data.t, data.y, weights=np.where(np.arange(60) % 2, 1.0, ratio), method=method)
    for estimate in trend.parameters.values():
        assert np.isfinite(estimate.value)
        assert estimate.stderr is None or np.isfinite(estimate.stderr)
    assert np.isfinite(trend.points.probability).all()


def test_equal_weights_change_nothing() -> None:
    data = contaminated(60, seed=12)
    plain, weighted = fitted(data.t, data.y), fitted(data.t, data.y, weights=np.full(60, 3.0))
    for name, estimate in plain.parameters.items():
        assert weighted.parameters[name].value == pytest.approx(estimate.value, rel=1e-9)
    np.testing.assert_array_equal(weighted.points.inlier, plain.points.inlier)
