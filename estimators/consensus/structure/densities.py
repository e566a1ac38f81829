"""Densities of the mixture's parts that do not hang on the labels, for all readings at once."""

from __future__ import annotations

from estimators.arrays import FloatArray
from estimators.consensus.structure.decay import decay
from estimators.consensus.structure.mixture import (
    ABOVE,
    ABOVE_MEAN,
    BELOW,
    BELOW_MEAN,
    CORRELATION,
    LEVEL,
    ROOT_2PI,
    SEPARATION,
    SIGMA,
    SLOPE,
)
from estimators.kernels import device


@device
def fill_densities(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    params: FloatArray,
    residual: FloatArray,
    f_follow: FloatArray,
    g_side: FloatArray,
) -> None:
    """Fill the whitened residuals, and the densities of following the line and of one-sided errors.

    Densities of whitened residuals times the root of the weight are densities of the values. Where
    neighbours are correlated, ``f_follow`` is left to the filter.
    """
    n = t.size
    a, b, s = params[LEVEL], params[SLOPE], params[SIGMA]
    for i in range(n):
        residual[i] = (y[i] - a - b * t[i]) * root_weight[i]
    if params[CORRELATION] <= 0.0:
        narrow = 1.0 / (ROOT_2PI * s)
        inverse_s = 1.0 / s
        for i in range(n):
            u = residual[i] * inverse_s
            f_follow[i] = narrow * root_weight[i] * decay(0.5 * u * u)
    above, below = params[ABOVE], params[BELOW]
    if above <= 0.0 and below <= 0.0:
        g_side[:] = 0.0
        return
    theta_up, theta_down = params[ABOVE_MEAN], params[BELOW_MEAN]
    apart = SEPARATION * s
    above_height = above * (apart + theta_up) / (theta_up * theta_up)
    below_height = below * (apart + theta_down) / (theta_down * theta_down)
    above_rate = 1.0 / theta_up
    below_rate = 1.0 / theta_down
    inverse_apart = 1.0 / apart
    for i in range(n):
        # Errors above or below, whichever side the reading is on.
        is_above = 1.0 if residual[i] > 0.0 else 0.0
        distance = abs(residual[i])
        height = below_height + is_above * (above_height - below_height)
        rate = below_rate + is_above * (above_rate - below_rate)
        rise = 1.0 - decay(distance * inverse_apart)
        g_side[i] = height * root_weight[i] * decay(distance * rate) * rise
