"""The compiled entry point of ``auto``: series in, fixed records out; a fit of one is a batch of one."""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.consensus.structure.choice import (
    BANK,
    find_structure,
    same_line,
)
from estimators.consensus.structure.finish import TABLE, fill_tables, label_points, solve_line
from estimators.consensus.structure.mixture import INLIERS, LEVEL, LIKELIHOOD, SIGMA, SIZE, SLOPE
from estimators.kernels import device, kernel, ro

PROPOSE_FROM = 400
"""Points that pairs are drawn from."""
WEIGH_ON = 1000
"""Points that the mixtures are fitted to; both subsets are strided over the whole series."""

# Slots of a series' record.
FOUND = 0
REC_LEVEL = 1
REC_SLOPE = 2
REC_SIGMA = 3
REC_THRESHOLD = 4
REC_INLIERS = 5
REC_SIDES = 6
REC_SHARE = 7
REC_PAIRS = 8
REC_CANDIDATES = 9
REC_EVALUATIONS = 10
REC_TIED = 11
REC_RUNNER = 12  # 1 if there is a runner-up; then level, slope, sigma, margin, points that follow only it
REC_RUNNER_LEVEL = 13
REC_RUNNER_SLOPE = 14
REC_RUNNER_SIGMA = 15
REC_RUNNER_MARGIN = 16
REC_RUNNER_INLIERS = 17
RECORD = 18

_GOLDEN = 0.6180339887498949


@device
def thin(n, most, index):
    """Fill ``index`` with at most ``most`` rows spread evenly over n; returns how many."""
    if n <= most:
        for k in range(n):
            index[k] = k
        return n
    for k in range(most):
        index[k] = int((k + 0.5) * n / most)
    return most


@device
def quantum_of(values):
    """Share of tied neighbours among the sorted values, and the smallest gap between different ones."""
    ordered = np.sort(values)
    ties = 0
    gap = np.inf
    for i in range(1, ordered.size):
        d = ordered[i] - ordered[i - 1]
        if d == 0.0:
            ties += 1
        elif d < gap:
            gap = d
    return ties / max(1, ordered.size - 1), gap


@device
def fit_series(
    t, y, root_weight, weighted, floor, given_sigma, given_threshold, threshold_sigmas, weight, inlier,
    probability, residual, record,
):  # fmt: skip
    """Fit one series whose times lie in [-1, 1]; values in their own units."""
    n = t.size
    for k in range(RECORD):
        record[k] = 0.0
    low = y[0]
    high = y[0]
    for i in range(n):
        v = y[i]
        low = min(low, v)
        high = max(high, v)
    middle = 0.5 * low + 0.5 * high
    unit = high - low
    if unit <= 0.0:
        unit = max(floor, 1e-300)
    index = np.empty(min(n, WEIGH_ON), np.int64)
    m = thin(n, WEIGH_ON, index)
    et = np.empty(m)
    ey = np.empty(m)
    er = np.ones(m)
    # Single precision on purpose: the structure must not hinge on the last digits of the data.
    for k in range(m):
        i = index[k]
        et[k] = np.float32(t[i])
        ey[k] = np.float32((y[i] - middle) / unit)
        if weighted:
            er[k] = root_weight[i]
    tied, quantum = quantum_of(ey)
    record[REC_TIED] = tied
    if tied > 0.1 and quantum < 0.5:
        # Rounded values: spread them evenly over their quantum, for the choice of the structure only.
        u = 0.5
        for k in range(m):
            u += _GOLDEN
            u -= math.floor(u)
            ey[k] += quantum * (u - 0.5)
    sub = np.empty(min(m, PROPOSE_FROM), np.int64)
    h = thin(m, PROPOSE_FROM, sub)
    tt = et[sub]
    ty = ey[sub]
    bank = np.zeros((BANK, SIZE))
    scores = np.full(BANK, -1e300)
    sides_of = np.zeros(BANK, np.int64)
    counts = np.zeros(3, np.int64)
    sigma_floor = max(floor / unit, 1e-7)
    fixed = given_sigma / unit
    best = find_structure(et, ey, er, tt, ty, 1.0, sigma_floor, fixed, bank, scores, sides_of, counts)
    record[REC_PAIRS] = counts[0]
    record[REC_CANDIDATES] = counts[1]
    record[REC_EVALUATIONS] = counts[0] * h + counts[2] * m
    if best < 0:
        return
    chosen = bank[best]
    above = np.empty(TABLE + 1)
    below = np.empty(TABLE + 1)
    s = chosen[SIGMA] * unit
    fill_tables(chosen, m, 1.0, weight, above, below)
    line = np.empty(2)
    level = middle + chosen[LEVEL] * unit
    slope = chosen[SLOPE] * unit
    solve_line(t, y, root_weight, weighted, level, slope, s, weight, line)
    threshold = given_threshold if given_threshold > 0.0 else threshold_sigmas * s
    sums = np.empty(3)
    label_points(
        t, y, root_weight, weighted, line[0], line[1], s, threshold, above, below, inlier, probability,
        residual, sums,
    )  # fmt: skip
    record[FOUND] = 1.0
    record[REC_LEVEL] = line[0]
    record[REC_SLOPE] = line[1]
    record[REC_SIGMA] = s
    record[REC_THRESHOLD] = threshold
    record[REC_INLIERS] = sums[2]
    record[REC_SIDES] = sides_of[best]
    record[REC_SHARE] = chosen[INLIERS] / m
    # The best finalist that is another line.
    second = -1
    for q in range(BANK):
        if scores[q] > -1e290 and bank[q, LIKELIHOOD] > -1e290 and not same_line(bank[q], chosen):
            reach = 2.0 * max(bank[q, SIGMA], chosen[SIGMA])
            da = bank[q, LEVEL] - chosen[LEVEL]
            db = bank[q, SLOPE] - chosen[SLOPE]
            apart = abs(da - db) > reach or abs(da + db) > reach
            if apart and (second < 0 or scores[q] > scores[second]):
                second = q
    if second >= 0:
        s2 = bank[second, SIGMA] * unit
        level2 = middle + bank[second, LEVEL] * unit
        slope2 = bank[second, SLOPE] * unit
        only = 0
        for i in range(n):
            root = root_weight[i] if weighted else 1.0
            if not inlier[i] and abs(y[i] - level2 - slope2 * t[i]) * root <= threshold_sigmas * s2:
                only += 1
        record[REC_RUNNER] = 1.0
        record[REC_RUNNER_LEVEL] = level2
        record[REC_RUNNER_SLOPE] = slope2
        record[REC_RUNNER_SIGMA] = s2
        record[REC_RUNNER_MARGIN] = scores[best] - scores[second]
        record[REC_RUNNER_INLIERS] = only


_f8 = types.float64


@kernel(
    types.void(
        ro(types.int64), ro(_f8), ro(_f8), ro(_f8), ro(_f8), _f8, _f8, _f8,
        types.Array(_f8, 2, "C"), types.Array(types.boolean, 1, "C"), types.Array(_f8, 1, "C"),
        types.Array(_f8, 1, "C"), types.Array(_f8, 2, "C"),
    )
)  # fmt: skip
def fit_structures(
    offsets, t, y, root_weight, floors, given_sigma, given_threshold, threshold_sigmas, weights, inlier,
    probability, residual, records,
):  # fmt: skip
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
            weights[k], inlier[i:j], probability[i:j], residual[i:j], records[k],
        )  # fmt: skip
