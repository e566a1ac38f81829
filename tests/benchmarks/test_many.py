"""The bed of many series: what it draws, measures and writes."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.many import CASES, POINTS, SHARE, ManyCase, ManySpeed, draw_batch, measure_many, to_markdown


def test_series_of_a_batch_differ_and_hold_their_share_of_outliers() -> None:
    t, y = draw_batch(70, seed=3)
    assert t.shape == y.shape == (70, POINTS)
    assert len({row.tobytes() for row in y}) == 64
    slope, level = np.polyfit(t[0], y[0], 1)
    far = np.abs(y[0] - level - slope * t[0]) > 8.0
    assert 0.5 * SHARE < far.mean() < 1.5 * SHARE


def test_a_measurement_has_a_rate_and_a_ratio_to_the_loop() -> None:
    case = ManyCase("few", "ransac", 2.7, 4)
    speed = measure_many(case, seed=1, repetitions=1, threads=1, sklearn_series=2)
    assert speed.case is case
    assert min(speed.per_second, speed.cpu_us, speed.times_sklearn, speed.times_sklearn_cpu) > 0.0


def test_the_page_has_a_row_for_every_case_and_size() -> None:
    speeds = [ManySpeed(case, 41234.0, 48.4, 512.3, 256.6) for case in CASES]
    page = to_markdown(speeds, [("one, no labels", 0.126), ("one, labels kept", math.nan)], threads=2)
    assert page.count("| 41,234 | 48 µs | 512 | 257 |") == len(CASES)
    assert "| one, no labels | 0.13 |\n| one, labels kept | - |\n" in page
    assert "with\n2 threads" in page
