"""Where samples come from: laws, fingerprints, and the exactness of what is said about them."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.consensus.samplers.draws import Draws, bind_sampler, fill_tables
from estimators.consensus.samplers.far_apart import FarApart
from estimators.consensus.samplers.prosac import LONGEST_GROWTH, Prosac
from estimators.consensus.samplers.uniform import Uniform

NO_ORDER = np.empty(0, dtype=np.int64)
HOSTAGE = np.concatenate([np.linspace(-1.0, -0.9, 98), [0.999, 1.0]])


def far_apart(t: np.ndarray, s: int = 2) -> Draws:
    return bind_sampler(FarApart.code, t, s, NO_ORDER, 0, 10**6, 0)


def prosac(n: int, s: int, order: np.ndarray | None = None, limit: int = 10_000) -> Draws:
    ranks = np.arange(n) if order is None else order
    return bind_sampler(Prosac.code, np.linspace(-1.0, 1.0, n), s, ranks, 0, limit, 0)


def growth(n: int, s: int) -> np.ndarray:
    table = np.zeros(n + 1, dtype=np.int64)
    fill_tables(n, s, table, np.zeros(n + 1, dtype=np.int64))
    return table


@pytest.mark.parametrize(
    "t", [np.linspace(-1.0, 1.0, 300), np.sort(np.random.default_rng(0).normal(0, 0.3, 300))]
)
def test_three_pairs_in_four_are_far_apart_in_time(t: np.ndarray) -> None:
    pairs = far_apart(t).block(0, 4000)
    distance = t[pairs[:, 1]] - t[pairs[:, 0]]
    chosen = np.arange(4000) % 4 != 3
    assert (distance[chosen] >= 0.3 * (t[-1] - t[0]) - 1e-12).all()
    assert (distance[~chosen] < 0.3 * (t[-1] - t[0])).any()


def test_a_uniform_sampler_draws_close_pairs_that_far_apart_sampling_avoids() -> None:
    t = np.linspace(-1.0, 1.0, 300)
    pairs = bind_sampler(Uniform.code, t, 2, NO_ORDER, 0, 10**6, 0).block(0, 4000)
    close = t[pairs[:, 1]] - t[pairs[:, 0]] < 0.6
    assert 0.4 < close.mean() < 0.6


def test_two_lonely_points_do_not_hold_every_pair_hostage() -> None:
    pairs = far_apart(HOSTAGE).block(0, 4000)
    assert (pairs[:, 1] < 98).mean() > 0.2


def test_far_apart_sampling_survives_times_that_are_all_equal() -> None:
    pairs = far_apart(np.zeros(30)).block(0, 500)
    assert (pairs[:, 0] < pairs[:, 1]).all()
    assert np.unique(pairs).size == 30


def test_larger_far_apart_samples_take_one_point_from_each_stretch() -> None:
    samples = far_apart(np.linspace(-1.0, 1.0, 90), s=3).block(0, 400)
    spread = samples[np.arange(400) % 4 != 3]
    assert (spread // 30 == [0, 1, 2]).all()


@pytest.mark.parametrize(
    ("t", "s"), [(np.linspace(-1.0, 1.0, 60), 2), (HOSTAGE, 2), (np.linspace(0.0, 1.0, 61), 3)]
)
@pytest.mark.parametrize("seed", [0, 1])
def test_the_chance_of_a_clean_far_apart_sample_is_the_share_of_clean_samples(
    t: np.ndarray, s: int, seed: int
) -> None:
    inlier = np.random.default_rng(seed).uniform(size=t.size) < 0.5
    draws = far_apart(t, s)
    samples = draws.block(0, 80_000)
    clean = inlier[samples].all(axis=1)
    for first, period in [(1, 3), (4, 4)]:
        said = -math.expm1(draws.log_miss(inlier, first))
        share = 1.0 - np.prod([1.0 - clean[k::4].mean() for k in range(first)])
        assert said == pytest.approx(share, abs=5.0 * period * math.sqrt(0.25 / 20_000))


def test_far_apart_draws_are_as_many_as_the_confidence_needs() -> None:
    t = np.linspace(-1.0, 1.0, 101)
    rng = np.random.default_rng(4)
    for share in (0.1, 0.3, 0.7, 0.99):
        inlier = rng.uniform(size=101) < share
        draws = far_apart(t)
        k = draws.needed(inlier, 0.99)
        assert -math.expm1(draws.log_miss(inlier, k)) >= 0.99
        assert k == 1 or -math.expm1(draws.log_miss(inlier, k - 1)) < 0.99


@pytest.mark.parametrize(("n", "s"), [(30, 2), (100, 2), (40, 3), (50, 4), (900, 3)])
def test_prosac_grows_as_its_closed_form_says(n: int, s: int) -> None:
    total = min(LONGEST_GROWTH, math.comb(n, s))
    average = [total * math.comb(m, s) / math.comb(n, s) for m in range(s, n + 1)]
    steps = [math.ceil(b - a - 1e-6) for a, b in itertools.pairwise(average)]
    assert growth(n, s)[s:].tolist() == np.cumsum([1, *steps]).tolist()


@settings(max_examples=30)
@given(n=st.integers(5, 200), s=st.integers(1, 4), seed=st.integers(0, 1000))
def test_every_growing_prosac_sample_contains_its_last_point(n: int, s: int, seed: int) -> None:
    order = np.random.default_rng(seed).permutation(n)
    table = growth(n, s)
    samples = prosac(n, s, order).block(0, min(int(table[-1]), 2000))
    for t, sample in enumerate(samples, start=1):
        length = s + int(np.searchsorted(table[s:], t))
        assert order[length - 1] in sample
        assert set(sample) <= set(order[:length].tolist())


def test_the_first_prosac_sample_is_the_best_points() -> None:
    order = np.array([4, 7, 1, 0, 2, 3, 5, 6, 8, 9])
    assert prosac(10, 3, order).block(0, 1).tolist() == [[1, 4, 7]]


def test_prosac_on_few_points_hardly_repeats_itself() -> None:
    pairs = {tuple(pair) for pair in prosac(30, 2).block(0, 300).tolist()}
    assert len(pairs) > 150


def test_the_sampling_probability_of_prosac_is_the_product_over_its_draws() -> None:
    n, s, drawn = 25, 2, 340
    rng = np.random.default_rng(8)
    order, inlier = rng.permutation(n), rng.uniform(size=n) < 0.2
    table, ranked = growth(n, s), inlier[order]
    log_miss = 0.0
    for t in range(1, drawn + 1):
        length = s + int(np.searchsorted(table[s:], t))
        if length > n:
            clean = math.comb(int(ranked.sum()), s) / math.comb(n, s)
        elif ranked[length - 1]:
            clean = math.comb(int(ranked[: length - 1].sum()), s - 1) / math.comb(length - 1, s - 1)
        else:
            clean = 0.0
        log_miss += math.log1p(-clean) if clean < 1.0 else -math.inf
    assert drawn > table[-1]
    assert prosac(n, s, order).log_miss(inlier, drawn) == pytest.approx(log_miss, rel=1e-12)


def test_prosac_stops_early_when_quality_points_at_the_inliers() -> None:
    n = 500
    good_first = np.arange(n) < 50
    good_last = np.arange(n) >= n - 50
    assert prosac(n, 2).needed(good_first, 0.99) <= 10
    assert prosac(n, 2).needed(good_last, 0.99) > 400


def test_prosac_does_not_stop_on_a_consensus_that_chance_explains() -> None:
    random_five = np.zeros(100, dtype=bool)
    random_five[:: 100 // 5] = True
    assert prosac(100, 2).needed(random_five, 0.99) > 10_000


def test_points_of_equal_quality_are_ordered_by_the_seed() -> None:
    quality = np.array([1.0, 5.0, 1.0, 1.0, 9.0, 1.0, 1.0, 1.0])
    orders = {tuple(Prosac().rank(quality, 8, seed).tolist()) for seed in range(40)}
    assert all(order[:2] == (4, 1) for order in orders)
    assert len(orders) > 30


@pytest.mark.parametrize(("n", "s"), [(9, 1), (12, 2), (9, 3), (8, 4), (5, 5)])
def test_enumeration_gives_every_subset_once_from_any_start(n: int, s: int) -> None:
    draws = bind_sampler(Uniform.code, np.arange(float(n)), s, NO_ORDER, 0, 10, 10**9)
    assert draws.total == math.comb(n, s)
    whole = draws.block(0, draws.total)
    assert sorted(map(tuple, whole.tolist())) == list(itertools.combinations(range(n), s))
    pieces = np.vstack([draws.block(k, 1) for k in range(draws.total)])
    assert (whole == pieces).all()


def test_enumeration_replaces_sampling_exactly_where_the_work_fits_the_budget() -> None:
    cost = math.comb(40, 2) * 40
    t = np.arange(40.0)
    assert bind_sampler(Uniform.code, t, 2, NO_ORDER, 0, 10, cost).total == math.comb(40, 2)
    assert bind_sampler(Uniform.code, t, 2, NO_ORDER, 0, 10, cost - 1).total is None
