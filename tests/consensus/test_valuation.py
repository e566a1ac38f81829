"""What a model is worth, and that looking at less of it does not change the answer."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given as draws
from hypothesis import settings
from hypothesis import strategies as st

from estimators.consensus.evaluation import Evaluation, rank
from estimators.consensus.linear_model import LinearModel
from estimators.consensus.protocols import Score
from estimators.consensus.scan import Value
from estimators.consensus.scores.count import Count
from estimators.consensus.scores.msac import Msac
from estimators.consensus.search.sampling import SamplingSearch
from estimators.consensus.verifiers.bail_out import BailOut
from estimators.consensus.verifiers.full import Full
from estimators.options import RobustOptions
from tests.consensus.contaminated import SAMPLING, contaminated, differing_fields, found, given

MANY = RobustOptions(min_hypotheses=600, max_hypotheses=600, work_budget=0)


def evaluation(score: Score, n: int, seed: int, threshold: float = 0.1) -> Evaluation:
    return Evaluation(LinearModel(contaminated(n, seed)), score, Full(), threshold)


@pytest.mark.parametrize("score", [Count(), Msac()])
@settings(deadline=None)
@draws(n=st.integers(1, 1200), seed=st.integers(0, 10**6))
def test_the_loss_is_the_sum_of_rho_over_the_points(score: Score, n: int, seed: int) -> None:
    trial = evaluation(score, n, seed)
    theta = np.array([0.1, 0.2])
    value, evaluations = trial.value(theta)
    u = (trial.model.residuals(theta[None], 0, n)[0] / trial.threshold) ** 2
    assert value.loss == pytest.approx(float(score.rho(u).sum()), rel=1e-12)
    assert value.inliers == int((u <= 1.0).sum())
    assert value.squares == pytest.approx(float(u[u <= 1.0].sum()), rel=1e-12)
    assert evaluations == n


@pytest.mark.parametrize("score", [Count(), Msac()])
def test_a_point_exactly_at_the_threshold_is_an_inlier(score: Score) -> None:
    data = dataclasses.replace(contaminated(3, 0), y=np.array([0.5, 0.5 + 2**-40, 0.0]))
    value, _ = Evaluation(LinearModel(data), score, Full(), 0.5).value(np.zeros(2))
    assert value.inliers == 2


def test_models_with_equal_counts_are_told_apart_by_msac_and_not_by_the_count() -> None:
    close, loose = np.zeros(2), np.array([0.04, 0.0])
    data = dataclasses.replace(contaminated(50, 0), y=np.where(np.arange(50) < 30, 0.0, 0.9))
    for score, tied in [(Count(), True), (Msac(), False)]:
        trial = Evaluation(LinearModel(data), score, Full(), 0.05)
        (a, _), (b, _) = trial.value(close), trial.value(loose)
        assert a.inliers == b.inliers == 30
        assert (a.loss == b.loss) is tied
        assert a.loss <= b.loss


def test_ties_are_broken_by_inliers_then_squares() -> None:
    best, second, third, last = Value(1.0, 3, 9.0), Value(2.0, 5, 1.0), Value(2.0, 5, 2.0), Value(2.0, 4, 0.0)
    assert sorted([last, second, best, third], key=rank) == [best, second, third, last]


def test_the_earliest_of_equal_models_wins() -> None:
    trial = evaluation(Msac(), 40, 1)
    assert trial.values(np.array([[0.3, 0.3], [0.1, 0.2], [0.1, 0.2]])[[1, 2, 1]]).best() == 0


@pytest.mark.parametrize("search", SAMPLING.values(), ids=SAMPLING.keys())
@settings(max_examples=15, deadline=None)
@draws(n=st.integers(20, 1500), seed=st.integers(0, 10**6), outliers=st.sampled_from([0.2, 0.6]))
def test_bailing_out_changes_the_number_of_evaluations_and_nothing_else(
    search: SamplingSearch, n: int, seed: int, outliers: float
) -> None:
    data = contaminated(n, seed, outliers=outliers)
    assert BailOut().lossless
    full = found(dataclasses.replace(search, verifier=Full()).run(data, given(0.03), MANY, seed))
    fast = found(dataclasses.replace(search, verifier=BailOut()).run(data, given(0.03), MANY, seed))
    assert fast.ledger.point_evaluations <= full.ledger.point_evaluations
    equal_work = dataclasses.replace(fast.ledger, point_evaluations=full.ledger.point_evaluations)
    assert differing_fields(dataclasses.replace(fast, ledger=equal_work), full) == []


def test_bailing_out_saves_work_on_long_series() -> None:
    data = contaminated(5000, 2, outliers=0.3)
    search = SAMPLING["msac"]
    full = found(dataclasses.replace(search, verifier=Full()).run(data, given(0.03), MANY, 0))
    fast = found(search.run(data, given(0.03), MANY, 0))
    assert fast.ledger.point_evaluations < 0.75 * full.ledger.point_evaluations
