"""Many series, one compiled call: what goes into :mod:`.linear` and what comes out of it.

Series are values plus offsets, CSR-style; a fit of one is a batch of one. Threads split the series among
themselves and share nothing, so that their number changes no byte.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus import linear, linear_layout
from estimators.consensus.cancellation import Cancelled, cancel_flag
from estimators.consensus.found import LinearData
from estimators.consensus.linear_model import whiten
from estimators.consensus.outcome import Outcome
from estimators.consensus.protocols import Policies
from estimators.consensus.randomness import as_counter
from estimators.consensus.scan import Value
from estimators.options import RobustOptions
from estimators.result import Ledger

_NO_ORDER: IntArray = np.empty(0, dtype=np.int64)


@dataclass(frozen=True, slots=True)
class Records:
    """Models of many series.

    Attributes
    ----------
    offsets : ndarray of int64, shape (series + 1,)
    theta : ndarray of float64, shape (series, p)
        Undefined where the status is not ``FOUND``.
    inlier : ndarray of bool, shape (total,)
    residual : ndarray of float64, shape (total,)
        Signed, before weighting.
    numbers : ndarray of float64, shape (series, 5)
    counts : ndarray of int64, shape (series, 9)
        Columns of both are named in :mod:`estimators.consensus.linear_layout`.
    """

    offsets: IntArray
    theta: FloatArray
    inlier: BoolArray
    residual: FloatArray
    numbers: FloatArray
    counts: IntArray

    def outcome(self, k: int) -> Outcome | None:
        """Return what the search found in series k; None without a model."""
        counts = self.counts[k].tolist()
        if counts[linear_layout.STATUS] != linear_layout.FOUND:
            return None
        loss, squares, threshold, scatter, probability = self.numbers[k].tolist()
        return Outcome(
            theta=self.theta[k],
            inlier=self.inlier[self.offsets[k] : self.offsets[k + 1]],
            threshold=threshold,
            scatter=scatter,
            value=Value(loss, counts[linear_layout.INLIERS], squares),
            ledger=Ledger(*counts[: linear_layout.INLIERS]),
            sampling_probability=probability,
            exhaustive=bool(counts[linear_layout.EXHAUSTIVE]),
        )


def search_many(
    data: LinearData,
    offsets: IntArray,
    thresholds: FloatArray,
    policies: Policies,
    options: RobustOptions,
    seed: int,
    threads: int = 1,
) -> Records:
    """Search every series of a batch.

    Parameters
    ----------
    data : LinearData
        All series one after the other; times ascend within each.
    offsets : ndarray of int64, shape (series + 1,)
    thresholds : ndarray of float64, shape (series,)
        Largest |residual| * sqrt(weight) of an inlier.
    policies : Policies
    options : RobustOptions
    seed : int
        Every series is searched as if it were alone with this seed.
    threads : int
        Threads among which the series are split (default 1).

    Returns
    -------
    Records

    Raises
    ------
    Cancelled
        If the caller's flag was set (:mod:`estimators.consensus.cancellation`).
    """
    series, p, total = offsets.size - 1, data.p, data.n
    white_columns, white_y = whiten(data)
    records = Records(
        offsets,
        np.empty((series, p)),
        np.empty(total, dtype=np.bool_),
        np.empty(total),
        np.empty((series, 5)),
        np.empty((series, 9), dtype=np.int64),
    )
    flag = cancel_flag()
    order = _orders(data, offsets, policies, seed)
    plan = policies.optimizer.plan(p)

    def search_stretch(first: int, last: int) -> None:
        linear.search_batch(
            data.columns,
            data.y,
            white_columns,
            white_y,
            data.t,
            order,
            offsets,
            first,
            last,
            thresholds,
            policies.sampler.code,
            policies.score.code,
            policies.verifier.code,
            policies.termination.code,
            policies.block,
            options.min_hypotheses,
            options.max_hypotheses,
            options.work_budget,
            options.acceptable_inliers or 0,
            options.confidence,
            as_counter(seed),
            plan.repetitions,
            plan.sample,
            plan.limit,
            plan.steps,
            plan.multiplier,
            plan.finish,
            flag,
            records.theta,
            records.inlier,
            records.residual,
            records.numbers,
            records.counts,
        )

    if threads == 1 or series == 1:
        search_stretch(0, series)
    else:
        linear.search_batch.load()
        with ThreadPoolExecutor(threads) as pool:
            bounds = [series * k // threads for k in range(threads + 1)]
            list(pool.map(search_stretch, bounds[:-1], bounds[1:]))
    if flag[0]:
        raise Cancelled
    return records


def _orders(data: LinearData, offsets: IntArray, policies: Policies, seed: int) -> IntArray:
    """Ranks of the points within each series, if the sampler has an order of its own."""
    if offsets.size == 2:
        return policies.sampler.rank(data.weights, data.n, seed)
    if policies.sampler.rank(None, 1, seed).size == 0:
        return _NO_ORDER
    stretches = [
        policies.sampler.rank(None if data.weights is None else data.weights[a:b], b - a, seed)
        for a, b in pairwise(offsets.tolist())
    ]
    return np.concatenate(stretches) if stretches else _NO_ORDER
