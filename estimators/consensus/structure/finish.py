"""From the chosen structure to the estimate on all points.

The posterior of following the line, as a function of the residual alone, is made odd-symmetric: the
weight of a residual is the smaller of the posteriors at r and at -r. One-sided contamination then pulls
neither way, because its mirror image has lost the same weight (METHODS_TRENDS: "Finish", and the
negative result on asymmetric weights). The estimate solves sum psi(r_i / s) x_i = 0 by Newton's method,
psi(u) = u W(|u|), with W tabulated so that a point costs no transcendentals.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.structure.mixture import (
    ABOVE,
    ABOVE_MEAN,
    BELOW,
    BELOW_MEAN,
    HELD_COUNT,
    INLIERS,
    SEPARATION,
    SIGMA,
    UNIFORM,
)
from estimators.kernels import device
from estimators.regression.loss import CELLS_PER_SIGMA

REACH = 7
TABLE = CELLS_PER_SIGMA * REACH
"""Cells of the weight tables: residuals from 0 to REACH scales; none beyond follows the line."""

LONG = 65536
"""Points beyond which sums that need be true to a per cent only are taken from a part of the series."""
STRIDED = 16384
"""Points of that part, about."""

_ROOT_2PI = 2.5066282746310002


@device
def fill_tables(params: FloatArray, n: int, weight: FloatArray, follow: FloatArray) -> None:
    """Tabulate the posterior ``follow``, shape (2 TABLE + 1,), and ``weight``, shape (TABLE + 1,).

    ``follow`` runs from -REACH to REACH scales; ``weight`` is the smaller of the posteriors above and below
    the line, at |r| = k / CELLS_PER_SIGMA scales.
    """
    s = params[SIGMA]
    share = min(params[INLIERS] / n, 1.0 - 0.5 / n)
    outliers = 1.0 - share
    # Excursions have a level of their own; seen without the time axis they are spread over the range.
    held = min(1.0, params[HELD_COUNT] / max(n - params[INLIERS], 0.5))
    uniform = held + (1.0 - held) * params[UNIFORM]
    above = (1.0 - held) * params[ABOVE]
    below = (1.0 - held) * params[BELOW]
    apart = SEPARATION * s
    up = params[ABOVE_MEAN]
    down = params[BELOW_MEAN]
    for k in range(TABLE + 1):
        u = k / CELLS_PER_SIGMA
        r = u * s
        f_in = share * math.exp(-0.5 * u * u) / (_ROOT_2PI * s)
        gap = 1.0 - math.exp(-r / apart)
        f_above = uniform
        if above > 0.0:
            f_above += above * (apart + up) / (up * up) * math.exp(-r / up) * gap
        f_below = uniform
        if below > 0.0:
            f_below += below * (apart + down) / (down * down) * math.exp(-r / down) * gap
        # The last cell is 0 throughout: residuals beyond it, of any size, are clamped into it.
        inside = 0.0 if k >= TABLE - 1 else 1.0
        follow[TABLE + k] = inside * f_in / (f_in + outliers * f_above)
        follow[TABLE - k] = inside * f_in / (f_in + outliers * f_below)
        weight[k] = min(follow[TABLE + k], follow[TABLE - k])
    weight[0] = follow[TABLE] = min(weight[0], follow[TABLE])


@device
def newton_sums(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    weighted: bool,
    level: float,
    slope: float,
    s: float,
    weight: FloatArray,
    stride: int,
    sums: FloatArray,
) -> None:
    """Sum gradient (2), Hessian (3) and weighted normal matrix (3) of rho(r / s) over strided points."""
    g0 = 0.0
    g1 = 0.0
    h0 = 0.0
    h1 = 0.0
    h2 = 0.0
    w0 = 0.0
    w1 = 0.0
    w2 = 0.0
    inverse = 1.0 / s
    root = 1.0
    for i in range(0, t.size, stride):
        ti = t[i]
        if weighted:
            root = root_weight[i]
        u = (y[i] - level - slope * ti) * (root * inverse)
        # Clamping instead of branching keeps random outliers cheap; the weight is 0 at the end.
        x = min(abs(u) * CELLS_PER_SIGMA, TABLE - 1e-6)
        k = int(x)
        rise = weight[k + 1] - weight[k]
        w = weight[k] + (x - k) * rise
        psi = u * w * root
        bend = (w + x * rise) * root * root
        w *= root * root
        g0 += psi
        g1 += psi * ti
        h0 += bend
        h1 += bend * ti
        h2 += bend * ti * ti
        w0 += w
        w1 += w * ti
        w2 += w * ti * ti
    sums[0] = g0
    sums[1] = g1
    sums[2] = h0
    sums[3] = h1
    sums[4] = h2
    sums[5] = w0
    sums[6] = w1
    sums[7] = w2


@device
def newton_step(sums: FloatArray, s: float, step: FloatArray) -> bool:
    """Solve for the change of (level, slope); returns whether the normal matrix was regular.

    Where the Hessian is not well positive the weighted normal matrix takes its place: a step of
    reweighted least squares, which always descends.
    """
    h0 = sums[2]
    h1 = sums[3]
    h2 = sums[4]
    det = h0 * h2 - h1 * h1
    plain = sums[5] * sums[7] - sums[6] * sums[6]
    if plain <= 1e-14 * sums[5] * sums[7]:
        return False
    if h0 < 0.2 * sums[5] or h2 < 0.2 * sums[7] or det < 0.05 * plain:
        h0 = sums[5]
        h1 = sums[6]
        h2 = sums[7]
        det = plain
    step[0] = s * (h2 * sums[0] - h1 * sums[1]) / det
    step[1] = s * (h0 * sums[1] - h1 * sums[0]) / det
    return True


@device
def solve_line(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    weighted: bool,
    level: float,
    slope: float,
    s: float,
    weight: FloatArray,
    line: FloatArray,
    sums: FloatArray,
) -> None:
    """Newton's method; fills ``line`` with (level, slope) and ``sums`` with the curvature of all points.

    A long series is solved on a stride first, which comes within a hundredth of a scale. One step on all
    points with the stride's curvature, true to a hundredth itself, then leaves an error of 1e-4 scales.
    """
    n = t.size
    step = np.empty(2)
    stride = n // STRIDED if n > LONG else 1
    tolerance = 1e-13 * s if stride == 1 else 1e-5 * s
    for _ in range(30):
        newton_sums(t, y, root_weight, weighted, level, slope, s, weight, stride, sums)
        if not newton_step(sums, s, step):
            break
        level += step[0]
        slope += step[1]
        if abs(step[0]) + abs(step[1]) < tolerance:
            break
    if stride > 1:
        share = ((n + stride - 1) // stride) / n
        for k in range(2, 8):
            sums[k] /= share
        _gradient(t, y, root_weight, weighted, level, slope, s, weight, sums)
        if newton_step(sums, s, step):
            level += step[0]
            slope += step[1]
    line[0] = level
    line[1] = slope


@device
def _gradient(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    weighted: bool,
    level: float,
    slope: float,
    s: float,
    weight: FloatArray,
    sums: FloatArray,
) -> None:
    """Gradient of sum rho(r / s) on all points, into the first two of ``sums``."""
    g0 = 0.0
    g1 = 0.0
    inverse = 1.0 / s
    root = 1.0
    for i in range(t.size):
        if weighted:
            root = root_weight[i]
        u = (y[i] - level - slope * t[i]) * (root * inverse)
        x = min(abs(u) * CELLS_PER_SIGMA, TABLE - 1e-6)
        k = int(x)
        psi = u * (weight[k] + (x - k) * (weight[k + 1] - weight[k])) * root
        g0 += psi
        g1 += psi * t[i]
    sums[0] = g0
    sums[1] = g1


@device
def mean_square(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    weighted: bool,
    level: float,
    slope: float,
    s: float,
    weight: FloatArray,
    rows: IntArray,
) -> float:
    """Weighted mean of squared whitened residuals over some rows; proportional to the variance of inliers."""
    total = 0.0
    square = 0.0
    root = 1.0
    for i in rows:
        if weighted:
            root = root_weight[i]
        r = (y[i] - level - slope * t[i]) * root
        w = weight[int(min(abs(r) / s * CELLS_PER_SIGMA, TABLE - 1e-6))]
        total += w
        square += w * r * r
    return square / total if total > 0.0 else 0.0


@device
def label_points(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    weighted: bool,
    level: float,
    slope: float,
    threshold: float,
    inlier: BoolArray,
    residual: FloatArray,
) -> None:
    """Fill residuals and labels of all points."""
    root = 1.0
    for i in range(t.size):
        r = y[i] - level - slope * t[i]
        if weighted:
            root = root_weight[i]
        inlier[i] = abs(r * root) <= threshold
        residual[i] = r
