"""The cells in which residuals are counted."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from estimators.consensus.labelling.cells import (
    CELLS,
    EDGES,
    REACH,
    SLOTS,
    count_residuals,
    octave_width,
)

NO_WEIGHTS = np.empty(0)


@settings(max_examples=100, deadline=None)
@given(
    residual=hnp.arrays(
        np.float64, st.integers(1, 40), elements=st.floats(-1e15, 1e15) | st.sampled_from(list(EDGES[:-1]))
    )
)
def test_every_residual_is_counted_on_its_side_between_the_edges_that_hold_it(residual: np.ndarray) -> None:
    counts = np.zeros((2, SLOTS))
    total, span, farthest = count_residuals(residual, NO_WEIGHTS, 1.0, counts)
    for side, mine in enumerate((residual <= 0.0, residual > 0.0)):
        slot = np.searchsorted(EDGES, np.abs(residual[mine]), side="right") - 1
        np.testing.assert_array_equal(counts[side], np.bincount(slot, minlength=SLOTS))
    assert total == residual.size
    assert span == np.ptp(residual)
    assert farthest == np.abs(residual).max()


def test_residuals_are_counted_in_scales_and_by_their_weight() -> None:
    residual, root = np.array([3.0, -40.0, 0.2]), np.array([1.0, 0.5, 2.0])
    weighted, plain = np.zeros((2, SLOTS)), np.zeros((2, SLOTS))
    count_residuals(residual, root, 2.0, weighted)
    count_residuals(residual * root, NO_WEIGHTS, 2.0, plain)
    np.testing.assert_array_equal(weighted, plain)


def test_of_a_long_series_a_part_is_counted() -> None:
    counts = np.zeros((2, SLOTS))
    total, _, _ = count_residuals(np.ones(200_000), NO_WEIGHTS, 1.0, counts)
    assert total == counts.sum() == 50_000


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e300])
def test_what_is_beyond_all_cells_is_counted_in_the_last(value: float) -> None:
    counts = np.zeros((2, SLOTS))
    count_residuals(np.array([value]), NO_WEIGHTS, 1.0, counts)
    assert counts[:, -1].sum() == counts.sum() == 1.0


def test_octaves_are_as_wide_as_the_residuals_go() -> None:
    assert octave_width(CELLS, 1e3) == REACH
    assert octave_width(CELLS + 2, 40.0) == 40.0 - 4 * REACH
    assert octave_width(CELLS + 2, 20.0) == 1.0
    assert octave_width(SLOTS - 1, 1e15) == 1e15 - EDGES[-2]
