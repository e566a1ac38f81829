r"""How far off an answer may be: the tail of the position over all fault sets, and its inverse.

The probability that the truth lies farther than r from a position x is bounded by

    tail(r) = sum_G w_G (1 + u^2 / (nu s_G^2))^(-nu/2),  u = max(0, r - |x_G - x|),

the radial tail of a two-dimensional Student density of nu degrees of freedom whose scale s_G is the larger
semi-axis. A protection level solves tail(r) = risk (METHODS_GNSS, "A decision that is honest and still
answers").
"""

from __future__ import annotations

import math

from estimators.arrays import FloatArray
from estimators.gnss.snapshot.fault_weight import whole_power
from estimators.kernels import device

_PRECISION = 1e-6
"""Of a protection level, relative."""
_MOST_STEPS = 80


@device
def tail(radius: float, distance: FloatArray, variance: FloatArray, nu: int, weights: FloatArray) -> float:
    """Probability bound that the truth lies farther than ``radius`` from a position."""
    total = 0.0
    for g in range(weights.size):
        beyond = radius - distance[g]
        if beyond > 0.0:
            held = variance[g] * nu
            total += weights[g] * whole_power(math.sqrt(held / (held + beyond * beyond)), nu)
        else:
            total += weights[g]
    return total


@device
def solve_tail(
    risk: float, distance: FloatArray, variance: FloatArray, nu: int, weights: FloatArray
) -> float:
    """Radius whose tail is the risk; infinite where there is no risk left to take.

    False position on the logarithm of the tail (Illinois variant), between powers of two.
    """
    if not risk > 0.0:
        return math.inf
    low, high = 0.0, 1.0
    below, above = -math.log(risk), 0.0
    for _ in range(_MOST_STEPS):
        above = math.log(tail(high, distance, variance, nu, weights) / risk)
        if above <= 0.0:
            break
        low, below = high, above
        high *= 2.0
    side = 0
    for _ in range(_MOST_STEPS):
        if above == 0.0 or high - low <= _PRECISION * high:
            break
        middle = low + (high - low) * below / (below - above)
        value = math.log(tail(middle, distance, variance, nu, weights) / risk)
        if value > 0.0:
            low, below = middle, value
            above = 0.5 * above if side == 1 else above
            side = 1
        else:
            if middle > high - _PRECISION * high:
                high = middle
                break
            high, above = middle, value
            below = 0.5 * below if side == -1 else below
            side = -1
    return high
