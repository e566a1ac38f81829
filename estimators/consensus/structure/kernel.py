"""The compiled entry point of ``auto``: series in, fixed records out; a fit of one is a batch of one."""

from __future__ import annotations

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.labelling.posterior import posterior_of
from estimators.consensus.structure import record as slots
from estimators.consensus.structure.candidates import EVALUATIONS, PROPOSED, WEIGHED
from estimators.consensus.structure.choice import BANK, find_second, find_structure
from estimators.consensus.structure.criterion import IMPOSSIBLE
from estimators.consensus.structure.finish import TABLE, fill_tables, label_points, mean_square, solve_line
from estimators.consensus.structure.frame import fit_frame, thin, to_frame
from estimators.consensus.structure.mixture import LEVEL, SIGMA, SIZE, SLOPE
from estimators.kernels import device, kernel, ro
from estimators.regression.influence import A0, A1, A2, INLIERS, SSE, W0, W1, W2, sum_scatter
from estimators.regression.loss import LossKind

PROPOSE_FROM = 400
"""Points that lines are proposed from and sifted on."""
WEIGH_ON = 1000
"""Points that the finalists are fitted to; both subsets are spread over the whole series."""
MEASURE_ON = 16384
"""Points that the noise scale of a longer series is measured on."""

_FINEST = 1e-7
"""Least noise scale in units of the range: single precision tells no finer structure apart."""

_TABULATED = int(LossKind.tabulated)


@device
def fit_series(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    weighted: bool,
    floor: float,
    given_sigma: float,
    given_threshold: float,
    threshold_sigmas: float,
    weight: FloatArray,
    inlier: BoolArray,
    probability: FloatArray,
    residual: FloatArray,
    sums: FloatArray,
    record: FloatArray,
) -> None:
    """Fit one series whose times lie in [-1, 1]; values in their own units."""
    n = t.size
    record[:] = 0.0
    index = np.empty(min(n, WEIGH_ON), np.int64)
    m = thin(n, WEIGH_ON, index)
    sample_t = t[index]
    sample_y = y[index]
    frame = np.empty(4)
    subset = np.empty(min(m, PROPOSE_FROM), np.int64)
    h = thin(m, PROPOSE_FROM, subset)
    fit_frame(sample_t[subset], sample_y[subset], floor, frame)
    whole_t = np.empty(m)
    whole_y = np.empty(m)
    to_frame(sample_t, sample_y, frame, whole_t, whole_y)
    whole_root = root_weight[index] if weighted else np.ones(m)
    unit = frame[2]
    bank = np.zeros((BANK, SIZE))
    scores = np.full(BANK, IMPOSSIBLE)
    sides_of = np.zeros(BANK, np.int64)
    counts = np.zeros(3, np.int64)
    finest = max(floor / unit, _FINEST)
    best = find_structure(
        whole_t,
        whole_y,
        whole_root,
        whole_t[subset],
        whole_y[subset],
        whole_root[subset],
        finest,
        given_sigma / unit,
        bank,
        scores,
        sides_of,
        counts,
    )
    record[slots.PROPOSED] = counts[PROPOSED]
    record[slots.WEIGHED] = counts[WEIGHED]
    record[slots.EVALUATIONS] = counts[PROPOSED] * h + counts[EVALUATIONS]
    if best < 0:
        return
    chosen = bank[best]
    follow = np.empty(2 * TABLE + 1)
    fill_tables(chosen, m, weight, follow)
    s = chosen[SIGMA] * unit
    level = frame[0] + chosen[LEVEL] * unit
    slope = frame[1] + chosen[SLOPE] * unit
    if n > WEIGH_ON and given_sigma <= 0.0:
        # A thousand points know the scale to 3 %; more of the series know it better.
        rows = np.empty(min(n, MEASURE_ON), np.int64)
        thin(n, MEASURE_ON, rows)
        more = mean_square(t, y, root_weight, weighted, level, slope, s, weight, rows)
        few = mean_square(t, y, root_weight, weighted, level, slope, s, weight, index)
        if more > 0.0 and few > 0.0:
            s *= min(1.25, max(0.8, np.sqrt(more / few)))
    line = np.empty(2)
    newton = np.empty(8)
    solve_line(t, y, root_weight, weighted, level, slope, s, weight, line, newton)
    threshold = given_threshold if given_threshold > 0.0 else threshold_sigmas * s
    label_points(t, y, root_weight, weighted, line[0], line[1], threshold, inlier, residual)
    # The last Newton step stood close to the line: its sums are the curvature.
    sums[A0], sums[A1], sums[A2] = newton[2], newton[3], newton[4]
    sums[W0], sums[W1], sums[W2] = newton[5], newton[6], newton[7]
    sum_scatter(t, y, residual, root_weight, s, threshold, _TABULATED, 0.0, 0.0, weight, sums)
    if given_sigma <= 0.0 and chosen[SIGMA] <= 10.0 * finest and sums[INLIERS] > 2.0:
        # The structure is as fine as could be told apart; how fine it really is, its inliers say.
        s = max(floor, np.sqrt(sums[SSE] / (sums[INLIERS] - 2.0)))
    posterior_of(residual, root_weight, s, probability)
    record[slots.FOUND] = 1.0
    record[slots.LEVEL] = line[0]
    record[slots.SLOPE] = line[1]
    record[slots.SIGMA] = s
    record[slots.THRESHOLD] = threshold
    second = find_second(bank, scores, best)
    if second >= 0:
        _report_second(t, y, root_weight, weighted, bank[second], frame, threshold_sigmas, inlier, record)
        record[slots.RUNNER_MARGIN] = scores[best] - scores[second]


