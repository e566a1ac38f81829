"""The cheapest cut of a chain."""

from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators.arrays import BoolArray, FloatArray
from estimators.statespace.cut import cut_chain

SHARES = st.floats(0.0, 1.0)


def cut(closeness: FloatArray, weight: FloatArray, coherence: float) -> BoolArray:
    inlier = np.zeros(closeness.size, dtype=np.bool_)
    cut_chain(closeness, weight, coherence, inlier)
    return inlier


def energy(inlier: tuple[bool, ...], K: FloatArray, weight: FloatArray, coherence: float) -> float:
    """The equation, term by term."""
    unary = sum(1.0 - k if kept else k for kept, k in zip(inlier, K, strict=True))
    binary = 0.0
    for (left, right), (a, b), w in zip(pairwise(inlier), pairwise(K), weight, strict=True):
        mean = 0.5 * (a + b)
        binary += w * (1.0 if left != right else 1.0 - mean if left else mean)
    return (1.0 - coherence) * unary + coherence * binary


@given(st.lists(SHARES, min_size=1, max_size=8), SHARES, SHARES)
def test_no_labels_cost_less(closeness: list[float], weight: float, coherence: float) -> None:
    K, w = np.array(closeness), np.full(len(closeness) - 1, weight)
    least = min(energy(labels, K, w, coherence) for labels in product((False, True), repeat=K.size))
    found = energy(tuple(cut(K, w, coherence).tolist()), K, w, coherence)
    assert found == pytest.approx(least, abs=1e-12)


@given(st.lists(SHARES, max_size=30))
def test_without_coherence_it_is_a_threshold(closeness: list[float]) -> None:
    K = np.array(closeness)
    np.testing.assert_array_equal(cut(K, np.ones(max(K.size - 1, 0)), 0.0), 1.0 - K <= K)


def test_a_point_just_outside_joins_its_neighbours_and_a_lone_one_inside_leaves() -> None:
    among_good = cut(np.array([1.0, 1.0, 0.45, 1.0, 1.0]), np.ones(4), 0.3)
    among_faulty = cut(np.array([0.0, 0.0, 0.55, 0.0, 0.0]), np.ones(4), 0.3)
    assert among_good.all()
    assert not among_faulty.any()
