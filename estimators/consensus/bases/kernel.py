"""The compiled entry points of ``auto`` for any number of columns: weigh, then finish on all points."""

from __future__ import annotations

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.bases.shortlist import PER_OCTAVE, pick_starts, scale_gains
from estimators.consensus.bases.weighing import acquit_model, fill_residual, weigh_candidates
from estimators.consensus.structure.finish import TABLE, fill_tables
from estimators.consensus.structure.hypotheses import OCTAVES
from estimators.kernels import kernel, ro
from estimators.regression.loss import CELLS_PER_SIGMA
from estimators.regression.weighted_step import largest_value, weighted_step

_ROUNDS = 200
_TOLERANCE = 1e-10
_EPS = 2.220446049250313e-16

_f8 = types.float64


@kernel(
    types.int64(
        ro(_f8, 2), ro(_f8), ro(_f8), ro(_f8, 2), ro(_f8, 2), ro(_f8), _f8, _f8,
        _f8[:, ::1], _f8[:, ::1], _f8[::1], types.int64[::1],
    )
)  # fmt: skip
def find_basis(
    columns: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    hypotheses: FloatArray,
    robust: FloatArray,
    robust_scales: FloatArray,
    sigma_floor: float,
    fixed: float,
    thetas: FloatArray,
    bank: FloatArray,
    scores: FloatArray,
    counts: IntArray,
) -> int:
    """Weigh hypotheses of minimal samples and robust fits; the values have a unit range.

    Fills the rows of ``thetas``, ``bank`` and ``scores`` with the finalists, and ``counts[0]`` with the
    number of candidates weighed. Returns the number of finalists, 0 if no structure stands out; the best is
    in the row that ``counts[1]`` names.
    """
    p = columns.shape[0]
    gain = np.empty((OCTAVES, hypotheses.shape[0]))
    scale_gains(columns, y, hypotheses, gain)
    picks = np.empty(OCTAVES * PER_OCTAVE, np.int64)
    octave = np.empty(picks.size, np.int64)
    made = pick_starts(columns, y, hypotheses, gain, picks, octave)
    starts = np.empty((made + robust.shape[0], p))
    scales = np.empty(starts.shape[0])
    for k in range(made):
        starts[k] = hypotheses[picks[k]]
        scales[k] = 0.5 * 2.0 ** -octave[k]
    starts[made:] = robust
    scales[made:] = robust_scales
    found: int = weigh_candidates(
        columns, y, root_weight, starts, scales, sigma_floor, fixed, thetas, bank, scores
    )
    counts[0] = starts.shape[0]
    counts[1] = 0
    for k in range(1, found):
        if scores[k] > scores[counts[1]]:
            counts[1] = k
    if found > 0:
        acquit_model(columns, y, root_weight, sigma_floor, fixed, thetas[counts[1]], bank[counts[1]])
    return found


@kernel(
    types.float64(
        ro(_f8, 2), ro(_f8), ro(_f8), _f8[::1], types.int64, _f8, _f8, _f8,
        _f8[::1], _f8[::1], types.boolean[::1], _f8[::1],
    )
)  # fmt: skip
def finish_basis(
    columns: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    params: FloatArray,
    weighed_on: int,
    scale: float,
    given_threshold: float,
    threshold_sigmas: float,
    theta: FloatArray,
    weight: FloatArray,
    inlier: BoolArray,
    residual: FloatArray,
) -> float:
    """Estimate on all points from the chosen structure, label them; returns the threshold.

    ``params`` are in units of the range; ``scale`` is the noise scale in those of the values. The weights are
    symmetric (:mod:`estimators.consensus.structure.finish`), the estimate is iterated to its fixed point.
    """
    p, n = columns.shape
    follow = np.empty(2 * TABLE + 1)
    fill_tables(params, weighed_on, weight, follow)
    pull = np.empty(n)
    step = np.empty(p)
    fill_residual(columns, y, theta, residual)
    for _ in range(_ROUNDS):
        for i in range(n):
            x = min(abs(residual[i]) * root_weight[i] / scale * CELLS_PER_SIGMA, TABLE - 1e-6)
            k = int(x)
            w = weight[k] + (x - k) * (weight[k + 1] - weight[k])
            pull[i] = w * root_weight[i] * root_weight[i]
        weighted_step(columns, residual, pull, step)
        for j in range(p):
            theta[j] += step[j]
        fill_residual(columns, y, theta, residual)
        if largest_value(columns, step) <= max(_TOLERANCE * scale, _EPS * largest_value(columns, theta)):
            break
    threshold = given_threshold if given_threshold > 0.0 else threshold_sigmas * scale
    for i in range(n):
        inlier[i] = abs(residual[i]) * root_weight[i] <= threshold
    return threshold


@kernel(_f8(ro(_f8, 2), ro(_f8), ro(_f8), ro(_f8), _f8, ro(_f8)))
def mean_square_about(
    columns: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    theta: FloatArray,
    scale: float,
    weight: FloatArray,
) -> float:
    """Weighted mean of squared whitened residuals, proportional to the variance of inliers."""
    residual = np.empty(y.size)
    fill_residual(columns, y, theta, residual)
    total = square = 0.0
    for i in range(y.size):
        r = residual[i] * root_weight[i]
        w = weight[int(min(abs(r) / scale * CELLS_PER_SIGMA, TABLE - 1e-6))]
        total += w
        square += w * r * r
    return square / total if total > 0.0 else 0.0
