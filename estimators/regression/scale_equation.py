"""The M-scale of residuals: the s that solves sum rho(r_i / s) = b (n - p), for compiled code.

rho is the bisquare normed to 1 beyond its constant, c = 1.54764 and b = 0.5 (METHODS.md 9), so that half
of the points may be arbitrary. The sum is compared with n - p and not with n, as the published
reference fits do, which keeps the scale from falling short for few points.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray
from estimators.kernels import device

S_TUNING = 1.54764
S_BREAKDOWN = 0.5
_PRECISION = 1e-12
_ROUNDS = 200


@device
def rho_sum(residual: FloatArray, root: FloatArray, scale: float) -> float:
    """Sum of the normed bisquare loss 1 - (1 - (u / c)^2)^3 of u = r sqrt(w) / scale."""
    bound = S_TUNING * scale
    total = 0.0
    for i in range(residual.size):
        v = residual[i] * root[i] / bound
        v *= v
        if v >= 1.0:
            total += 1.0
        else:
            # 3v - 3v^2 + v^3, which loses no digits where v is small.
            total += v * (3.0 + v * (v - 3.0))
    return total


@device
def rho_sum_and_slope(residual: FloatArray, root: FloatArray, scale: float) -> tuple[float, float]:
    """Sum of the loss, and minus its derivative by log scale."""
    bound = S_TUNING * scale
    total = 0.0
    slope = 0.0
    for i in range(residual.size):
        v = residual[i] * root[i] / bound
        v *= v
        if v >= 1.0:
            total += 1.0
        else:
            total += v * (3.0 + v * (v - 3.0))
            slope += 6.0 * v * (1.0 - v) * (1.0 - v)
    return total, slope


@device
def solve_scale(residual: FloatArray, root: FloatArray, target: float, start: float, floor: float) -> float:
    """Solve sum rho = ``target`` by Newton's method within a bracket; ``floor`` if it is not above it.

    At least (n + p) / 2 points on the line leave the equation without a positive solution: the floor is
    then the answer (zero-scale guard).
    """
    if target <= 0.0 or rho_sum(residual, root, floor) <= target:
        return floor
    low = floor
    high = np.inf
    scale = max(start, floor)
    for _ in range(_ROUNDS):
        total, slope = rho_sum_and_slope(residual, root, scale)
        if abs(total - target) <= _PRECISION * target:
            break
        if total > target:
            low = scale
        else:
            high = scale
        # Where the derivative vanishes or the step leaves the bracket, the classical fixed point moves on.
        proposal = scale * np.exp(min(max((total - target) / slope, -1.0), 1.0)) if slope > 0.0 else 0.0
        if not low < proposal < high:
            proposal = scale * np.sqrt(total / target)
        if not low < proposal < high:
            proposal = np.sqrt(low * high) if np.isfinite(high) else 2.0 * low
        if not low < proposal < high:
            break
        scale = proposal
    return scale
