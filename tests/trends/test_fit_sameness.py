"""The same data give the same answer: from any thread, with any seed, alone or in a batch."""

from __future__ import annotations

import itertools
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from estimators.consensus.structure.finish import TABLE
from estimators.consensus.structure.kernel import fit_structures
from estimators.consensus.structure.record import FOUND, RECORD
from estimators.noise import scale_floor
from estimators.regression.influence import SUMS
from tests.trends.contaminated import contaminated, fitted

SEEDS = range(16)


@pytest.mark.parametrize("method", ["auto", "msac", "mm"])
def test_threads_that_fit_at_once_do_not_disturb_one_another(method: str) -> None:
    series = [contaminated(150, 0.3, seed) for seed in SEEDS]
    alone = [fitted(data.t, data.y, method=method).to_dict() for data in series]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda data: fitted(data.t, data.y, method=method).to_dict(), series * 3))
    assert together == alone * 3


@pytest.mark.parametrize("seed", [1, 77, 2**63 - 1])
def test_auto_does_not_depend_on_the_seed(seed: int) -> None:
    data = contaminated(150, 0.4, 18)
    plain, seeded = fitted(data.t, data.y).to_dict(), fitted(data.t, data.y, seed=seed).to_dict()
    assert seeded["consensus"].pop("seed") == seed
    plain["consensus"].pop("seed")
    assert seeded == plain


def test_a_method_that_samples_repeats_itself_for_the_same_seed() -> None:
    data = contaminated(400, 0.4, 19)
    first, second = (fitted(data.t, data.y, method="ransac", seed=5).to_dict() for _ in range(2))
    assert first == second


def test_the_input_is_not_changed() -> None:
    data = contaminated(100, 0.3, 20)
    t, y, weights = data.t[::-1].copy(), data.y[::-1].copy(), np.linspace(0.0, 2.0, 100)
    kept = t.copy(), y.copy(), weights.copy()
    fitted(t, y, weights=weights)
    for before, after in zip(kept, (t, y, weights), strict=True):
        np.testing.assert_array_equal(after, before)


def test_read_only_and_strided_columns_are_taken() -> None:
    data = contaminated(100, 0.3, 21)
    table = np.column_stack([data.t, data.y])
    table.flags.writeable = False
    assert fitted(table[:, 0], table[:, 1]).parameters == fitted(data.t, data.y).parameters


def _batch(series: list[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> list[bytes]:
    """Every array that the kernel fills, per series, as bytes."""
    offsets = np.cumsum([0, *(t.size for t, _, _ in series)])
    t, y, root = (np.concatenate(columns) for columns in zip(*series, strict=True))
    total, count = t.size, len(series)
    floors = np.array([scale_floor(values) for _, values, _ in series])
    weight = np.zeros((count, TABLE + 1))
    inlier, probability, residual = np.zeros(total, np.bool_), np.zeros(total), np.zeros(total)
    sums, records = np.zeros((count, SUMS)), np.zeros((count, RECORD))
    fit_structures(
        offsets, t, y, root, floors, 0.0, 0.0, 2.7, weight, inlier, probability, residual, sums, records
    )
    assert records[:, FOUND].all()
    return [
        b"".join(
            part.tobytes()
            for part in (weight[k], inlier[i:j], probability[i:j], residual[i:j], sums[k], records[k])
        )
        for k, (i, j) in enumerate(itertools.pairwise(offsets))
    ]


def _made(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    data = contaminated(40 + 37 * seed, 0.3, seed)
    root = np.sqrt(np.random.default_rng(seed).uniform(0.5, 2.0, data.t.size))
    return (data.t - 50.0) / 50.0, data.y, root


def test_a_series_in_a_batch_gets_the_bytes_it_gets_alone() -> None:
    series = [_made(seed) for seed in SEEDS]
    alone = [_batch([one])[0] for one in series]
    assert _batch(series) == alone
    assert _batch(series[::-1]) == alone[::-1]


def test_batches_of_any_size_from_any_thread_give_the_same_bytes() -> None:
    series = [_made(seed) for seed in SEEDS]
    whole = _batch(series)
    for size in (1, 3, 8):
        parts = [series[k : k + size] for k in range(0, len(series), size)]
        with ThreadPoolExecutor(4) as pool:
            found = [item for part in pool.map(_batch, parts) for item in part]
        assert found == whole
