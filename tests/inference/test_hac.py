"""Long-run variance: the kernel sum, its law, and what it makes of correlated scores."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.coverage import correlated_noise
from estimators.inference.hac import bartlett_sum, long_run
from estimators.inference.scores import point_scores
from estimators.regression.loss import Loss, LossKind


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000), n=st.integers(1, 60), bandwidth=st.floats(0.01, 5.0))
def test_the_linear_time_sum_is_that_over_all_pairs(seed: int, n: int, bandwidth: float) -> None:
    rng = np.random.default_rng(seed)
    t = np.sort(rng.choice(np.linspace(-1.0, 1.0, 40), size=n))  # with ties
    a, b = rng.normal(size=n), rng.normal(size=n)
    taper = np.maximum(1.0 - np.abs(t[:, None] - t[None, :]) / bandwidth, 0.0)
    assert bartlett_sum(t, a, b, bandwidth) == pytest.approx(float(a @ taper @ b), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.8])
def test_correlated_scores_have_the_long_run_variance_of_their_process(phi: float) -> None:
    found = []
    for seed in range(40):
        t = np.arange(2000.0)
        noise = correlated_noise(t, phi, np.random.default_rng(seed))
        result = long_run(t, noise - noise.mean(), 999.5, phi)
        assert result is not None
        found.append((result.level, result.slope))
    # The long-run variance of an AR(1) process is (1 + phi) / (1 - phi) times its variance.
    np.testing.assert_allclose(np.mean(found, axis=0), (1 + phi) / (1 - phi), rtol=0.12)


def test_a_moving_average_is_caught_without_prewhitening() -> None:
    fresh = np.random.default_rng(1).normal(size=20_001)
    result = long_run(np.arange(20_000.0), fresh[1:] - 0.5 * fresh[:-1], 9999.5, 0.0)
    assert result is not None
    assert result.level == pytest.approx(0.25 / 1.25, rel=0.35)


def test_the_degrees_of_freedom_grow_with_the_series_and_not_with_its_unit() -> None:
    rng = np.random.default_rng(2)
    dof = [long_run(np.arange(float(n)), rng.normal(size=n), (n - 1) / 2, 0.0).dof for n in (50, 200, 2000)]
    assert dof[0] < dof[1] < dof[2]
    scores = rng.normal(size=200)
    small = long_run(np.arange(200.0), scores, 99.5, 0.0)
    large = long_run(np.arange(200.0) * 1024.0, scores, 99.5 * 1024.0, 0.0)
    assert small.dof == pytest.approx(large.dof)
    assert small.slope == pytest.approx(large.slope)


def test_rejected_points_have_no_score_and_keep_their_place() -> None:
    residual = np.array([0.5, 100.0, -0.5])
    for loss in (Loss(LossKind.truncated, tuning=2.7), Loss(LossKind.bisquare, tuning=4.7)):
        scores = point_scores(residual, None, 1.0, loss)
        assert scores[1] == 0.0
        assert scores[0] == -scores[2] > 0.0


def test_scores_that_are_all_zero_have_no_variance() -> None:
    assert long_run(np.arange(10.0), np.zeros(10), 4.5, 0.0) is None
