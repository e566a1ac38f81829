"""Counter-based randomness: order does not matter, samples are distinct and uniform."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.consensus.randomness import SAMPLES, SUBSETS, as_counter, random_block, stratified_subset
from estimators.consensus.samplers.draws import Draws, bind_sampler
from estimators.consensus.samplers.uniform import Uniform

NO_ORDER = np.empty(0, dtype=np.int64)


def uniform(n: int, s: int, seed: int = 0) -> Draws:
    return bind_sampler(Uniform.code, np.arange(float(n)), s, NO_ORDER, seed, 10**6, 0)


@given(first=st.integers(0, 10**9), seed=st.integers(-(2**63), 2**63 - 1))
def test_a_number_depends_on_its_counters_and_not_on_the_block_it_is_drawn_in(first: int, seed: int) -> None:
    block = random_block(seed, SAMPLES, first, 8, 3)
    one_by_one = np.vstack([random_block(seed, SAMPLES, first + k, 1, 3) for k in reversed(range(8))])[::-1]
    assert (block == one_by_one).all()


def test_streams_seeds_and_draws_give_different_numbers() -> None:
    blocks = [random_block(seed, stream, 0, 100, 4) for seed in (0, 1) for stream in (SAMPLES, SUBSETS)]
    assert np.unique(np.concatenate(blocks)).size == 4 * 400


@given(seed=st.integers(-(2**80), 2**80))
def test_any_integer_is_a_seed(seed: int) -> None:
    assert -(2**63) <= as_counter(seed) < 2**63
    assert as_counter(seed) == as_counter(seed + 2**64)


@settings(max_examples=60)
@given(s=st.integers(1, 8), spare=st.integers(0, 40), seed=st.integers(0, 10**9))
def test_samples_hold_distinct_indices_in_ascending_order(s: int, spare: int, seed: int) -> None:
    samples = uniform(s + spare, s, seed).block(0, 200)
    assert samples.min() >= 0
    assert samples.max() < s + spare
    assert (np.diff(samples, axis=1) > 0).all()


def test_a_sample_of_all_points_is_all_points() -> None:
    assert (uniform(5, 5).block(0, 50) == np.arange(5)).all()


@pytest.mark.parametrize(("n", "s"), [(12, 2), (9, 3), (7, 4)])
def test_every_subset_is_equally_likely(n: int, s: int) -> None:
    subsets = {subset: k for k, subset in enumerate(itertools.combinations(range(n), s))}
    draws = 400 * len(subsets)
    samples = uniform(n, s).block(0, draws)
    counts = np.bincount([subsets[tuple(sample)] for sample in samples.tolist()], minlength=len(subsets))
    chi_square = ((counts - 400.0) ** 2 / 400.0).sum()
    freedom = len(subsets) - 1
    assert abs(chi_square - freedom) < 5.0 * np.sqrt(2.0 * freedom)


@given(n=st.integers(1, 3000), k=st.integers(1, 60), seed=st.integers(0, 10**6))
def test_a_stratified_subset_takes_one_index_from_each_stretch(n: int, k: int, seed: int) -> None:
    k = min(k, n)
    chosen = stratified_subset(seed, 5, 0, n, k)
    stretches = np.arange(k + 1) * n // k
    assert (stretches[:-1] <= chosen).all()
    assert (chosen < stretches[1:]).all()
