"""A standing receiver: one position for all epochs, clocks of their own in each, faults anywhere.

The density of an epoch given the position is a mixture over its clocks and its faults, so that what one epoch
leaves ambiguous the others settle (METHODS_GNSS: "epochs solved jointly break the snapshot limit"). Several
starts, each improved by expectation maximisation with the clocks eliminated; the likeliest is the answer.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.series.epoch_clocks import fit_clock, geometry
from estimators.gnss.snapshot.linearise import factorise, solve_factorised
from estimators.gnss.snapshot.parity import fill_inverse
from estimators.gnss.snapshot.solved import SCALE_RATE, SCALE_SHAPE
from estimators.kernels import kernel, ro

_SETTLED_M = 1e-3


@kernel(
    types.UniTuple(types.float64, 2)(  # type: ignore[no-untyped-call]
        ro(types.float64, 2),
        ro(types.float64),
        ro(types.float64),
        ro(types.int64),
        ro(types.int64),
        ro(types.int64),
        types.boolean,
        types.float64,
        types.float64,
        types.int64,
        ro(types.float64, 2),
        types.float64,
        types.float64[::1],
        types.float64[:, ::1],
        types.float64[:, ::1],
        types.float64[::1],
        types.float64[::1],
    )
)
def climb(
    satellites: FloatArray,
    ranges: FloatArray,
    sigma: FloatArray,
    clock: IntArray,
    offsets: IntArray,
    clocks: IntArray,
    rotated: bool,
    fault_prior: float,
    scale: float,
    steps: int,
    expected_m: FloatArray,
    clock_spread_m: float,
    x: FloatArray,
    N: FloatArray,
    clock_m: FloatArray,
    residual: FloatArray,
    healthy: FloatArray,
) -> tuple[float, float]:
    """Improve a position by expectation maximisation.

    Parameters
    ----------
    satellites, ranges, sigma, clock, offsets, clocks : ndarray
        As in :func:`estimators.gnss.snapshot.epochs.answer_epochs`.
    rotated : bool
    fault_prior : float
    scale : float
        Where the estimation of the noise scale starts.
    steps : int
        At most; 0 only scores.
    expected_m : ndarray, shape (epochs, MOST_CLOCKS)
        Where the clocks of other epochs lead; NaN where they lead nowhere.
    clock_spread_m : float
        How far clocks lie from there.
    x : ndarray, shape (3,)
        In and out: the position.
    N : ndarray, shape (3, 3)
        Out: its covariance at unit scale, clocks eliminated.
    clock_m : ndarray, shape (epochs, MOST_CLOCKS)
        Out.
    residual, healthy : ndarray, one entry per row
        Out: metres, and the probability that the range is healthy.

    Returns
    -------
    tuple of float
        Log likelihood (-inf where the position is not determined) and noise scale.
    """
    epochs = offsets.size - 1
    left = np.empty(ranges.size)
    unit = np.empty((ranges.size, 3))
    normal, right, mean = np.empty((3, 3)), np.empty(3), np.empty(3)
    total = 0.0
    for step in range(steps + 1):
        normal[:] = 0.0
        right[:] = 0.0
        total = 0.0
        # Position and clocks are fitted to the ranges: so many residuals fewer speak for the noise.
        squares, count = 0.0, -3.0
        for e in range(epochs):
            first, last = offsets[e], offsets[e + 1]
            for i in range(first, last):
                left[i] = ranges[i] - geometry(satellites[i], rotated, x, unit[i])
            for which in range(clocks[e]):
                bias, density = fit_clock(
                    left,
                    sigma,
                    clock,
                    first,
                    last,
                    which,
                    scale,
                    fault_prior,
                    expected_m[e, which],
                    clock_spread_m,
                    residual,
                    healthy,
                )
                clock_m[e, which] = bias
                total += density
                weight_sum, left_mean = 0.0, 0.0
                mean[:] = 0.0
                for i in range(first, last):
                    if clock[i] == which:
                        w = healthy[i] / (sigma[i] * sigma[i])
                        squares += w * residual[i] * residual[i]
                        count += healthy[i]
                        weight_sum += w
                        left_mean += w * residual[i]
                        for k in range(3):
                            mean[k] += w * unit[i, k]
                if weight_sum > 0.0:
                    # The clock is eliminated: what is common to the system's ranges says nothing.
                    left_mean /= weight_sum
                    count -= 1.0
                    for k in range(3):
                        mean[k] /= weight_sum
                    for i in range(first, last):
                        if clock[i] == which:
                            w = healthy[i] / (sigma[i] * sigma[i])
                            for k in range(3):
                                a = unit[i, k] - mean[k]
                                right[k] += w * a * (residual[i] - left_mean)
                                for j in range(k + 1):
                                    normal[k, j] += w * a * (unit[i, j] - mean[j])
        if not factorise(normal):
            return -math.inf, scale
        fill_inverse(normal, N)
        if step == steps:
            break
        solve_factorised(normal, right)
        moved = 0.0
        for k in range(3):
            x[k] += right[k]
            moved = max(moved, abs(right[k]))
        scale = math.sqrt((SCALE_RATE + 0.5 * squares) / (SCALE_SHAPE + 0.5 * max(count, 0.0) - 1.0))
        if moved < _SETTLED_M and step > 1:
            # One more pass scores the position that is answered.
            steps = step + 1
    return total, scale