@device
def _report_second(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    weighted: bool,
    params: FloatArray,
    frame: FloatArray,
    threshold_sigmas: float,
    inlier: BoolArray,
    record: FloatArray,
) -> None:
    """Write the runner-up, and the number of points that follow it and not the answer."""
    s = params[SIGMA] * frame[2]
    level = frame[0] + params[LEVEL] * frame[2]
    slope = frame[1] + params[SLOPE] * frame[2]
    only = 0
    for i in range(t.size):
        root = root_weight[i] if weighted else 1.0
        if not inlier[i] and abs(y[i] - level - slope * t[i]) * root <= threshold_sigmas * s:
            only += 1
    record[slots.RUNNER] = 1.0
    record[slots.RUNNER_LEVEL] = level
    record[slots.RUNNER_SLOPE] = slope
    record[slots.RUNNER_SIGMA] = s
    record[slots.RUNNER_INLIERS] = only


_f8 = types.float64


@kernel(
    types.void(
        ro(types.int64), ro(_f8), ro(_f8), ro(_f8), ro(_f8), _f8, _f8, _f8,
        types.Array(_f8, 2, "C"), types.Array(types.boolean, 1, "C"), types.Array(_f8, 1, "C"),
        types.Array(_f8, 1, "C"), types.Array(_f8, 2, "C"), types.Array(_f8, 2, "C"),
    )
)  # fmt: skip
def fit_structures(
    offsets: IntArray,
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    floors: FloatArray,
    given_sigma: float,
    given_threshold: float,
    threshold_sigmas: float,
    weights: FloatArray,
    inlier: BoolArray,
    probability: FloatArray,
    residual: FloatArray,
    sums: FloatArray,
    records: FloatArray,
) -> None:
    """Fit many series: series k is ``offsets[k]:offsets[k + 1]``.

    ``root_weight`` has the length of ``y``, or 0 for no weights. ``weights`` receives the tabulated
    weight function of each series, ``records`` its fixed record.
    """
    weighted = root_weight.size > 0
    for k in range(offsets.size - 1):
        i = offsets[k]
        j = offsets[k + 1]
        roots = root_weight[i:j] if weighted else root_weight
        fit_series(
            t[i:j], y[i:j], roots, weighted, floors[k], given_sigma, given_threshold, threshold_sigmas,
            weights[k], inlier[i:j], probability[i:j], residual[i:j], sums[k], records[k],
        )  # fmt: skip
