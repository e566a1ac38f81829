"""Claims about inference on request, on few draws; ``python -m benchmarks.coverage`` takes more."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import kstest

from benchmarks.bed import KINDS
from benchmarks.coverage import Noise, calibrate, infer
from tests.statistics.bounds import fewest, most

SEED = 19


@pytest.mark.parametrize("method", ["effective-n", "hac"])
@pytest.mark.parametrize("phi", [0.0, 0.5, 0.8])
@pytest.mark.parametrize(("outliers", "times"), [(0.0, "regular"), (0.2, "irregular")])
def test_formulas_reject_no_more_than_they_say_where_there_is_no_trend(
    method: str, phi: float, outliers: float, times: str
) -> None:
    found = infer(Noise(80, phi, outliers, times), method, 500, SEED)
    for level in (0.01, 0.05, 0.10):
        assert np.count_nonzero(found.p_values < level) <= most(500, 1.2 * level), f"seed {SEED}"
    assert np.count_nonzero(found.covered) >= fewest(500, 0.92), f"seed {SEED}"


@pytest.mark.parametrize("method", ["bootstrap", "permutation"])
@pytest.mark.parametrize("phi", [0.0, 0.8])
def test_resampling_rejects_no_more_than_it_says_where_there_is_no_trend(method: str, phi: float) -> None:
    found = infer(Noise(80, phi, 0.2, "irregular"), method, 120, SEED)
    assert np.count_nonzero(found.p_values < 0.05) <= most(120, 0.07), f"seed {SEED}"
    assert np.count_nonzero(found.covered) >= fewest(120, 0.91), f"seed {SEED}"


def test_permutation_p_values_are_uniform_where_there_is_no_trend() -> None:
    found = infer(Noise(80, 0.5, 0.0, "regular"), "permutation", 200, SEED)
    # Ranks among 99 are uniform on hundredths: the statistic is off by half of one at most.
    assert kstest(found.p_values - 0.005, "uniform").pvalue > 1e-3, f"seed {SEED}"


@pytest.mark.parametrize("method", ["auto", "msac"])
@pytest.mark.parametrize("kind", KINDS)
def test_inlier_probabilities_are_calibrated(method: str, kind: str) -> None:
    for share in (0.2, 0.4, 0.6):
        # 0.02 is claimed on average over many draws; so few leave an error of about 0.005.
        assert calibrate(kind, share, method, 12, SEED) <= 0.025, f"seed {SEED}"
