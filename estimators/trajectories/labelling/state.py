"""The state of a hypothesis: position, velocity and bias in two axes that share one covariance."""

from __future__ import annotations

import math

from estimators.arrays import FloatArray
from estimators.kernels import device

TWIN = 0.2
"""States closer than this, in variances, have the same future."""
TWIN_SPREAD = 0.5
_NEAR = 2.0
"""In variances of their difference, states closer than this are of the same place."""
LEAST_VARIANCE = 1e-6


@device
def predict(
    x: FloatArray, P: FloatArray, dt: float, manoeuvre: float, keep: float, walk: float,
    ahead: FloatArray, spread: FloatArray,
) -> None:  # fmt: skip
    """Move a state on by ``dt`` seconds: white acceleration, the bias times ``keep`` plus a variance.

    Only the upper triangles of covariances are read and written.
    """
    for axis in range(2):
        ahead[axis, 0] = x[axis, 0] + dt * x[axis, 1]
        ahead[axis, 1] = x[axis, 1]
        ahead[axis, 2] = keep * x[axis, 2]
    spread[0, 0] = P[0, 0] + 2.0 * dt * P[0, 1] + dt * dt * P[1, 1] + manoeuvre * dt * dt * dt / 3.0
    spread[0, 1] = P[0, 1] + dt * P[1, 1] + manoeuvre * dt * dt / 2.0
    spread[1, 1] = P[1, 1] + manoeuvre * dt
    spread[0, 2] = keep * (P[0, 2] + dt * P[1, 2])
    spread[1, 2] = keep * P[1, 2]
    spread[2, 2] = keep * keep * P[2, 2] + walk


@device
def update(x: FloatArray, P: FloatArray, east: float, north: float, variance: float) -> None:
    """Take in a fix of position plus bias; upper triangle of P."""
    g0 = P[0, 0] + P[0, 2]
    g1 = P[0, 1] + P[1, 2]
    g2 = P[0, 2] + P[2, 2]
    total = max(g0 + g2, 0.0) + variance
    for axis in range(2):
        off = ((east if axis == 0 else north) - x[axis, 0] - x[axis, 2]) / total
        x[axis, 0] += g0 * off
        x[axis, 1] += g1 * off
        x[axis, 2] += g2 * off
    P[0, 0] -= g0 * g0 / total
    P[0, 1] -= g0 * g1 / total
    P[0, 2] -= g0 * g2 / total
    P[1, 1] -= g1 * g1 / total
    P[1, 2] -= g1 * g2 / total
    P[2, 2] -= g2 * g2 / total
    # Rounding after a long step must not leave a variance below zero.
    for k in range(3):
        P[k, k] = max(P[k, k], 0.0)


@device
def swerve(P: FloatArray, dt: float, variance: float) -> None:
    """Let the velocity have jumped a step ago, by a variance."""
    P[0, 0] += dt * dt * variance
    P[0, 1] += dt * variance
    P[1, 1] += variance


@device
def forget_bias(x: FloatArray, P: FloatArray, variance: float) -> None:
    """Give the state a fresh bias of mean 0."""
    for axis in range(2):
        x[axis, 2] = 0.0
    P[0, 2] = 0.0
    P[1, 2] = 0.0
    P[2, 2] = variance


@device
def take_for_bias(x: FloatArray, P: FloatArray, east: float, north: float, variance: float) -> None:
    """Let the bias be all that a fix is off, whatever it was before."""
    x[0, 2] = east - x[0, 0]
    x[1, 2] = north - x[1, 0]
    P[0, 2] = -P[0, 0]
    P[1, 2] = -P[0, 1]
    P[2, 2] = P[0, 0] + variance


@device
def start_at(
    x: FloatArray, P: FloatArray, east: float, north: float, variance: float, colour: float, velocity: float
) -> None:
    """Begin at a fix, with nothing known but it and the variance of velocities."""
    squared = colour * colour
    x[0, 0] = east
    x[1, 0] = north
    for axis in range(2):
        x[axis, 1] = 0.0
        x[axis, 2] = 0.0
    P[0, 0] = variance + squared
    P[0, 1] = 0.0
    P[1, 1] = velocity
    P[0, 2] = -squared
    P[1, 2] = 0.0
    P[2, 2] = squared


@device
def is_near(x: FloatArray, P: FloatArray, other: FloatArray, other_P: FloatArray) -> bool:
    """Whether two states are of the same place, as far as they know."""
    apart = (x[0, 0] - other[0, 0]) ** 2 + (x[1, 0] - other[1, 0]) ** 2
    return bool(apart < _NEAR * (P[0, 0] + other_P[0, 0]))


@device
def are_twins(x: FloatArray, P: FloatArray, other: FloatArray, other_P: FloatArray) -> bool:
    """Whether two states are so alike that only the likelier of them need be followed."""
    for k in range(3):
        limit = TWIN * min(P[k, k], other_P[k, k]) + LEAST_VARIANCE
        apart = (x[0, k] - other[0, k]) ** 2 + (x[1, k] - other[1, k]) ** 2
        if apart >= limit or abs(P[k, k] - other_P[k, k]) >= TWIN_SPREAD * other_P[k, k]:
            return False
    return True


@device
def is_too_fast(x: FloatArray, P: FloatArray, top_speed: float) -> bool:
    """Whether a state moves faster than the track can, by more than three standard deviations."""
    return math.hypot(x[0, 1], x[1, 1]) > top_speed + 3.0 * math.sqrt(P[1, 1])
