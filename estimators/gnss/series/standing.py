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
from estimators.gnss.series.weights import healthy_probability, log_density
from estimators.gnss.snapshot.linearise import EARTH_RATE, SPEED_OF_LIGHT, factorise, solve_factorised
from estimators.gnss.snapshot.parity import fill_inverse
from estimators.gnss.snapshot.solved import SCALE_RATE, SCALE_SHAPE
from estimators.kernels import device, kernel, ro

_SETTLED_M = 1e-3
_CLOCK_STEPS = 3
_STRANGE_CLOCK = 1e-6
"""Density of a clock far from where its neighbours lead, relative to there: a receiver may reset it."""


@device
def geometry(satellite: FloatArray, rotated: bool, x: FloatArray, unit: FloatArray) -> float:
    """Write the derivative of a range by the position; returns the range."""
    sx, sy, sz = satellite[0], satellite[1], satellite[2]
    if not rotated:
        travelled = math.sqrt((sx - x[0]) ** 2 + (sy - x[1]) ** 2 + (sz - x[2]) ** 2)
        angle = EARTH_RATE * travelled / SPEED_OF_LIGHT
        sine, cosine = math.sin(angle), math.cos(angle)
        sx, sy = cosine * sx + sine * sy, cosine * sy - sine * sx
    dx, dy, dz = sx - x[0], sy - x[1], sz - x[2]
    rho = math.sqrt(dx * dx + dy * dy + dz * dz)
    unit[0] = -dx / rho
    unit[1] = -dy / rho
    unit[2] = -dz / rho
    return rho


@device
def find_clock(
    left: FloatArray,
    sigma: FloatArray,
    clock: IntArray,
    first: int,
    last: int,
    which: int,
    scale: float,
    fault_prior: float,
    expected: float,
    spread: float,
) -> float:
    """Clock of one system in one epoch at which its ranges are likeliest.

    Every range proposes the clock at which it is exact; the best proposal is refined by weighted means. Where
    the epochs around lead one to expect a clock, proposals near it are likelier: that settles epochs in which
    as many satellites lie as tell the truth.
    """
    best, value = 0.0, -math.inf
    for i in range(first, last):
        if clock[i] == which:
            total = 0.0
            if not math.isnan(expected):
                off = (left[i] - expected) / spread
                total = math.log(math.exp(-0.5 * off * off) + _STRANGE_CLOCK)
            for j in range(first, last):
                if clock[j] == which:
                    total += log_density(left[j] - left[i], sigma[j], scale, fault_prior)
            if total > value:
                value = total
                best = left[i]
    for _ in range(_CLOCK_STEPS):
        top, bottom = 0.0, 0.0
        for j in range(first, last):
            if clock[j] == which:
                w = healthy_probability(left[j] - best, sigma[j], scale, fault_prior) / sigma[j] ** 2
                top += w * left[j]
                bottom += w
        if bottom > 0.0:
            best = top / bottom
    return best


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
                bias = find_clock(
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
                )
                clock_m[e, which] = bias
                weight_sum, left_mean = 0.0, 0.0
                mean[:] = 0.0
                for i in range(first, last):
                    if clock[i] == which:
                        residual[i] = left[i] - bias
                        healthy[i] = healthy_probability(residual[i], sigma[i], scale, fault_prior)
                        total += log_density(residual[i], sigma[i], scale, fault_prior)
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
