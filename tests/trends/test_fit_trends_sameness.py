"""A table equals fits one by one, to the bit, whatever the series, the method and the number of threads."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from estimators import RobustOptions, fit_trend, fit_trends, methods
from tests.trends.batches import assert_equal, assert_row, assert_same_as_alone, batches
from tests.trends.contaminated import contaminated, fitted, two_lines

TAKES_WEIGHTS = [name for name in methods() if name not in ("theil-sen", "siegel")]
COMPILED = ["auto", "ransac", "fischler-bolles", "msac", "lo-ransac", "prosac"]
calmly = settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))


@pytest.mark.parametrize("method", list(methods()))
@calmly
@given(batches(), st.sampled_from([1, 2, 5]))
def test_a_batch_equals_fits_one_by_one(method: str, batch: Any, threads: int) -> None:
    t, y, offsets, _ = batch
    table = fit_trends(t, y, offsets, method=method, threads=threads)
    assert_same_as_alone(table, t, y, offsets, method=method)


@pytest.mark.parametrize("method", TAKES_WEIGHTS)
@calmly
@given(batches())
def test_a_weighted_batch_equals_fits_one_by_one(method: str, batch: Any) -> None:
    t, y, offsets, rng = batch
    weights = rng.uniform(0.1, 3.0, y.size) * (rng.random(y.size) > 0.1)
    table = fit_trends(t, y, offsets, method=method, weights=weights, threads=2)
    assert_same_as_alone(table, t, y, offsets, weights, method=method)


@pytest.mark.parametrize(
    "given_scale", [{"threshold": 2.5}, {"sigma": 0.8}, {"threshold": 2.0, "sigma": 1.2}]
)
@pytest.mark.parametrize("method", COMPILED)
@calmly
@given(batches())
def test_a_batch_with_a_given_scale_equals_fits_one_by_one(
    method: str, given_scale: dict[str, float], batch: Any
) -> None:
    t, y, offsets, _ = batch
    table = fit_trends(t, y, offsets, method=method, threads=1, **given_scale)
    assert_same_as_alone(table, t, y, offsets, method=method, **given_scale)


@calmly
@given(batches(), st.integers(0, 2**63 - 1), st.floats(0.5, 0.999), st.booleans())
def test_level_seed_and_options_are_those_of_single_fits(
    batch: Any, seed: int, level: float, corrected: bool
) -> None:
    t, y, offsets, _ = batch
    options = RobustOptions(correct_serial_correlation=corrected, threshold_sigmas=3.0)
    asked: dict[str, Any] = {"method": "ransac", "seed": seed, "level": level, "options": options}
    assert_same_as_alone(fit_trends(t, y, offsets, **asked), t, y, offsets, **asked)


@pytest.mark.parametrize("method", COMPILED)
def test_series_with_two_lines_are_told_ambiguous_as_one_by_one(method: str) -> None:
    pairs = [two_lines(120, share, seed) for seed, share in enumerate([0.5, 0.52, 0.55, 0.6, 0.7])]
    t, y = (np.concatenate(column) for column in zip(*pairs, strict=True))
    offsets = np.arange(6) * 120
    table = fit_trends(t, y, offsets, method=method, threshold=1.5)
    assert any("ambiguous_structure" in codes for codes in table.notices)
    assert_same_as_alone(table, t, y, offsets, method=method, threshold=1.5)


def _times(kind: str, n: int) -> np.ndarray:
    steps = np.cumsum(np.random.default_rng(5).integers(1, 9, n))
    return {
        "seconds": np.datetime64("2024-02-28T23:00:00", "s") + steps * np.timedelta64(7, "s"),
        "days": np.datetime64("1969-12-20", "D") + steps * np.timedelta64(1, "D"),
        "not-a-time": np.where(
            steps % 11 == 0,
            np.datetime64("NaT"),
            np.datetime64("1950-01-01") + steps * np.timedelta64(1, "D"),
        ),
        "int64": steps,
        "int32": steps.astype(np.int32),
        "uint64": steps.astype(np.uint64),
        "huge integers": steps + np.where(steps % 2 == 0, np.iinfo(np.int64).min, 2**62),
        "large integers": steps + (2**62 + 1),
        "float32": steps.astype(np.float32),
        "epoch nanoseconds as floats": 1.7e18 + steps * 1e9,
        "integers with gaps": np.array([None if s % 5 == 0 else int(s) + 2**60 for s in steps], dtype=object),
    }[kind]


@pytest.mark.parametrize(
    "kind",
    [
        "seconds",
        "days",
        "not-a-time",
        "int64",
        "int32",
        "uint64",
        "huge integers",
        "large integers",
        "float32",
        "epoch nanoseconds as floats",
        "integers with gaps",
    ],
)
@pytest.mark.parametrize("method", ["auto", "msac"])
def test_every_kind_of_time_is_read_as_one_by_one(kind: str, method: str) -> None:
    t = _times(kind, 100)
    offsets = np.array([0, 40, 41, 41, 100])
    y = np.concatenate([contaminated(40, 0.3, 1).y, [3.0], contaminated(59, 0.3, 2).y])
    assert_same_as_alone(
        fit_trends(t, y, offsets, method=method, threshold=3.0), t, y, offsets, method=method, threshold=3.0
    )


@pytest.mark.parametrize("dated", [False, True])
def test_series_may_share_their_times(dated: bool) -> None:
    series = [contaminated(90, 0.3, seed) for seed in range(7)]
    t: Any = np.arange(90.0) + 2000.0
    if dated:
        t = np.datetime64("2020-01-01") + np.arange(90) * np.timedelta64(1, "D")
    values = np.array([data.y for data in series])
    values[3, 10:20] = np.nan
    table = fit_trends(t, values)
    assert table.offsets.tolist() == [90 * k for k in range(8)]
    for k, row in enumerate(values):
        assert_row(table, k, fitted(t, row))
        assert_equal(table[k], fitted(t, row))


@pytest.mark.parametrize("threads", [1, 2, 3, 7])
def test_threads_and_slices_change_nothing(threads: int) -> None:
    rng = np.random.default_rng(11)
    lengths = rng.integers(0, 40, 2600)
    offsets = np.concatenate([[0], np.cumsum(lengths)])
    t = np.concatenate([np.sort(rng.uniform(0.0, 9.0, n)) for n in lengths])
    y = 1.0 + t + rng.normal(size=t.size) + 30.0 * (rng.random(t.size) < 0.3)
    y[rng.random(t.size) < 0.02] = np.nan
    table = fit_trends(t, y, offsets, method="msac", threshold=2.5, threads=threads)
    for k in (0, 1, 1023, 1024, 1025, 2047, 2048, 2599):
        rows = slice(offsets[k], offsets[k + 1])
        assert_row(table, k, fit_trend(t[rows], y[rows], method="msac", threshold=2.5))
    whole = fit_trends(t, y, offsets, method="msac", threshold=2.5, threads=1)
    assert whole.to_dict(points=True) == table.to_dict(points=True)


def test_a_long_series_is_a_slice_of_its_own() -> None:
    rng = np.random.default_rng(3)
    lengths = [10, 70_000, 20]
    offsets = np.concatenate([[0], np.cumsum(lengths)])
    t = np.concatenate([np.arange(float(n)) for n in lengths])
    y = 0.01 * t + rng.normal(size=t.size)
    assert_same_as_alone(fit_trends(t, y, offsets), t, y, offsets)
