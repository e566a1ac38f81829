"""Lines through the series of a slice: what a search found in each, as columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray, InputError, IntArray
from estimators.consensus.batch import search_many
from estimators.consensus.cancellation import Cancelled, cancel_flag
from estimators.consensus.found import LineData
from estimators.consensus.labelling.scale import untruncated_sigma
from estimators.consensus.linear_layout import FOUND as MODEL_FOUND
from estimators.consensus.linear_layout import PROBABILITY, SCATTER, STATUS
from estimators.consensus.linear_layout import THRESHOLD as USED_THRESHOLD
from estimators.consensus.search.sampling import SamplingSearch
from estimators.consensus.structure import record as slots
from estimators.consensus.structure.finish import TABLE
from estimators.consensus.structure.kernel import fit_structures
from estimators.inference.probability import posterior_of
from estimators.kernels import kernel, ro
from estimators.options import RobustOptions
from estimators.regression.influence import INLIERS, SUMS, sum_curvature, sum_scatter
from estimators.regression.loss import LossKind, truncated_jump
from estimators.trends.batch.group import Group, Known

_SLICE = 8192
"""Points between two looks at the flag that cancels: ``auto`` takes about 2 microseconds each."""

_TRUNCATED = int(LossKind.truncated)
_EMPTY = np.empty(0)


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """Lines found in a slice of series, in the units of the frame.

    Attributes
    ----------
    found : ndarray of bool, shape (m,)
        Whether there is a line; the other columns are undefined where there is none.
    theta : ndarray of float64, shape (m, 2)
        Level and slope.
    sigma, threshold : ndarray of float64, shape (m,)
    sampling_probability : ndarray of float64, shape (m,)
    inlier, probability, residual : ndarray, shape (points,)
    sums : ndarray of float64, shape (m, SUMS)
        Slots of :mod:`estimators.regression.influence`.
    records : ndarray of float64, shape (m, RECORD), or None
        Slots of :mod:`estimators.consensus.structure.record`, of the structure search.
    """

    found: BoolArray
    theta: FloatArray
    sigma: FloatArray
    threshold: FloatArray
    sampling_probability: FloatArray
    inlier: BoolArray
    probability: FloatArray
    residual: FloatArray
    sums: FloatArray
    records: FloatArray | None

    def select(self, kept: BoolArray, points: BoolArray) -> Lines:
        """Keep some of the series, and the points that are theirs."""
        return Lines(
            self.found[kept],
            self.theta[kept],
            self.sigma[kept],
            self.threshold[kept],
            self.sampling_probability[kept],
            self.inlier[points],
            self.probability[points],
            self.residual[points],
            self.sums[kept],
            None if self.records is None else self.records[kept],
        )


def find_structures(
    group: Group, sigma: float | None, threshold: float | None, options: RobustOptions
) -> Lines:
    """Run the search of ``auto`` on every series; each needs at least four points.

    Raises
    ------
    Cancelled
        If the caller's flag was set.
    """
    m, points = group.size, group.t.size
    root = _EMPTY if group.weights is None else np.sqrt(group.weights)
    inlier = np.empty(points, dtype=np.bool_)
    probability, residual = np.empty(points), np.empty(points)
    sums = np.empty((m, SUMS))
    records = np.empty((m, slots.RECORD))
    flag = cancel_flag()
    first = 0
    while first < m:
        if flag[0]:
            raise Cancelled
        start = int(group.offsets[first])
        last = int(np.searchsorted(group.offsets, start + _SLICE, "right")) - 1
        last = min(max(last, first + 1), m)
        rows = slice(start, int(group.offsets[last]))
        fit_structures(
            group.offsets[first : last + 1] - start, group.t[rows], group.y[rows],
            root[rows] if root.size else root, group.floor[first:last], sigma or 0.0, threshold or 0.0,
            options.threshold_sigmas, np.empty((last - first, TABLE + 1)), inlier[rows], probability[rows],
            residual[rows], sums[first:last], records[first:last],
        )  # fmt: skip
        first = last
    n = np.diff(group.offsets)
    return Lines(
        found=records[:, slots.FOUND] != 0.0,
        theta=np.ascontiguousarray(records[:, [slots.LEVEL, slots.SLOPE]]),
        sigma=records[:, slots.SIGMA].copy(),
        threshold=records[:, slots.THRESHOLD].copy(),
        sampling_probability=_pair_probability(sums[:, INLIERS], n, records[:, slots.PROPOSED]),
        inlier=inlier,
        probability=probability,
        residual=residual,
        sums=sums,
        records=records,
    )


def _pair_probability(inliers: FloatArray, n: IntArray, drawn: FloatArray) -> FloatArray:
    """Chance that a clean pair was drawn, as the structure search of one series tells it."""
    # What stands where no line was found may be anything.
    with np.errstate(invalid="ignore", over="ignore"):
        clean = np.where(inliers < 2, 0.0, 1.0 * (inliers / n) * ((inliers - 1) / (n - 1)))
        return -np.expm1(drawn * np.log1p(-np.minimum(clean, 1.0 - 1e-16)))


def find_consensus(
    group: Group,
    search: SamplingSearch,
    known: Known,
    options: RobustOptions,
    seed: int,
    *,
    rate_points: bool = True,
) -> Lines:
    """Run a search by sampling on every series.

    Parameters
    ----------
    group : Group
    search : SamplingSearch
    known : Known
        With a threshold.
    options : RobustOptions
    seed : int
    rate_points : bool
        Whether to fill the inlier probabilities (default True); they take a tenth of the time.

    Raises
    ------
    InputError
        Without a threshold.
    Cancelled
        If the caller's flag was set.
    """
    if known.threshold is None:
        raise InputError("threshold", "methods that count inliers need a threshold or a noise scale")
    m, points = group.size, group.t.size
    data = LineData(group.t, group.y, group.weights)
    records = search_many(data, group.offsets, known.threshold, search, options, seed)
    found = records.counts[:, STATUS] == MODEL_FOUND
    used = np.where(found, records.numbers[:, USED_THRESHOLD], 1.0)
    sigma = known.sigma
    if sigma is None:
        sigma = np.empty(m)
        fill_sigma(np.where(found, records.numbers[:, SCATTER], 1.0), used, group.floor, sigma)
    tuning = used / sigma
    jump = np.array([truncated_jump(c) for c in tuning.tolist()])
    sums = np.empty((m, SUMS))
    probability = np.empty(points)
    weigh_consensus(
        group.offsets, group.t, group.y, _EMPTY if group.weights is None else np.sqrt(group.weights), found,
        records.residual, sigma, used, group.floor, tuning, jump, rate_points, sums, probability,
    )  # fmt: skip
    return Lines(
        found=found,
        theta=records.theta,
        sigma=sigma,
        threshold=used,
        sampling_probability=records.numbers[:, PROBABILITY].copy(),
        inlier=records.inlier,
        probability=probability,
        residual=records.residual,
        sums=sums,
        records=None,
    )


_REAL = types.float64


@kernel(types.void(ro(_REAL), ro(_REAL), ro(_REAL), _REAL[::1]))
def fill_sigma(scatter: FloatArray, threshold: FloatArray, floor: FloatArray, sigma: FloatArray) -> None:
    """Noise scales of consensus sets that their thresholds have cut, at least the floors."""
    for k in range(sigma.size):
        sigma[k] = max(untruncated_sigma(scatter[k], threshold[k]), floor[k])


@kernel(
    types.void(
        ro(types.int64), ro(_REAL), ro(_REAL), ro(_REAL), ro(types.boolean), ro(_REAL), ro(_REAL), ro(_REAL),
        ro(_REAL), ro(_REAL), ro(_REAL), types.boolean, _REAL[:, ::1], _REAL[::1],
    )
)  # fmt: skip
def weigh_consensus(
    offsets: IntArray,
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    found: BoolArray,
    residual: FloatArray,
    sigma: FloatArray,
    threshold: FloatArray,
    floor: FloatArray,
    tuning: FloatArray,
    jump: FloatArray,
    rate_points: bool,
    sums: FloatArray,
    probability: FloatArray,
) -> None:
    """Influence sums and posteriors of many series under the truncated quadratic."""
    weighted = root_weight.size > 0
    table = np.empty(0)
    for k in range(sigma.size):
        if not found[k]:
            continue
        a, b = offsets[k], offsets[k + 1]
        roots = root_weight[a:b] if weighted else root_weight
        r = residual[a:b]
        sum_curvature(t[a:b], r, roots, sigma[k], _TRUNCATED, tuning[k], jump[k], table, sums[k])
        sum_scatter(
            t[a:b], y[a:b], r, roots, sigma[k], threshold[k], _TRUNCATED, tuning[k], jump[k], table, sums[k]
        )
        if rate_points:
            posterior_of(r, roots, max(sigma[k], floor[k]), probability[a:b])
