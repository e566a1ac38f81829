"""Invariants of every composition (METHODS.md 14), over random data."""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np
import pytest
from hypothesis import given as draws
from hypothesis import settings
from hypothesis import strategies as st

from estimators.arrays import BoolArray
from estimators.consensus.evaluation import Evaluation, rank
from estimators.consensus.linear_model import LinearModel
from estimators.consensus.optimizers.none import NoOptimization
from estimators.consensus.optimizers.readable import polish
from estimators.consensus.samplers.draws import Draws
from estimators.consensus.scores.msac import Msac
from estimators.consensus.search.sampling import SamplingSearch
from estimators.consensus.stopping import clean_probability
from estimators.consensus.termination import Adaptive
from estimators.consensus.verifiers.full import Full
from estimators.options import RobustOptions
from tests.consensus.contaminated import SAMPLING, contaminated, found, given

SAMPLED = RobustOptions(work_budget=0)
every_sampling_preset = pytest.mark.parametrize("search", SAMPLING.values(), ids=SAMPLING.keys())


@pytest.mark.parametrize("name", ["ransac", "msac"])
@pytest.mark.parametrize("p", [1, 2, 3])
@settings(max_examples=15, deadline=None)
@draws(n=st.integers(4, 20), seed=st.integers(0, 10**6))
def test_an_exhaustive_search_finds_the_best_of_all_minimal_models(
    name: str, p: int, n: int, seed: int
) -> None:
    data = contaminated(n, seed, p=p)
    search = dataclasses.replace(SAMPLING[name], optimizer=NoOptimization())
    result = found(search.run(data, given(0.03), RobustOptions(work_budget=10**8), 0))

    # Ties go to the earlier hypothesis, so the order has to be that of the enumeration.
    subsets = sorted(itertools.combinations(range(n), p), key=lambda subset: subset[::-1])
    models = [np.linalg.solve(data.columns[:, list(s)].T, data.y[list(s)]) for s in subsets]
    trial = Evaluation(LinearModel(data), search.score, Full(), 0.03)
    best = min(models, key=lambda theta: rank(trial.value(theta)[0]))
    expected, *_ = polish(trial, best)
    assert result.search == "exhaustive"
    assert result.ledger.drawn == math.comb(n, p)
    assert result.sampling_probability == 1.0
    np.testing.assert_allclose(result.theta, expected, rtol=0, atol=1e-7)
    assert (result.inlier == (np.abs(data.y - expected @ data.columns) <= 0.03)).all()


@pytest.mark.parametrize("name", ["msac", "prosac"])
@settings(max_examples=20, deadline=None)
@draws(n=st.integers(5, 60), seed=st.integers(0, 10**6))
def test_the_final_model_is_at_least_as_good_as_every_minimal_one(name: str, n: int, seed: int) -> None:
    data = contaminated(n, seed)
    result = found(SAMPLING[name].run(data, given(0.03), RobustOptions(), 0))
    trial = Evaluation(LinearModel(data), Msac(), Full(), 0.03)
    every = LinearModel(data).solve(np.array(list(itertools.combinations(range(n), 2)))).theta
    losses = trial.values(every).loss
    assert trial.value(result.theta)[0].loss <= losses.min()


@every_sampling_preset
@settings(max_examples=20, deadline=None)
@draws(
    n=st.integers(6, 300),
    seed=st.integers(0, 10**6),
    weighted=st.booleans(),
    power=st.integers(-60, 60),
    sign=st.sampled_from([-1.0, 1.0]),
)
def test_scaling_the_values_by_a_power_of_two_scales_the_model_to_the_bit(
    search: SamplingSearch, n: int, seed: int, weighted: bool, power: int, sign: float
) -> None:
    data, factor = contaminated(n, seed, weighted=weighted), sign * 2.0**power
    moved = dataclasses.replace(data, y=factor * data.y)
    a = found(search.run(data, given(0.03), SAMPLED, seed))
    b = found(search.run(moved, given(abs(factor) * 0.03), SAMPLED, seed))
    assert (b.theta == factor * a.theta).all()
    assert (b.residual == factor * a.residual).all()
    assert (b.inlier == a.inlier).all()
    assert b.ledger == a.ledger


