"""What the search of ``auto`` counts and sorts: the same as the plain way to do it, only sooner."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.arrays import FloatArray
from estimators.consensus.structure.hypotheses import OCTAVES, scale_evidence
from estimators.consensus.structure.ranking import sort_values


def _plain_evidence(
    t: FloatArray, y: FloatArray, level: float, slope: float
) -> tuple[FloatArray, FloatArray]:
    """Kullback-Leibler gains over a background, from counts of residuals (METHODS.md 3.5)."""

    def entropy(k: int) -> float:
        return float(k * np.log(k)) if k > 0 else 0.0

    m = t.size - 2
    gain, contrast = np.zeros(OCTAVES), np.zeros(OCTAVES)
    distance = np.abs(y - level - slope * t)
    inside = [int(np.count_nonzero(distance < 2.0**-o)) - 2 for o in range(OCTAVES)]
    for o in range(2, OCTAVES):
        k, wide = inside[o], inside[o - 2]
        p = min(0.95, 2.0 * 2.0**-o)
        if k > m * p:
            gain[o] = entropy(k) - k * np.log(m * p) + entropy(m - k) - (m - k) * np.log(m * (1.0 - p))
        if 4 * k > wide > 0:
            rest = wide - k
            contrast[o] = entropy(k) + entropy(rest) - entropy(wide) - k * np.log(0.25) - rest * np.log(0.75)
    return gain, contrast


@settings(max_examples=30, deadline=None)
@given(n=st.integers(5, 90), outliers=st.floats(0.0, 0.7), seed=st.integers(0, 2**32))
def test_evidence_of_lines_comes_from_the_residuals_within_each_octave(
    n: int, outliers: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(-1.0, 1.0, n))
    y = 0.1 * t + rng.normal(0.0, 1e-3, n)
    stray = rng.random(n) < outliers
    y[stray] = rng.uniform(-0.5, 0.5, int(stray.sum()))
    first, second = rng.integers(0, n // 2, 7), rng.integers(n // 2, n, 7)
    slope = (y[second] - y[first]) / (t[second] - t[first])
    level = y[first] - slope * t[first]
    gain, contrast = np.full((OCTAVES, 7), np.nan), np.full((OCTAVES, 7), np.nan)
    scale_evidence(t, y, level, slope, 7, gain, contrast)
    for h in range(7):
        expected = _plain_evidence(t, y, level[h], slope[h])
        np.testing.assert_allclose(gain[:, h], expected[0], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(contrast[:, h], expected[1], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("n", [0, 1, 2, 200, 256, 257, 1000])
@pytest.mark.parametrize("different", [3, 10**9])
def test_values_are_sorted_however_many_and_however_tied(n: int, different: int) -> None:
    values = np.random.default_rng(n).integers(-different, different, n).astype(np.float64)
    expected = np.sort(values)
    sort_values(values)
    np.testing.assert_array_equal(values, expected)
