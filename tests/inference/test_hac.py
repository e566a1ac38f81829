"""Long-run variance: the kernel sum, its law, and what it makes of correlated scores."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.coverage import correlated_noise
from estimators.arrays import FloatArray
from estimators.inference.hac import LongRun, bartlett_sum, long_run
from estimators.inference.scores import point_scores
from estimators.regression.loss import Loss, LossKind


def _line(t: FloatArray, scores: FloatArray, lag1: float) -> LongRun:
    """Long-run variance of slope and level of a line."""
    center = 0.5 * (t[0] + t[-1])
    design = np.array([np.ones(t.size), t])
    found = long_run(t, scores, np.array([t - center, np.ones(t.size)]), design, lag1)
    assert found is not None
    return found


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
        found.append(_line(t, noise - noise.mean(), phi).ratio)
    # The long-run variance of an AR(1) process is (1 + phi) / (1 - phi) times its variance.
    np.testing.assert_allclose(np.mean(found, axis=0), (1 + phi) / (1 - phi), rtol=0.12)


def test_a_moving_average_is_caught_without_prewhitening() -> None:
    fresh = np.random.default_rng(1).normal(size=20_001)
    result = _line(np.arange(20_000.0), fresh[1:] - 0.5 * fresh[:-1], 0.0)
    assert result.ratio[1] == pytest.approx(0.25 / 1.25, rel=0.35)


def test_the_degrees_of_freedom_grow_with_the_series_and_not_with_its_unit() -> None:
    rng = np.random.default_rng(2)
    dof = [_line(np.arange(float(n)), rng.normal(size=n), 0.0).dof for n in (50, 200, 2000)]
    assert dof[0] < dof[1] < dof[2]
    scores = rng.normal(size=200)
    small, large = _line(np.arange(200.0), scores, 0.0), _line(np.arange(200.0) * 1024.0, scores, 0.0)
    assert small.dof == pytest.approx(large.dof)
    np.testing.assert_allclose(small.ratio, large.ratio)


def test_rejected_points_have_no_score_and_keep_their_place() -> None:
    residual = np.array([0.5, 100.0, -0.5])
    for loss in (Loss(LossKind.truncated, tuning=2.7), Loss(LossKind.bisquare, tuning=4.7)):
        scores = point_scores(residual, None, 1.0, loss)
        assert scores[1] == 0.0
        assert scores[0] == -scores[2] > 0.0


def test_scores_that_are_all_zero_have_no_variance() -> None:
    t, ones = np.arange(10.0), np.ones((1, 10))
    assert long_run(t, np.zeros(10), ones, ones, 0.0) is None


def test_noise_that_fades_slowly_hardly_touches_a_fast_season() -> None:
    t = np.arange(2000.0)
    phase = 2.0 * np.pi * t / 12.0
    design = np.array([np.ones(t.size), np.cos(phase), np.sin(phase)])
    found = []
    for seed in range(40):
        noise = correlated_noise(t, 0.8, np.random.default_rng(seed))
        result = long_run(t, noise - noise.mean(), design, design, 0.8)
        assert result is not None
        found.append(result.ratio)
    level, *season = np.mean(found, axis=0)
    # An AR(1) process has (1 - phi^2) / (1 - 2 phi cos w + phi^2) times its variance at the frequency w.
    expected = 0.36 / (1.64 - 1.6 * np.cos(2.0 * np.pi / 12.0))
    # The kernel lets in some of the noise of slower waves: a third more, on the cautious side.
    assert all(expected < ratio < 1.5 * expected for ratio in season)
    assert level == pytest.approx(9.0, rel=0.15)


def test_sums_of_the_same_scores_are_wholly_correlated_and_of_unrelated_ones_hardly() -> None:
    rng = np.random.default_rng(5)
    t = np.arange(3000.0)
    design = np.array([np.ones(t.size), t - t.mean()])
    scores = rng.normal(size=t.size)
    twice = long_run(t, scores, np.array([design[1], 2.0 * design[1]]), design, 0.0)
    assert twice is not None
    assert twice.correlation[0, 1] == pytest.approx(0.99)
    np.testing.assert_allclose(twice.ratio[0], twice.ratio[1])
    assert abs(_line(t, scores, 0.0).correlation[0, 1]) < 0.3


def test_precisions_count_in_the_law_of_the_estimate() -> None:
    rng = np.random.default_rng(6)
    t = np.linspace(-1.0, 1.0, 200)
    design = np.array([np.ones(t.size), t])
    root = np.exp(4.0 * t)  # all but the last part of the series weighs next to nothing
    weighted = long_run(t, rng.normal(size=200) * root, design[1:], design, 0.0, root)
    plain = long_run(t, rng.normal(size=200), design[1:], design, 0.0)
    assert weighted is not None
    assert plain is not None
    assert weighted.dof < 0.5 * plain.dof
