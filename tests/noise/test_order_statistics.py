"""Order statistics in linear time."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from estimators.noise.selection import kth_smallest, median_of

values = arrays(
    np.float64, st.integers(1, 60), elements=st.sampled_from([-2.0, -0.5, 0.0, 1.0, 1e300, np.pi])
)


@given(values, st.randoms())
@settings(deadline=None)
def test_the_kth_smallest_is_the_kth_of_the_sorted_values(sample: np.ndarray, random: object) -> None:
    k = random.randrange(sample.size)  # type: ignore[attr-defined]
    assert kth_smallest(sample.copy(), sample.size, k) == np.sort(sample)[k]


@given(values)
@settings(deadline=None)
def test_the_median_is_numpys(sample: np.ndarray) -> None:
    assert median_of(sample.copy(), sample.size) == np.median(sample)


def test_selection_leaves_what_lies_behind_the_given_size_alone() -> None:
    work = np.array([3.0, 1.0, 2.0, -99.0])
    assert median_of(work, 3) == 2.0
    assert work[3] == -99.0


def test_a_million_equal_values_are_selected_from() -> None:
    assert kth_smallest(np.ones(1_000_000), 1_000_000, 400_000) == 1.0
