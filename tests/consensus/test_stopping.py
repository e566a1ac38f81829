"""Stopping rules against the published numbers, against simulation, and against the definitions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom

from estimators.consensus.samplers.draws import fill_tables
from estimators.consensus.stopping import (
    UNBOUNDED,
    clean_probability,
    distinct_success,
    draws_needed,
    log_miss_per_draw,
)


def needed(inliers: int, n: int, s: int, confidence: float = 0.99) -> int:
    return draws_needed(log_miss_per_draw(clean_probability(inliers, n, s)), confidence)


@pytest.mark.parametrize(
    ("n", "inliers", "s", "exact"),
    [
        (20, 6, 2, 56),
        (100, 20, 2, 118),
        (100, 20, 3, 651),
        (100, 20, 5, 22361),
        (12, 8, 4, 31),
        (9, 6, 4, 37),
    ],
)
def test_the_number_of_draws_is_that_of_the_hypergeometric_law(
    n: int, inliers: int, s: int, exact: int
) -> None:
    assert needed(inliers, n, s) == exact


@given(n=st.integers(1, 200), s=st.integers(1, 8), data=st.data())
def test_the_clean_probability_is_a_quotient_of_binomial_coefficients(
    n: int, s: int, data: st.DataObject
) -> None:
    inliers = data.draw(st.integers(0, n))
    expected = math.comb(inliers, s) / math.comb(n, s) if s <= n else 0.0
    assert clean_probability(inliers, n, s) == pytest.approx(expected, rel=1e-12)


def test_without_a_clean_sample_no_number_of_draws_is_enough() -> None:
    assert needed(1, 50, 2) == UNBOUNDED


def test_with_inliers_only_one_draw_is_enough() -> None:
    assert needed(50, 50, 2) == 1


@given(n=st.integers(10, 10**6), s=st.integers(1, 5), share=st.floats(0.001, 1.0))
def test_the_draws_reach_the_confidence_and_one_fewer_does_not(n: int, s: int, share: float) -> None:
    p = clean_probability(int(share * n), n, s)
    k = draws_needed(log_miss_per_draw(p), 0.99)
    if k < UNBOUNDED and 1e-9 < p < 1.0:
        assert k * math.log1p(-p) <= math.log(0.01) * (1 - 1e-12)
        assert k == 1 or (k - 1) * math.log1p(-p) > math.log(0.01) * (1 + 1e-12)


def test_thirty_two_different_subsets_suffice_where_repeated_ones_need_thirty_seven() -> None:
    assert math.comb(9, 4) == 126
    assert distinct_success(6, 9, 4, 32) >= 0.99 > distinct_success(6, 9, 4, 31)


def test_more_different_subsets_than_there_are_unclean_ones_are_certain_to_hold_a_clean_one() -> None:
    # Three pairs of which one is clean: two different ones hold it in two cases of three.
    assert distinct_success(2, 3, 2, 2) == pytest.approx(2.0 / 3.0)
    assert distinct_success(2, 3, 2, 3) == 1.0


def test_the_formula_for_different_subsets_agrees_with_simulation() -> None:
    rng = np.random.default_rng(0)
    total, clean, drawn, runs = math.comb(9, 4), math.comb(6, 4), 12, 20_000
    hits = rng.hypergeometric(clean, total - clean, drawn, runs) > 0
    expected = distinct_success(6, 9, 4, drawn)
    assert abs(hits.mean() - expected) < 5.0 * math.sqrt(expected * (1.0 - expected) / runs)


def nonrandom_minima(n: int, s: int) -> np.ndarray:
    growth, minima = np.zeros(n + 1, dtype=np.int64), np.zeros(n + 1, dtype=np.int64)
    fill_tables(n, s, growth, minima)
    return minima


@pytest.mark.parametrize(("s", "expected"), [(2, [6, 8, 12, 36]), (4, [7, 10, 14, 38])])
def test_the_least_nonrandom_consensus_has_the_published_values(s: int, expected: list[int]) -> None:
    assert nonrandom_minima(500, s)[[20, 50, 100, 500]].tolist() == expected


@pytest.mark.parametrize("s", [1, 2, 3, 5])
def test_the_least_nonrandom_consensus_is_the_smallest_that_the_binomial_tail_allows(s: int) -> None:
    minima = nonrandom_minima(700, s)
    for m in range(s, 701):
        excess = minima[m] - s
        assert binom.sf(excess - 1, m - s, 0.05) < 0.05
        assert excess == 0 or binom.sf(excess - 2, m - s, 0.05) >= 0.05
