"""The table of methods, and the fingerprint by which each sampled one is known.

A fingerprint must fail when the policy that makes the method is exchanged for that of plain RANSAC.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from estimators.consensus.found import LinearData
from estimators.consensus.optimizers.none import NoOptimization
from estimators.consensus.presets import PRESETS
from estimators.consensus.samplers.uniform import Uniform
from estimators.consensus.scores.count import Count
from estimators.consensus.search.sampling import SamplingSearch
from estimators.consensus.termination import Adaptive, acceptable_inliers
from estimators.options import RobustOptions
from tests.consensus.contaminated import SAMPLING, contaminated, found, given

NAMES = (
    "auto", "ransac", "fischler-bolles", "msac", "lo-ransac", "prosac",
    "mm", "theil-sen", "siegel", "huber", "ols",
)  # fmt: skip


def test_the_methods_are_those_that_are_promised_and_auto_comes_first() -> None:
    assert next(iter(PRESETS)) == "auto"
    assert set(PRESETS) == set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_a_method_says_what_it_is_when_to_use_it_and_where_it_comes_from(name: str) -> None:
    preset = PRESETS[name]
    assert preset.name == name
    for text in (preset.title, preset.summary, preset.when_to_use, preset.source):
        assert text == text.strip() != ""
    assert preset.summary.endswith(".")
    assert preset.when_to_use.endswith(".")


def test_only_the_methods_for_comparison_are_not_robust() -> None:
    assert {name for name, preset in PRESETS.items() if not preset.robust} == {"ols", "huber"}


def test_methods_that_count_inliers_need_a_threshold_and_the_others_do_not() -> None:
    assert {name for name, preset in PRESETS.items() if preset.search.needs_threshold} == set(SAMPLING)


def test_no_two_sampled_methods_are_the_same_row() -> None:
    assert len(set(SAMPLING.values())) == len(SAMPLING)


def stops_at_the_first_acceptable_model(search: SamplingSearch) -> bool:
    result = found(search.run(contaminated(300, 1, outliers=0.2), given(0.03), RobustOptions(), 0))
    acceptable = acceptable_inliers(0, 300, 2)
    return result.ledger.drawn < RobustOptions().min_hypotheses and int(result.inlier.sum()) >= acceptable


def prefers_a_tight_structure_to_a_slightly_larger_loose_one(search: SamplingSearch) -> bool:
    t = np.linspace(-1.0, 1.0, 22)
    loose = np.arange(22) % 2 == 0
    loose[9] = True
    sway = 0.09 * np.where(np.arange(22) % 4 == 0, 1.0, -1.0)
    sway[[0, 20]] = 0.0
    y = np.where(loose, -1.0 + sway, 1.0)
    data = LinearData(np.array([np.ones(22), t]), y, t, None)
    result = found(search.run(data, given(0.1), RobustOptions(), 0))
    return bool((result.inlier == ~loose).all())


def needs_fewer_draws_than_ransac(search: SamplingSearch) -> bool:
    data = contaminated(300, 3, outliers=0.75, sigma=0.02)
    options = RobustOptions(work_budget=0, min_hypotheses=1)

    def mean_drawn(method: SamplingSearch) -> float:
        eager = dataclasses.replace(method, block=1)
        drawn = [found(eager.run(data, given(0.03), options, seed)).ledger.drawn for seed in range(20)]
        return float(np.mean(drawn))

    return mean_drawn(search) < 0.8 * mean_drawn(SAMPLING["ransac"])


def finds_the_trend_among_the_best_points_at_once(search: SamplingSearch) -> bool:
    rng = np.random.default_rng(0)
    t = np.linspace(-1.0, 1.0, 400)
    good = rng.permutation(400) < 30
    y = np.where(good, 0.4 * t, rng.uniform(-1.0, 1.0, 400))
    data = LinearData(np.array([np.ones(400), t]), y, t, np.where(good, 1.6, 0.95))
    options = RobustOptions(min_hypotheses=5, max_hypotheses=5)
    return bool(found(search.run(data, given(1e-3), options, 0)).inlier[good].all())


Fingerprint = Callable[[SamplingSearch], bool]
FINGERPRINTS: list[tuple[str, Fingerprint, dict[str, object]]] = [
    ("fischler-bolles", stops_at_the_first_acceptable_model, {"termination": Adaptive(), "block": 64}),
    ("msac", prefers_a_tight_structure_to_a_slightly_larger_loose_one, {"score": Count()}),
    ("lo-ransac", needs_fewer_draws_than_ransac, {"optimizer": NoOptimization()}),
    ("prosac", finds_the_trend_among_the_best_points_at_once, {"sampler": Uniform()}),
]


def test_every_sampled_method_but_ransac_itself_has_a_fingerprint() -> None:
    assert {name for name, *_ in FINGERPRINTS} == set(SAMPLING) - {"ransac"}


@pytest.mark.parametrize(("name", "fingerprint", "plain"), FINGERPRINTS, ids=[row[0] for row in FINGERPRINTS])
def test_a_method_has_its_fingerprint_and_loses_it_with_the_policy_of_plain_ransac(
    name: str, fingerprint: Fingerprint, plain: dict[str, object]
) -> None:
    search = SAMPLING[name]
    assert fingerprint(search)
    assert not fingerprint(dataclasses.replace(search, **plain))  # type: ignore[arg-type]


def test_a_first_acceptable_search_that_accepts_nothing_returns_the_largest_consensus() -> None:
    options = RobustOptions(acceptable_inliers=290)
    result = found(SAMPLING["fischler-bolles"].run(contaminated(300, 1), given(0.03), options, 0))
    assert 100 < int(result.inlier.sum()) < 290
    assert result.ledger.drawn == options.min_hypotheses
