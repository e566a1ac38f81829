"""Noise scale of a consensus that a threshold has cut (METHODS.md 12, truncation bias).

The inliers within ±T of a normal law scatter less than the law: with c = T / sigma their variance is
sigma^2 B / (2 Phi(c) - 1), B = 2 Phi(c) - 1 - 2 c phi(c). Where only the threshold is known, sigma follows
from the inliers' own scatter by solving this for c.
"""

from __future__ import annotations

import math

from numba import types

from estimators.kernels import device, kernel

_NARROWEST, _WIDEST = 1.0, 40.0
"""Range of c: below 1 the scatter of the inliers says next to nothing about sigma (the ratio tends to that
of a uniform law), above 40 nothing is cut."""

_HALVINGS = 52
_NEWTON_STEPS = 10
_SETTLED = 1e-11
_MARGIN = 1e-9


def truncated_variance(c: float) -> float:
    """Variance of a standard normal cut at ±c.

    Examples
    --------
    >>> round(truncated_variance(1.96) * 0.95, 4)
    0.7209
    """
    inside = math.erf(c / math.sqrt(2.0))
    density = math.exp(-0.5 * c * c) / math.sqrt(2.0 * math.pi)
    return 1.0 - 2.0 * c * density / inside


_truncated_variance = device(truncated_variance)


@device
def _guess(ratio: float) -> tuple[float, float]:
    """Newton's root of the same equation, and how far from it halving has to look for itself.

    Beyond the margin the monotone function leaves no doubt, which spares two evaluations of three; the margin
    is infinite where Newton's iteration has not settled.
    """
    c = min(max(1.0 / math.sqrt(ratio), _NARROWEST), _WIDEST)
    for _ in range(_NEWTON_STEPS):
        share = 1.0 - _truncated_variance(c)
        inside = math.erf(c / math.sqrt(2.0))
        density = math.exp(-0.5 * c * c) / math.sqrt(2.0 * math.pi)
        value = (1.0 - share) / (c * c) - ratio
        slope = -share * (1.0 / c - c - 2.0 * density / inside) / (c * c) - 2.0 * (1.0 - share) / (c * c * c)
        step = value / slope
        c = min(max(c - step, _NARROWEST), _WIDEST)
        if abs(step) < _SETTLED * c:
            return c, _MARGIN * c
    return c, math.inf


@device
def untruncated_sigma(scatter: float, T: float) -> float:
    """Solve for the scale of the law before the cut; at most T.

    Parameters
    ----------
    scatter : float
        Standard deviation of the inliers' residuals.
    T : float
        Threshold.
    """
    if not scatter > 0.0:
        return 0.0
    ratio = (scatter / T) * (scatter / T)
    low, high = _NARROWEST, _WIDEST
    if _truncated_variance(low) / (low * low) <= ratio:
        return T
    if _truncated_variance(high) / (high * high) >= ratio:
        return scatter
    guess, margin = _guess(ratio)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if abs(middle - guess) > margin:
            above = middle < guess
        else:
            above = _truncated_variance(middle) / (middle * middle) > ratio
        if above:
            low = middle
        else:
            high = middle
    return T / low


@kernel(types.float64(types.float64, types.float64))
def sigma_of_consensus(scatter: float, T: float) -> float:
    """Entry to :func:`untruncated_sigma`.

    Examples
    --------
    >>> round(sigma_of_consensus(truncated_variance(2.0) ** 0.5, 2.0), 9)
    1.0
    """
    return untruncated_sigma(scatter, T)
