"""Local optimisation: never worse, rarely called, and worth calling."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given as draws
from hypothesis import settings
from hypothesis import strategies as st

from estimators.consensus.evaluation import Evaluation, rank
from estimators.consensus.linear_model import LinearModel
from estimators.consensus.optimizers.least_squares import LeastSquares
from estimators.consensus.optimizers.lo_plus import LoPlus
from estimators.consensus.optimizers.lo_ransac import LoRansac
from estimators.consensus.optimizers.none import NoOptimization
from estimators.consensus.optimizers.plan import shrunk_threshold, subset_counter
from estimators.consensus.optimizers.readable import improve, polish
from estimators.consensus.protocols import Optimizer, Score
from estimators.consensus.scores.count import Count
from estimators.consensus.scores.msac import Msac
from estimators.consensus.verifiers.bail_out import BailOut
from estimators.options import RobustOptions
from tests.consensus.contaminated import SAMPLING, contaminated, found, given

OPTIMIZERS: list[Optimizer] = [NoOptimization(), LeastSquares(), LoRansac(), LoPlus()]


@pytest.mark.parametrize("optimizer", OPTIMIZERS, ids=lambda optimizer: type(optimizer).__name__)
@pytest.mark.parametrize("score", [Count(), Msac()], ids=["count", "msac"])
@settings(max_examples=25, deadline=None)
@draws(n=st.integers(3, 300), p=st.integers(1, 3), seed=st.integers(0, 10**6))
def test_local_optimisation_never_returns_a_worse_model(
    optimizer: Optimizer, score: Score, n: int, p: int, seed: int
) -> None:
    model = LinearModel(contaminated(n, seed, p=p))
    trial = Evaluation(model, score, BailOut(), 0.03)
    sample = np.sort(np.random.default_rng(seed).choice(n, p, replace=False))[None]
    theta = model.solve(sample).theta[0]
    before, _ = trial.value(theta)
    improved, value, _ = improve(trial, optimizer.plan(p), seed, 17, theta, before)
    assert rank(value) <= rank(before)
    assert rank(trial.value(improved)[0]) == rank(value)


@settings(max_examples=40, deadline=None)
@draws(n=st.integers(3, 300), p=st.integers(1, 3), seed=st.integers(0, 10**6))
def test_the_final_fit_never_has_a_larger_truncated_quadratic(n: int, p: int, seed: int) -> None:
    model = LinearModel(contaminated(n, seed, p=p))
    trial = Evaluation(model, Count(), BailOut(), 0.03)
    sample = np.sort(np.random.default_rng(seed).choice(n, p, replace=False))[None]
    theta = model.solve(sample).theta[0]
    judge = dataclasses.replace(trial, score=Msac())
    polished, value, _ = polish(trial, theta)
    assert rank(value) <= rank(judge.value(theta)[0])
    assert rank(judge.value(polished)[0]) == rank(value)


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("p", [1, 2, 3, 4])
def test_the_answer_is_least_squares_on_its_own_consensus(p: int, weighted: bool) -> None:
    data = contaminated(400, 7, p=p, weighted=weighted)
    result = found(SAMPLING["msac"].run(data, given(0.03), RobustOptions(), 0))
    root = np.ones(data.n) if data.weights is None else np.sqrt(data.weights)
    chosen = result.inlier
    expected, *_ = np.linalg.lstsq((data.columns * root).T[chosen], (data.y * root)[chosen], rcond=None)
    np.testing.assert_allclose(result.theta, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", ["msac", "lo-ransac"])
def test_optimisations_are_as_few_as_records_among_random_models(name: str) -> None:
    draws_made = 400
    options = RobustOptions(min_hypotheses=draws_made, max_hypotheses=draws_made, work_budget=0)
    search = dataclasses.replace(SAMPLING[name], block=1)
    data = contaminated(300, 1, outliers=0.6)
    calls = [found(search.run(data, given(0.03), options, seed)).ledger.optimizations for seed in range(80)]
    harmonic = float((1.0 / np.arange(1, draws_made + 1)).sum())
    # Records of an i.i.d. sequence: mean H_k, variance H_k - sum 1/i^2 (METHODS.md 6.1).
    spread = np.sqrt(harmonic - np.pi**2 / 6.0) / np.sqrt(80)
    assert abs(np.mean(calls) - harmonic) < 5.0 * spread


def test_an_optimisation_that_does_nothing_is_not_counted() -> None:
    result = found(SAMPLING["ransac"].run(contaminated(300, 1), given(0.03), RobustOptions(), 0))
    assert result.ledger.optimizations == 0


def test_a_consensus_without_redundancy_is_left_alone() -> None:
    model = LinearModel(contaminated(40, 0, sigma=0.0))
    trial = Evaluation(model, Msac(), BailOut(), 1e-9)
    theta = model.solve(np.array([[0, 1]])).theta[0]
    value = trial.value(theta)[0]._replace(inliers=3)
    few = Evaluation(LinearModel(contaminated(3, 0)), Msac(), BailOut(), 10.0)
    assert few.members(theta, 10.0).size == 3
    same, after, evaluations = improve(few, LoPlus().plan(2), 0, 0, theta, value)
    assert same is theta
    assert after == value
    assert evaluations == 0


def test_the_threshold_shrinks_from_its_multiple_to_itself() -> None:
    steps = [shrunk_threshold(2.0, 1.5, step, 4) for step in range(4)]
    assert steps == pytest.approx([3.0, 8.0 / 3.0, 7.0 / 3.0, 2.0])
    assert shrunk_threshold(2.0, 1.5, 0, 1) == 2.0


def test_no_two_subsets_of_an_optimisation_share_random_numbers() -> None:
    counters = {subset_counter(repetition, step, 4) for repetition in range(10) for step in range(5)}
    assert len(counters) == 50
    assert np.diff(sorted(counters)).min() >= 2**16
