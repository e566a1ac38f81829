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

REACH = 8
TABLE = CELLS_PER_SIGMA * REACH
"""Cells of the weight tables: residuals from 0 to REACH scales; none beyond follows the line."""

_ROOT_2PI = 2.5066282746310002


@device
def fill_tables(params, n, spread, weight, follow_above, follow_below):
    """Tabulate the posterior for residuals above and below the line, and their minimum ``weight``.

    All have TABLE + 1 entries, at |r| = k / CELLS_PER_SIGMA scales.
    """
    s = params[SIGMA]
    share = min(params[INLIERS] / n, 1.0 - 0.5 / n)
    outliers = 1.0 - share
    # Excursions have a level of their own; seen without the time axis they are spread over the range.
    held = min(1.0, params[HELD_COUNT] / max(n - params[INLIERS], 0.5))
    uniform = (held + (1.0 - held) * params[UNIFORM]) / spread
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
        follow_above[k] = f_in / (f_in + outliers * f_above)
        follow_below[k] = f_in / (f_in + outliers * f_below)
        weight[k] = min(follow_above[k], follow_below[k])
    # Continuous at the end of the table.
    weight[TABLE] = 0.0
    follow_above[TABLE] = 0.0
    follow_below[TABLE] = 0.0


@device
def newton_sums(t, y, root_weight, weighted, level, slope, s, weight, stride, sums):
    """Gradient, Hessian and weighted normal matrix of sum rho(r_i / s) at a line, over every stride-th point."""
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
        x = abs(u) * CELLS_PER_SIGMA
        if x < TABLE:
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
def newton_step(sums, s, step):
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
def solve_line(t, y, root_weight, weighted, level, slope, s, weight, line):
    """Newton's method, first on a stride and then on all points; fills ``line`` with (level, slope)."""
    n = t.size
    sums = np.empty(8)
    step = np.empty(2)
    tolerance = 1e-13 * s
    stride = n // 16384
    if stride > 1:
        for _ in range(6):
            newton_sums(t, y, root_weight, weighted, level, slope, s, weight, stride, sums)
            if not newton_step(sums, s, step):
                break
            level += step[0]
            slope += step[1]
            if abs(step[0]) + abs(step[1]) < 1e-4 * s:
                break
    # On many points the stride is already within a hundredth of a scale: one full step finishes it.
    rounds = 30 if n <= 65536 else 1
    for _ in range(rounds):
        newton_sums(t, y, root_weight, weighted, level, slope, s, weight, 1, sums)
        if not newton_step(sums, s, step):
            break
        level += step[0]
        slope += step[1]
        if abs(step[0]) + abs(step[1]) < tolerance:
            break
    line[0] = level
    line[1] = slope


@device
def label_points(
    t, y, root_weight, weighted, level, slope, s, threshold, above, below, inlier, probability, residual, sums
):
    """Residuals, posteriors and labels of all points; ``sums``: posterior weight and its square sum, inliers."""
    z0 = 0.0
    z2 = 0.0
    inliers = 0
    inverse = CELLS_PER_SIGMA / s
    root = 1.0
    for i in range(t.size):
        r = y[i] - level - slope * t[i]
        if weighted:
            root = root_weight[i]
        x = r * root * inverse
        p = 0.0
        if x >= 0.0:
            if x < TABLE:
                k = int(x)
                p = above[k] + (x - k) * (above[k + 1] - above[k])
        elif x > -TABLE:
            k = int(-x)
            p = below[k] + (-x - k) * (below[k + 1] - below[k])
        whitened = r * root
        z0 += p
        z2 += p * whitened * whitened
        inside = abs(whitened) <= threshold
        inliers += inside
        inlier[i] = inside
        probability[i] = p
        residual[i] = r
    sums[0] = z0
    sums[1] = z2
    sums[2] = inliers
