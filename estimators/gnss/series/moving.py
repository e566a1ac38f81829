"""A moving receiver: position, velocity, clock and drift along a chain of epochs, ranges weighed robustly.

Constant velocity in the local frame with white acceleration, a clock whose drift wanders, and one constant
per further system (METHODS_GNSS, "Cities"). Range rates, where given, measure velocity and drift. Solved by
Gauss-Newton on the chain of :mod:`estimators.statespace.chain`, the weights of the ranges computed again in
every step.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.series.motion import (
    FIXED_STATES,
    fill_prior,
    fill_range_row,
    fill_transitions,
    transition_cost,
)
from estimators.gnss.series.weights import CITY, cauchy, healthy_probability, log_density, one_sided
from estimators.gnss.snapshot.solved import SCALE_RATE, SCALE_SHAPE
from estimators.kernels import device, kernel, ro
from estimators.statespace.chain import solve_chain

RATE_SIGMA_MPS = 0.3
"""Noise of a range rate from Doppler, that of a low-cost receiver; gross errors lose their weight."""
_SETTLED_M = 0.01
_LEAST_FREEDOM = 1.0


@device
def _add(H: FloatArray, g: FloatArray, row: FloatArray, value: float, w: float) -> float:
    """Add a measurement to the information of its epoch."""
    d = row.size
    for j in range(d):
        if row[j] != 0.0:
            g[j] += w * row[j] * value
            for m in range(d):
                H[j, m] += w * row[j] * row[m]
    return w


@device
def _leverage(P: FloatArray, row: FloatArray) -> float:
    held = 0.0
    for j in range(row.size):
        if row[j] != 0.0:
            for m in range(row.size):
                held += row[j] * P[j, m] * row[m]
    return held


@kernel(
    types.UniTuple(types.float64, 5)(  # type: ignore[no-untyped-call]
        ro(types.float64, 2),
        ro(types.float64),
        ro(types.float64),
        ro(types.int64),
        ro(types.float64, 2),
        ro(types.float64),
        ro(types.int64),
        ro(types.float64),
        types.boolean,
        ro(types.float64),
        ro(types.float64, 2),
        ro(types.float64),
        types.int64,
        types.float64,
        types.float64,
        types.int64,
        types.float64[:, ::1],
        types.float64[:, :, ::1],
        types.float64[::1],
        types.float64[::1],
    )
)
def smooth_window(
    satellites: FloatArray,
    ranges: FloatArray,
    sigma: FloatArray,
    system: IntArray,
    velocities: FloatArray,
    rates: FloatArray,
    offsets: IntArray,
    times: FloatArray,
    rotated: bool,
    reference: FloatArray,
    axes: FloatArray,
    noise: FloatArray,
    surroundings: int,
    fault_prior: float,
    scale: float,
    steps: int,
    x: FloatArray,
    P: FloatArray,
    residual: FloatArray,
    weight: FloatArray,
) -> tuple[float, float, float, float, float]:
    """Smooth a window of epochs.

    Parameters
    ----------
    satellites, ranges, sigma, system, offsets : ndarray
        Rows of the epochs; ``system`` counts the systems of the whole window from 0.
    velocities, rates : ndarray, shape (rows, 3) and (rows,)
        Of the satellites, and how fast the ranges grow, in metres per second; NaN where unknown.
    times : ndarray, shape (epochs,)
        Seconds.
    rotated : bool
    reference, axes : ndarray
        Origin of the local frame and its unit vectors.
    noise : ndarray, shape (4,)
        Densities of acceleration (horizontal, vertical), clock, drift.
    surroundings : int
        ``OPEN`` or ``CITY``.
    fault_prior, scale : float
        Of an open sky; the scale is where estimation starts.
    steps : int
        Most Gauss-Newton steps.
    x : ndarray, shape (epochs, states)
        In: where to start; out: the states.
    P : ndarray, shape (epochs, states, states)
        Out: covariances at unit scale.
    residual, weight : ndarray, one entry per row
        Out.

    Returns
    -------
    tuple of float
        Steps taken (-1 where the ranges do not determine the states); scale of the weighted residuals; log
        density of ranges and motion; degrees of freedom of the ranges used; parameters that they determined.
    """
    T, d = x.shape
    H, g = np.zeros((T, d, d)), np.zeros((T, d))
    F, W = np.zeros((max(T - 1, 1), d, d)), np.zeros((max(T - 1, 1), d, d))
    fill_transitions(times, noise, F, W)
    row, place, before = np.empty(d), np.empty(3), np.empty((T, 3))
    density, freedom, effective, taken, spread = 0.0, 0.0, 0.0, 0, scale
    for step in range(steps + 1):
        H[:] = 0.0
        g[:] = 0.0
        fill_prior(H[0])
        squares, count, effective, density = 0.0, 0.0, 0.0, 0.0
        for k in range(T):
            for i in range(3):
                place[i] = reference[i] + axes[0, i] * x[k, 0] + axes[1, i] * x[k, 1] + axes[2, i] * x[k, 2]
            for r in range(offsets[k], offsets[k + 1]):
                rho, rate = fill_range_row(satellites[r], velocities[r], rotated, place, axes, system[r], row)
                left = ranges[r] - rho - x[k, 6]
                if system[r] > 0:
                    left -= x[k, FIXED_STATES + system[r] - 1]
                residual[r] = left
                if surroundings == CITY:
                    weight[r] = one_sided(left / sigma[r])
                else:
                    weight[r] = healthy_probability(left, sigma[r], scale, fault_prior)
                    density += log_density(left, sigma[r], scale, fault_prior)
                squares += weight[r] * (left / sigma[r]) ** 2
                count += weight[r]
                value = left
                for j in range(d):
                    value += row[j] * x[k, j]
                w = _add(H[k], g[k], row, value, weight[r] / (sigma[r] * sigma[r]))
                if step > 0:
                    effective += w * _leverage(P[k], row)
                if not math.isnan(rates[r]) and not math.isnan(rate):
                    # The same direction measures the velocity; the drift is common to all systems.
                    for i in range(3):
                        row[3 + i] = row[i]
                        row[i] = 0.0
                    row[7] = row[6]
                    row[6] = 0.0
                    if system[r] > 0:
                        row[FIXED_STATES + system[r] - 1] = 0.0
                    value = rates[r] - rate
                    off = value - x[k, 7]
                    for i in range(3):
                        off -= row[3 + i] * x[k, 3 + i]
                    # Information is in units of the range noise: the scale takes itself out again.
                    w = cauchy(off / RATE_SIGMA_MPS) * (scale / RATE_SIGMA_MPS) ** 2
                    _add(H[k], g[k], row, value, w)
        freedom = max(count - effective, _LEAST_FREEDOM)
        spread = math.sqrt((SCALE_RATE + 0.5 * squares) / (SCALE_SHAPE + 0.5 * freedom - 1.0))
        if surroundings != CITY and step > 0:
            scale = spread
        if taken < step or step == steps:
            break
        for k in range(T):
            for i in range(3):
                before[k, i] = x[k, i]
        # W is whitened by the scale of the ranges, so that both kinds of noise keep their proportion.
        if not solve_chain(H, g, F, W * (scale * scale), x, P):
            return -1.0, spread, -math.inf, freedom, effective
        moved = 0.0
        for k in range(T):
            for i in range(3):
                moved = max(moved, abs(x[k, i] - before[k, i]))
        if not math.isfinite(moved):
            return -1.0, spread, -math.inf, freedom, effective
        # A step that hardly moved is the last one; one more pass takes residuals and weights there.
        if moved >= _SETTLED_M:
            taken += 1
    return float(taken), spread, density - transition_cost(F, W, x), freedom, effective
