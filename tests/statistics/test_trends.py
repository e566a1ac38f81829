"""Statistical claims about ``auto``, small enough to run with every change.

The seeds are fixed, so a test either passes or fails; the bounds say how far a true claim may stray in so
few draws. ``python -m benchmarks.claims`` measures the same with many more.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import kstest

from benchmarks.bed import KINDS, Draw, draw_rng, make_series
from benchmarks.cells import Cell, Outcomes, measure, pool
from benchmarks.contenders import AUTO
from estimators import fit_trend
from tests.statistics.bounds import fewest, most

SEED = 71


def _measure(kind: str, n: int, share: float, draws: int) -> Outcomes:
    return measure((AUTO,), Cell(kind, n, share, draws), seed=SEED)[0]


def _draws(kind: str, n: int, share: float, draws: int) -> list[Draw]:
    return [make_series(kind, n, share, draw_rng(SEED, kind, n, share, index)) for index in range(draws)]


@pytest.mark.parametrize("share", [0.2, 0.4, 0.6])
@pytest.mark.parametrize("kind", KINDS)
def test_at_most_two_percent_of_the_lines_are_wrong(kind: str, share: float) -> None:
    outcome = pool(
        [_measure(kind, 50, share, 120), _measure(kind, 200, share, 80), _measure(kind, 1000, share, 50)]
    )
    draws = outcome.failed.size
    assert np.count_nonzero(outcome.failed) <= most(draws, 0.02), f"seed {SEED}"


@pytest.mark.parametrize("kind", ["shift", "burst"])
def test_one_sided_errors_and_bursts_of_eighty_percent_mislead_at_most_one_line_in_five(kind: str) -> None:
    outcome = pool(
        [_measure(kind, 50, 0.8, 120), _measure(kind, 200, 0.8, 80), _measure(kind, 1000, 0.8, 50)]
    )
    assert np.count_nonzero(outcome.failed) <= most(outcome.failed.size, 0.20), f"seed {SEED}"


def test_a_step_of_the_level_leaves_the_longer_branch_as_the_trend() -> None:
    outcome = pool(
        [_measure("step", 50, 0.0, 120), _measure("step", 200, 0.0, 80), _measure("step", 1000, 0.0, 50)]
    )
    assert np.count_nonzero(outcome.failed) <= most(outcome.failed.size, 0.10), f"seed {SEED}"


@pytest.mark.parametrize(("share", "ratio"), [(0.0, 1.10), (0.2, 1.10), (0.4, 1.15), (0.6, 1.20)])
def test_the_line_is_nearly_as_exact_as_the_oracles(share: float, ratio: float) -> None:
    reached = [
        _measure(kind, 200, share, 150).rms_over_oracle() for kind in ("uniform", "shift", "burst", "line2")
    ]
    # The mean of four ratios of 150 draws each has a standard error of about 0.015.
    assert np.mean(reached) <= ratio + 0.05, f"seed {SEED}"


@pytest.mark.parametrize(
    ("kind", "n", "share", "low"),
    [
        ("uniform", 200, 0.0, 0.93),
        ("uniform", 200, 0.4, 0.93),
        ("shift", 200, 0.4, 0.93),
        ("burst", 200, 0.4, 0.93),
        ("line2", 200, 0.2, 0.93),
        ("t2", 200, 0.4, 0.93),
        ("uniform", 50, 0.0, 0.91),
        ("uniform", 50, 0.4, 0.91),
        ("ar1_0.5", 80, 0.0, 0.91),
        ("ar1_0.8", 80, 0.0, 0.91),
        ("ar1_0.8", 200, 0.0, 0.91),
    ],
)
def test_the_interval_of_the_slope_covers_as_often_as_it_says(
    kind: str, n: int, share: float, low: float
) -> None:
    covered = _measure(kind, n, share, 400).covered
    assert not np.isnan(covered).any()
    high = 0.98 if low == 0.93 else 1.0
    assert fewest(400, low) <= np.count_nonzero(covered) <= most(400, high), f"seed {SEED}"


def test_clean_data_raise_few_alarms() -> None:
    draws = _draws("uniform", 200, 0.0, 200)
    flagged = [~fit_trend(draw.t, draw.y).points.inlier for draw in draws]
    # The threshold of 2.7 sigma leaves 0.7 % of a normal population outside.
    assert 0.004 <= np.mean(flagged) <= 0.012, f"seed {SEED}"


@pytest.mark.parametrize(("kind", "share"), [("uniform", 0.0), ("uniform", 0.4), ("ar1_0.5", 0.0)])
def test_p_values_are_uniform_where_there_is_no_trend(kind: str, share: float) -> None:
    draws = _draws(kind, 120, share, 400)
    p_values = np.array([fit_trend(draw.t, draw.y - draw.truth_slope * draw.t).p_value for draw in draws])
    assert kstest(p_values, "uniform").pvalue > 1e-4, f"seed {SEED}"
    assert np.count_nonzero(p_values < 0.05) <= most(400, 0.07), f"seed {SEED}"


def test_a_clear_trend_among_outliers_has_a_tiny_p_value() -> None:
    draws = [draw for draw in _draws("shift", 200, 0.4, 60) if abs(draw.truth_slope) > 0.1]
    assert max(fit_trend(draw.t, draw.y).p_value for draw in draws) < 1e-6, f"seed {SEED}"


def test_the_inlier_probabilities_add_up_to_the_inliers() -> None:
    draws = _draws("uniform", 200, 0.4, 100)
    stated = np.concatenate([fit_trend(draw.t, draw.y).points.probability for draw in draws])
    truth = np.concatenate([draw.inlier_mask for draw in draws])
    assert stated.mean() == pytest.approx(truth.mean(), abs=0.03), f"seed {SEED}"
    doubtful = (stated > 0.3) & (stated < 0.9)
    # A few hundred doubtful points: their share of true inliers has a standard error of about 0.03.
    assert truth[doubtful].mean() == pytest.approx(stated[doubtful].mean(), abs=0.12), f"seed {SEED}"
