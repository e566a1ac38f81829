"""The ranges of one epoch at a place: geometry, the likeliest receiver clocks, and what is left over."""

from __future__ import annotations

import math

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.series.weights import healthy_probability, log_density
from estimators.gnss.snapshot.linearise import EARTH_RATE, SPEED_OF_LIGHT
from estimators.kernels import device

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
def _find_clock(
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


@device
def fit_clock(
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
    residual: FloatArray,
    healthy: FloatArray,
) -> tuple[float, float]:
    """Clock of one system in one epoch, with the residuals of its ranges.

    Parameters
    ----------
    left, sigma, clock : ndarray
        Ranges without geometry, their noise, and whose clock they share.
    first, last, which : int
        The rows of the epoch, and the clock.
    scale, fault_prior : float
    expected, spread : float
        Where other epochs lead one to expect the clock, NaN where nowhere, and how far off it is.
    residual, healthy : ndarray
        Out, at the rows of the system.

    Returns
    -------
    bias : float
        Metres.
    density : float
        Log density of the ranges.
    """
    bias = _find_clock(left, sigma, clock, first, last, which, scale, fault_prior, expected, spread)
    density = 0.0
    for i in range(first, last):
        if clock[i] == which:
            residual[i] = left[i] - bias
            healthy[i] = healthy_probability(residual[i], sigma[i], scale, fault_prior)
            density += log_density(residual[i], sigma[i], scale, fault_prior)
    return bias, density