@every_sampling_preset
@settings(max_examples=20, deadline=None)
@draws(
    n=st.integers(6, 300),
    seed=st.integers(0, 10**6),
    scale=st.floats(0.01, 100.0),
    slope=st.floats(-5.0, 5.0),
    level=st.floats(-5.0, 5.0),
)
def test_adding_a_line_and_scaling_moves_the_model_with_the_values_and_leaves_the_labels(
    search: SamplingSearch, n: int, seed: int, scale: float, slope: float, level: float
) -> None:
    data = contaminated(n, seed)
    moved = dataclasses.replace(data, y=scale * data.y + slope * data.t + level)
    a = found(search.run(data, given(0.03), SAMPLED, seed))
    b = found(search.run(moved, given(scale * 0.03), SAMPLED, seed))
    np.testing.assert_allclose(b.theta, scale * a.theta + [level, slope], rtol=0, atol=1e-11 * (10 + scale))
    assert (b.inlier == a.inlier).all()
    assert b.ledger.drawn == a.ledger.drawn


@every_sampling_preset
@settings(max_examples=20, deadline=None)
@draws(n=st.integers(6, 300), seed=st.integers(0, 10**6), weighted=st.booleans())
def test_labels_residuals_and_threshold_agree_with_the_model(
    search: SamplingSearch, n: int, seed: int, weighted: bool
) -> None:
    data = contaminated(n, seed, weighted=weighted)
    result = found(search.run(data, given(0.03), SAMPLED, seed))
    root = np.ones(n) if data.weights is None else np.sqrt(data.weights)
    np.testing.assert_allclose(result.residual, data.y - result.theta @ data.columns, rtol=0, atol=1e-14)
    margin = np.abs(np.abs(result.residual) * root - result.threshold)
    clear = margin > 1e-12
    assert (result.inlier == (np.abs(result.residual) * root <= result.threshold))[clear].all()


@pytest.mark.parametrize("name", ["ransac", "lo-ransac", "fischler-bolles"])
@settings(max_examples=20, deadline=None)
@draws(n=st.integers(6, 400), p=st.integers(1, 3), seed=st.integers(0, 10**6))
def test_the_ledger_reproduces_the_sampling_probability_of_uniform_draws(
    name: str, n: int, p: int, seed: int
) -> None:
    result = found(SAMPLING[name].run(contaminated(n, seed, p=p), given(0.03), SAMPLED, seed))
    clean = clean_probability(int(result.inlier.sum()), n, p)
    assert result.sampling_probability == pytest.approx(1.0 - (1.0 - clean) ** result.ledger.drawn, abs=1e-12)


@every_sampling_preset
@settings(max_examples=15, deadline=None)
@draws(n=st.integers(6, 400), seed=st.integers(0, 10**6), outliers=st.floats(0.0, 0.8))
def test_every_draw_is_in_the_ledger_and_within_the_bounds(
    search: SamplingSearch, n: int, seed: int, outliers: float
) -> None:
    options = RobustOptions(work_budget=0, min_hypotheses=30, max_hypotheses=100)
    result = found(search.run(contaminated(n, seed, outliers=outliers), given(0.03), options, seed))
    ledger = result.ledger
    assert ledger.degenerate + ledger.invalid + ledger.scored == ledger.drawn
    assert ledger.drawn <= 100
    assert ledger.drawn >= (30 if search.termination.may_enumerate else 1)


@dataclasses.dataclass(frozen=True)
class GreedyForDraws(Adaptive):
    """Asks for more draws at every new best model."""

    wanted: tuple[int, ...] = (150, 1000, 5000)
    asked: list[int] = dataclasses.field(default_factory=list)

    def after(self, draws: Draws, inlier: BoolArray, options: RobustOptions) -> int:
        del draws, inlier, options
        self.asked.append(self.wanted[min(len(self.asked), len(self.wanted) - 1)])
        return self.asked[-1]


def test_the_number_of_draws_never_grows_again() -> None:
    termination = GreedyForDraws()
    search = SamplingSearch(termination=termination, block=1, execution="readable")
    result = found(search.run(contaminated(200, 3, outliers=0.6), given(0.03), SAMPLED, 0))
    assert max(termination.asked) == 5000
    assert result.ledger.drawn == 150


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6])
def test_the_wanted_confidence_is_reached_unless_the_draws_run_out(share: float) -> None:
    data = contaminated(400, 6, outliers=share)
    for name, search in SAMPLING.items():
        result = found(search.run(data, given(0.03), SAMPLED, 0))
        assert result.sampling_probability is not None
        assert result.sampling_probability >= 0.99 or name == "fischler-bolles"
