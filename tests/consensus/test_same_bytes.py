"""One answer whichever way it is computed: compiled or readable, alone or in a batch, on any threads."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given as draws
from hypothesis import settings
from hypothesis import strategies as st

from estimators.consensus.batch import search_many
from estimators.consensus.found import LinearData
from estimators.consensus.search.sampling import SamplingSearch
from estimators.options import RobustOptions
from tests.consensus.contaminated import SAMPLING, contaminated, differing_fields, found, given

FEW = RobustOptions(max_hypotheses=200, work_budget=0)
ENUMERATING = RobustOptions(work_budget=10**7)

every_sampling_preset = pytest.mark.parametrize("search", SAMPLING.values(), ids=SAMPLING.keys())


@every_sampling_preset
@settings(max_examples=30, deadline=None)
@draws(
    n=st.integers(5, 700),
    p=st.integers(1, 4),
    weighted=st.booleans(),
    outliers=st.sampled_from([0.0, 0.3, 0.6]),
    seed=st.integers(-(2**70), 2**70),
)
def test_readable_engine_and_compiled_path_give_the_same_bytes_when_sampling(
    search: SamplingSearch, n: int, p: int, weighted: bool, outliers: float, seed: int
) -> None:
    data = contaminated(n, seed % 2**32, p=p, outliers=outliers, weighted=weighted)
    compiled = found(search.run(data, given(0.03), FEW, seed))
    readable = found(dataclasses.replace(search, execution="readable").run(data, given(0.03), FEW, seed))
    assert compiled.search == "sampled"
    assert differing_fields(compiled, readable) == []


@every_sampling_preset
@settings(max_examples=20, deadline=None)
@draws(n=st.integers(4, 22), p=st.integers(1, 4), weighted=st.booleans(), seed=st.integers(0, 10**6))
def test_readable_engine_and_compiled_path_give_the_same_bytes_when_enumerating(
    search: SamplingSearch, n: int, p: int, weighted: bool, seed: int
) -> None:
    data = contaminated(n, seed, p=p, weighted=weighted)
    compiled = found(search.run(data, given(0.03), ENUMERATING, seed))
    readable = found(
        dataclasses.replace(search, execution="readable").run(data, given(0.03), ENUMERATING, seed)
    )
    assert compiled.search == ("exhaustive" if search.termination.may_enumerate else "sampled")
    assert differing_fields(compiled, readable) == []


def joined(series: list[LinearData]) -> tuple[LinearData, np.ndarray]:
    offsets = np.cumsum([0, *(one.n for one in series)])
    weights = None
    if series[0].weights is not None:
        weights = np.concatenate([one.weights for one in series])
    columns = np.ascontiguousarray(np.concatenate([one.columns for one in series], axis=1))
    y, t = np.concatenate([one.y for one in series]), np.concatenate([one.t for one in series])
    return LinearData(columns, y, t, weights), offsets


@every_sampling_preset
@pytest.mark.parametrize("weighted", [False, True])
def test_a_batch_of_series_equals_the_series_one_by_one(search: SamplingSearch, weighted: bool) -> None:
    series = [contaminated(n, seed=n, weighted=weighted) for n in (40, 300, 5, 90, 611, 2)]
    data, offsets = joined(series)
    records = search_many(data, offsets, np.full(len(series), 0.03), search, FEW, seed=3)
    for k, one in enumerate(series):
        alone = found(search.run(one, given(0.03), FEW, seed=3))
        outcome = records.outcome(k)
        assert outcome is not None
        assert outcome.theta.tobytes() == alone.theta.tobytes()
        assert outcome.inlier.tobytes() == alone.inlier.tobytes()
        assert records.residual[offsets[k] : offsets[k + 1]].tobytes() == alone.residual.tobytes()
        assert outcome.ledger == alone.ledger
        assert outcome.sampling_probability == alone.sampling_probability


@every_sampling_preset
@pytest.mark.parametrize("threads", [2, 5])
def test_the_number_of_threads_changes_nothing(search: SamplingSearch, threads: int) -> None:
    data, offsets = joined([contaminated(60 + 7 * k, seed=k) for k in range(23)])
    one = search_many(data, offsets, np.full(23, 0.03), search, FEW, seed=0)
    many = search_many(data, offsets, np.full(23, 0.03), search, FEW, seed=0, threads=threads)
    for field in ("theta", "inlier", "residual", "numbers", "counts"):
        assert getattr(one, field).tobytes() == getattr(many, field).tobytes()


def test_a_series_too_short_for_the_model_has_no_outcome_and_leaves_its_neighbours_alone() -> None:
    search = SAMPLING["msac"]
    full, empty, single = contaminated(80, seed=1), contaminated(0, seed=2), contaminated(1, seed=3)
    data, offsets = joined([full, empty, single, full])
    records = search_many(data, offsets, np.full(4, 0.03), search, FEW, seed=0)
    first, last = records.outcome(0), records.outcome(3)
    assert records.outcome(1) is None
    assert records.outcome(2) is None
    assert first is not None
    assert last is not None
    assert first.theta.tobytes() == last.theta.tobytes()


@every_sampling_preset
def test_the_same_call_twice_gives_the_same_bytes(search: SamplingSearch) -> None:
    data = contaminated(250, seed=5)
    a, b = (found(search.run(data, given(0.03), RobustOptions(), seed=11)) for _ in range(2))
    assert differing_fields(a, b) == []
