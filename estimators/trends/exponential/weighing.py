"""An exponential weighed in the values' own units: the structure mixture on its residuals, and Newton steps.

The mixture with sticky labels (:mod:`estimators.consensus.structure.mixture`) takes the residuals of the
curve as readings about a level line, so that its background is that of the values. The curve itself moves by
Gauss-Newton: near a rate b the model is A exp(b t) (1 + d t), and y exp(-b t) follows the *line* A + A d t
with precisions exp(2 b t). Everything that is known of weighted lines serves exponentials.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.structure.acquittal import ALONE_STEPS, acquit, forbid_contamination, start_alone
from estimators.consensus.structure.criterion import IMPOSSIBLE, criterion
from estimators.consensus.structure.em import em_step
from estimators.consensus.structure.finish import TABLE, fill_tables, newton_step, newton_sums
from estimators.consensus.structure.mixture import (
    LEVEL,
    LIKELIHOOD,
    SIGMA,
    SIZE,
    SLOPE,
)
from estimators.kernels import device
from estimators.trends.exponential.proposals import STEEPEST, bounded_exp, fill_residuals

AMPLITUDE = SIZE
"""Slot of the level at frame time 0, after those of the mixture."""
RATE = SIZE + 1
SLOTS = SIZE + 2

_LARGEST_TURN = 1.0
"""Change of the rate in one step, in the frame or in units of the rate: where linearisation holds."""


@device
def linearise(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    rate: float,
    tau: FloatArray,
    z: FloatArray,
    root: FloatArray,
) -> float:
    """Fill the weighted line that stands for the curve near ``rate``; returns the time that is its zero.

    The zero is the end at which the curve is largest, so that no factor exceeds 1.
    """
    anchor = 1.0 if rate > 0.0 else -1.0
    for i in range(t.size):
        tau[i] = t[i] - anchor
        factor = np.exp(rate * tau[i])
        z[i] = y[i] / factor
        root[i] = root_weight[i] * factor
    return anchor


@device
def newton_curve(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    s: float,
    weight: FloatArray,
    params: FloatArray,
    tau: FloatArray,
    z: FloatArray,
    root: FloatArray,
) -> float:
    """Take one step of Gauss-Newton on AMPLITUDE and RATE; returns its size in noise scales."""
    rate = params[RATE]
    anchor = linearise(t, y, root_weight, rate, tau, z, root)
    level = params[AMPLITUDE] * bounded_exp(rate * anchor)
    sums = np.empty(8)
    step = np.empty(2)
    newton_sums(tau, z, root, True, level, 0.0, s, weight, 1, sums)
    if level == 0.0 or not newton_step(sums, s, step):
        return 0.0
    moved = level + step[0]
    if moved * level <= 0.0 or abs(moved) < 0.2 * abs(level):
        moved = 0.2 * level
    most = _LARGEST_TURN * max(1.0, 0.3 * abs(rate))
    turn = min(max(step[1] / moved, -most), most)
    rate = min(max(rate + turn, -STEEPEST), STEEPEST)
    params[RATE] = rate
    params[AMPLITUDE] = moved * bounded_exp(-rate * anchor)
    return float(abs(step[0]) / s + abs(step[1]) / (s * max(1.0, abs(rate))))


@device
def refine_curve(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    sides: int,
    sigma_floor: float,
    fixed: float,
    correlate: bool,
    steps: int,
    params: FloatArray,
) -> float:
    """Take steps of EM and of Gauss-Newton in turn; returns the criterion."""
    n = t.size
    residual = np.empty(n)
    tau = np.empty(n)
    z = np.empty(n)
    root = np.empty(n)
    weight = np.empty(TABLE + 1)
    follow = np.empty(2 * TABLE + 1)
    for k in range(steps):
        fill_residuals(t, y, params[AMPLITUDE], params[RATE], residual)
        params[LEVEL] = 0.0
        params[SLOPE] = 0.0
        em_step(t, residual, root_weight, sides, sigma_floor, fixed, correlate, params)
        if params[LIKELIHOOD] <= IMPOSSIBLE:
            return IMPOSSIBLE
        if k < steps - 1:
            fill_tables(params, n, weight, follow)
            newton_curve(t, y, root_weight, params[SIGMA], weight, params, tau, z, root)
    params[LEVEL] = 0.0
    params[SLOPE] = 0.0
    return criterion(params, n, sides)


@device
def acquit_curve(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    sigma_floor: float,
    fixed: float,
    params: FloatArray,
) -> None:
    """Replace the best structure by least squares if contamination explains the series hardly better."""
    n = t.size
    residual = np.empty(n)
    tau = np.empty(n)
    z = np.empty(n)
    root = np.empty(n)
    alone = params.copy()
    everywhere = np.ones(TABLE + 1)
    for _ in range(8):
        newton_curve(t, y, root_weight, alone[SIGMA], everywhere, alone, tau, z, root)
    fill_residuals(t, y, alone[AMPLITUDE], alone[RATE], residual)
    square = 0.0
    for i in range(n):
        square += (residual[i] * root_weight[i]) ** 2
    start_alone(alone, fixed if fixed > 0.0 else max(sigma_floor, np.sqrt(square / n)))
    for _ in range(ALONE_STEPS):
        alone[LEVEL] = 0.0
        alone[SLOPE] = 0.0
        forbid_contamination(alone)
        em_step(t, residual, root_weight, 0, sigma_floor, fixed, True, alone)
    acquit(params, alone, 2, n)
