"""Influence of residuals on a line, summed over a series in a pass or two.

What a sandwich variance is made of (A = sum psi' x x', B = sum psi^2 x x', Huber 1981), together with what
else an answer reports about its inliers, so that a long series is read
seldom.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import FloatArray
from estimators.kernels import device, kernel, ro
from estimators.regression.loss import CELLS_PER_SIGMA, Loss, LossKind

A0, A1, A2, B0, B1, B2, W0, W1, W2 = range(9)
"""Slots: A, B and the weight matrix sum psi/u x x', each by powers of time."""
SUPPORT = 9
"""Sum of the weights of the inliers."""
INLIERS = 10
LAGGED = 11
"""Sum of psi_i psi_(i+1) over the PAIRS of neighbours that are both inliers."""
PAIRS = 12
PSI_SQUARE = 13
"""Sum of psi^2 over the inliers."""
SSE = 14
"""Sum of squared residuals of the inliers."""
VALUE = 15
VALUE_SQUARE = 16
"""Sums of y - y_0 and of its square over the inliers."""
SUMS = 17

LONG = 65536
"""Points from which inference reads a part of the series: BLOCKS blocks of BLOCK neighbours."""
BLOCKS, BLOCK = 64, 512

_SQUARE = int(LossKind.square)
_TRUNCATED = int(LossKind.truncated)
_HUBER = int(LossKind.huber)
_BISQUARE = int(LossKind.bisquare)
_RANK = int(LossKind.rank)
_TABULATED = int(LossKind.tabulated)
_TWO_DENSITIES = 2.0 / math.sqrt(2.0 * math.pi)
_ROOT_HALF = math.sqrt(0.5)


@device
def influence(kind: int, c: float, jump: float, table: FloatArray, u: float) -> tuple[float, float, float]:
    """Return psi(u), psi'(u) and psi(u) / u; psi' in expectation under the normal law where psi jumps."""
    x = abs(u)
    if kind == _TABULATED:
        # Beyond the table psi is 0; clamping instead of branching keeps random outliers cheap.
        cell = min(x * CELLS_PER_SIGMA, table.size - 1.000001)
        k = int(cell)
        rise = table[k + 1] - table[k]
        w = table[k] + (cell - k) * rise
        return u * w, w + cell * rise, w
    if kind == _SQUARE:
        return u, 1.0, 1.0
    if kind == _TRUNCATED:
        return (u, 1.0 - jump, 1.0) if x <= c else (0.0, 0.0, 0.0)
    if kind == _HUBER:
        if x <= c:
            return u, 1.0, 1.0
        return (c if u > 0.0 else -c), 0.0, c / x
    if kind == _BISQUARE:
        v = 1.0 - (u / c) ** 2
        if v <= 0.0:
            return 0.0, 0.0, 0.0
        return u * v * v, v * (5.0 * v - 4.0), v * v
    if kind == _RANK:
        psi = math.erf(u * _ROOT_HALF)
        slope = _TWO_DENSITIES * math.exp(-0.5 * u * u)
        return psi, slope, (psi / u if u != 0.0 else slope)
    # The weight of a sign grows without bound at 0; the curvature it stands in for does not.
    sign = 1.0 if u > 0.0 else (-1.0 if u < 0.0 else 0.0)
    return sign, _TWO_DENSITIES, min(1.0 / x, 1.0 / _TWO_DENSITIES) if x > 0.0 else 1.0 / _TWO_DENSITIES


@device
def sum_curvature(
    t: FloatArray,
    residual: FloatArray,
    root_weight: FloatArray,
    sigma: float,
    kind: int,
    c: float,
    jump: float,
    table: FloatArray,
    sums: FloatArray,
) -> None:
    """Fill the slots of A and of the weight matrix."""
    a0 = a1 = a2 = 0.0
    w0 = w1 = w2 = 0.0
    weighted = root_weight.size > 0
    square = 1.0
    root = 1.0
    inverse = 1.0 / sigma
    for i in range(t.size):
        if weighted:
            root = root_weight[i]
            square = root * root
        _, bend, pull = influence(kind, c, jump, table, residual[i] * root * inverse)
        bend *= square
        pull *= square
        ti = t[i]
        a0 += bend
        a1 += bend * ti
        a2 += bend * ti * ti
        w0 += pull
        w1 += pull * ti
        w2 += pull * ti * ti
    sums[A0], sums[A1], sums[A2] = a0, a1, a2
    sums[W0], sums[W1], sums[W2] = w0, w1, w2


@device
def sum_scatter(
    t: FloatArray,
    y: FloatArray,
    residual: FloatArray,
    root_weight: FloatArray,
    sigma: float,
    threshold: float,
    kind: int,
    c: float,
    jump: float,
    table: FloatArray,
    sums: FloatArray,
) -> None:
    """Fill the slots of B and those about the inliers; their whitened residual is at most ``threshold``.

    Of a series longer than LONG, what only inference needs is summed over blocks of neighbours that cover a
    part of it evenly, and scaled up: a standard error is then true to half a per cent.
    """
    n = t.size
    if n <= LONG:
        _scatter_of(t, y, residual, root_weight, sigma, threshold, kind, c, jump, table, sums)
        return
    part = np.empty(SUMS)
    total = np.zeros(SUMS)
    covered = 0
    for k in range(BLOCKS):
        i = k * (n - BLOCK) // (BLOCKS - 1)
        j = i + BLOCK
        roots = root_weight[i:j] if root_weight.size > 0 else root_weight
        _scatter_of(t[i:j], y[i:j], residual[i:j], roots, sigma, threshold, kind, c, jump, table, part)
        for slot in (B0, B1, B2, SUPPORT, LAGGED, PAIRS, PSI_SQUARE):
            total[slot] += part[slot]
        covered += BLOCK
    for slot in (B0, B1, B2, SUPPORT, LAGGED, PAIRS, PSI_SQUARE):
        sums[slot] = total[slot] * n / covered
    _describe_inliers(y, residual, root_weight, threshold, sums)


