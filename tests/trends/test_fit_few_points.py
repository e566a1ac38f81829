"""Series of no, one and hardly more points."""

from __future__ import annotations

import numpy as np
import pytest

import estimators
from estimators import NoticeCode, fit_trend
from tests.trends.contaminated import fitted, refused

every_method = pytest.mark.parametrize("method", list(estimators.methods()))
CLOSE_TO_A_LINE = np.array([0.1, 0.9, 2.05, 2.95, 4.1])


@every_method
@pytest.mark.parametrize(("n", "reason"), [(0, "no_data"), (1, "too_few_points")])
def test_no_line_goes_through_fewer_than_two_points(method: str, n: int, reason: str) -> None:
    answer = refused(np.arange(float(n)), np.arange(float(n)), method=method)
    assert (answer.reason.value, answer.points.inlier.size) == (reason, n)
    assert not answer


@every_method
def test_no_line_goes_through_points_at_one_time(method: str) -> None:
    answer = refused(np.full(10, 7.0), np.arange(10.0), method=method)
    assert answer.reason.value == "constant_time"
    assert answer.points.reason == ["ok"] * 10


@every_method
def test_two_points_give_their_line_and_no_uncertainty(method: str) -> None:
    trend = fitted([1.0, 3.0], [2.0, 8.0], method=method)
    slope, intercept = trend.parameters["slope"], trend.parameters["intercept"]
    assert (slope.value, intercept.value) == pytest.approx((3.0, -1.0))
    assert (slope.stderr, slope.low, slope.high, trend.p_value) == (None, None, None, None)
    assert trend.uncertainty.method == "none"
    assert NoticeCode.no_redundancy in {item.code for item in trend.notices}


@every_method
@pytest.mark.parametrize("n", [3, 4, 5])
def test_a_few_points_near_a_line_give_it_with_a_warning(method: str, n: int) -> None:
    trend = fitted(np.arange(float(n)), CLOSE_TO_A_LINE[:n], method=method)
    assert trend.parameters["slope"].value == pytest.approx(1.0, abs=0.2)
    assert len(trend.points.reason) == n
    assert NoticeCode.few_points in {item.code for item in trend.notices}


@every_method
@pytest.mark.parametrize("n", range(2, 9))
def test_no_number_of_a_short_answer_is_nan(method: str, n: int) -> None:
    rng = np.random.default_rng(n)
    answer = fit_trend(np.arange(float(n)), rng.normal(size=n), method=method)
    if answer:
        for estimate in answer.parameters.values():
            assert np.isfinite(
                [x for x in (estimate.value, estimate.stderr, estimate.low) if x is not None]
            ).all()
        assert np.isfinite(answer.points.residual).all()
        assert answer.consensus.sigma > 0.0


def test_a_single_point_among_missing_ones_is_too_few() -> None:
    assert refused([0.0, 1.0, 2.0], [None, 3.0, None]).reason.value == "too_few_points"