@device
def _describe_inliers(
    y: FloatArray, residual: FloatArray, root_weight: FloatArray, threshold: float, sums: FloatArray
) -> None:
    """Fill the slots of the number of inliers, of their squares and of their values."""
    inliers = 0
    sse = value = value_square = 0.0
    weighted = root_weight.size > 0
    root = 1.0
    start = y[0]
    for i in range(y.size):
        if weighted:
            root = root_weight[i]
        r = residual[i]
        inside = abs(r) * root <= threshold
        r = r if inside else 0.0
        v = y[i] - start if inside else 0.0
        inliers += inside
        sse += r * r
        value += v
        value_square += v * v
    sums[INLIERS] = inliers
    sums[SSE], sums[VALUE], sums[VALUE_SQUARE] = sse, value, value_square


@device
def _scatter_of(
    t: FloatArray,
    y: FloatArray,
    residual: FloatArray,
    root_weight: FloatArray,
    sigma: float,
    threshold: float,
    kind: int,
    c: float,
    jump: float,
    table: FloatArray,
    sums: FloatArray,
) -> None:
    """Fill the slots of :func:`sum_scatter` from every point."""
    b0 = b1 = b2 = 0.0
    support = inliers = lagged = pairs = psi_square = 0.0
    sse = value = value_square = 0.0
    last = 0.0
    was_in = 0.0
    weighted = root_weight.size > 0
    root = 1.0
    square = 1.0
    inverse = 1.0 / sigma
    start = y[0]
    for i in range(t.size):
        if weighted:
            root = root_weight[i]
            square = root * root
        r = residual[i]
        psi, _, pull = influence(kind, c, jump, table, r * root * inverse)
        ti = t[i]
        spread = psi * psi * square
        b0 += spread
        b1 += spread * ti
        b2 += spread * ti * ti
        inside = 1.0 if abs(r) * root <= threshold else 0.0
        psi *= inside
        inliers += inside
        support += pull * square * inside
        psi_square += psi * psi
        lagged += psi * last
        pairs += inside * was_in
        last = psi
        was_in = inside
        sse += inside * r * r
        v = (y[i] - start) * inside
        value += v
        value_square += v * v
    sums[B0], sums[B1], sums[B2] = b0, b1, b2
    sums[SUPPORT], sums[INLIERS] = support, inliers
    sums[LAGGED], sums[PAIRS], sums[PSI_SQUARE] = lagged, pairs, psi_square
    sums[SSE], sums[VALUE], sums[VALUE_SQUARE] = sse, value, value_square


_f8 = types.float64


@kernel(
    types.void(
        ro(_f8), ro(_f8), ro(_f8), ro(_f8), _f8, _f8, types.int64, _f8, _f8, ro(_f8),
        types.Array(_f8, 1, "C"),
    )
)  # fmt: skip
def fill_influence(
    t: FloatArray,
    y: FloatArray,
    residual: FloatArray,
    root_weight: FloatArray,
    sigma: float,
    threshold: float,
    kind: int,
    c: float,
    jump: float,
    table: FloatArray,
    sums: FloatArray,
) -> None:
    """Fill all slots: the compiled entry of :func:`influence_sums`."""
    sum_curvature(t, residual, root_weight, sigma, kind, c, jump, table, sums)
    sum_scatter(t, y, residual, root_weight, sigma, threshold, kind, c, jump, table, sums)


_EMPTY = np.empty(0)


def influence_sums(
    t: FloatArray,
    y: FloatArray,
    residual: FloatArray,
    root_weight: FloatArray | None,
    sigma: float,
    threshold: float,
    loss: Loss,
) -> FloatArray:
    """Sum what inference needs over a fitted series.

    Parameters
    ----------
    t, y, residual : ndarray of float64, shape (n,)
        Times about [-1, 1], values, signed residuals.
    root_weight : ndarray of float64, shape (n,), or None
        Square roots of the precisions.
    sigma, threshold : float
        Noise scale; largest whitened residual of an inlier.
    loss : Loss
        What the line minimises.

    Returns
    -------
    ndarray of float64, shape (SUMS,)
        By the slots of this module.

    Examples
    --------
    >>> t, r = np.array([-1.0, 0.0, 1.0]), np.array([0.1, -0.2, 0.1])
    >>> sums = influence_sums(t, r, r, None, 0.2, 1.0, Loss(LossKind.square))
    >>> float(sums[A0]), float(sums[INLIERS])
    (3.0, 3.0)
    """
    sums = np.empty(SUMS)
    fill_influence(
        t,
        y,
        residual,
        _EMPTY if root_weight is None else root_weight,
        sigma,
        threshold,
        int(loss.kind),
        loss.tuning,
        loss.jump,
        _EMPTY if loss.table is None else loss.table,
        sums,
    )
    return sums
