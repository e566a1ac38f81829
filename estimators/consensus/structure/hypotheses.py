"""Lines through low-discrepancy pairs of far-apart points, and the evidence for each at every scale.

A pair whose points lie close together in time gives a useless slope (METHODS.md 2.2: 2 % against 84 % of
clean pairs), so only pairs at least :data:`MIN_GAP` apart are eligible. Which of them are taken follows
Roberts' R2 sequence instead of random numbers: the same data give the same pairs, evenly spread.

The evidence that a line is remarkable at scale e is the Kullback-Leibler gain of having k of n residuals
below e where a uniform background has n p(e): k ln(k / n p) + (n-k) ln((n-k) / n(1-p)), a binomial form
of the a-contrario score (Moisan & Stival 2004; METHODS.md 3.5). One half-octave histogram of the squared
residuals serves all scales.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import device

MIN_GAP = 0.3
"""Smallest distance in time of a pair, in the frame [-1, 1]."""

PAIRS = 300
"""Lines proposed; twice as many find hardly more (METHODS_TRENDS: "250 pairs do as well")."""

OCTAVES = 26
"""Octaves of scale below the range of the values that the histogram tells apart."""

_R2_FIRST = 0.7548776662466927
_R2_SECOND = 0.5698402909980532


@device
def first_eligible(t: FloatArray, gap: float, first: IntArray) -> int:
    """Index of the first point at least ``gap`` after each point; returns the number of eligible pairs."""
    n = t.size
    pairs = 0
    j = 0
    for i in range(n):
        j = max(j, i + 1)
        while j < n and (t[j] - t[i] < gap or t[j] <= t[i]):
            j += 1
        first[i] = j
        pairs += n - j
    return pairs


@device
def propose_lines(t: FloatArray, y: FloatArray, count: int, level: FloatArray, slope: FloatArray) -> int:
    """Fill ``level`` and ``slope`` (at t = 0) with the lines of at most ``count`` pairs; returns how many."""
    n = t.size
    first = np.empty(n, np.int64)
    gap = MIN_GAP
    pairs = first_eligible(t, gap, first)
    # Clumped times leave few far-apart pairs; then nearer ones have to do.
    while pairs < min(count, n * (n - 1) // 8) and gap > 1e-9:
        gap *= 0.25
        pairs = first_eligible(t, gap, first)
    if pairs == 0:
        return 0
    made = 0
    if pairs <= count:
        for i in range(n):
            for j in range(first[i], n):
                b = (y[j] - y[i]) / (t[j] - t[i])
                slope[made] = b
                level[made] = y[i] - b * t[i]
                made += 1
        return made
    cumulative = np.empty(n, np.int64)
    total = 0
    for i in range(n):
        cumulative[i] = total
        total += n - first[i]
    u = 0.5
    v = 0.5
    for _ in range(count):
        u += _R2_FIRST
        u -= math.floor(u)
        v += _R2_SECOND
        v -= math.floor(v)
        target = int(u * total)
        i = int(np.searchsorted(cumulative, target, side="right")) - 1
        while first[i] >= n:
            i -= 1
        j = first[i] + int(v * (n - first[i]))
        b = (y[j] - y[i]) / (t[j] - t[i])
        slope[made] = b
        level[made] = y[i] - b * t[i]
        made += 1
    return made


@device
def scale_evidence(
    t: FloatArray,
    y: FloatArray,
    level: FloatArray,
    slope: FloatArray,
    count: int,
    gain: FloatArray,
    contrast: FloatArray,
) -> None:
    """Fill ``gain[o, h]`` and ``contrast[o, h]``: evidence for line h at scale 2**-o of a unit range.

    ``gain`` compares the count within the scale with a background that is uniform over the range,
    ``contrast`` with one that is uniform over four times the scale, so that a fine line inside a dense
    cloud stands out too.
    """
    n = t.size
    square = np.empty(n, np.float32)
    bits = square.view(np.int32)
    bins = 4 * OCTAVES + 2
    histogram = np.empty(bins, np.int64)
    inside = np.empty(OCTAVES, np.int64)
    # Entropy terms of integers, so that the loop below takes no logarithms of counts.
    m = n - 2
    entropy = np.empty(m + 1)
    entropy[0] = 0.0
    for k in range(1, m + 1):
        entropy[k] = k * math.log(k)
    log_in = np.empty(OCTAVES)
    log_out = np.empty(OCTAVES)
    expected = np.empty(OCTAVES)
    for o in range(OCTAVES):
        # A band of ± e about a line covers 2 e of a unit range.
        p = min(0.95, 2.0 * 2.0**-o)
        expected[o] = m * p
        log_in[o] = math.log(m * p)
        log_out[o] = math.log(m * (1.0 - p))
    quarter = math.log(0.25)
    rest_of_it = math.log(0.75)
    top = 127 << 1  # exponent and first bit of the mantissa of 1.0 in single precision
    for h in range(count):
        a = level[h]
        b = slope[h]
        for i in range(n):
            r = y[i] - a - b * t[i]
            square[i] = np.float32(r * r)
        for k in range(bins):
            histogram[k] = 0
        for i in range(n):
            where = top - (bits[i] >> 22)
            if where < 0:
                where = 0
            elif where > bins - 1:
                where = bins - 1
            histogram[where] += 1
        # A square below 2**(-2 o) lies in a bin above 4 o. The pair itself has no residual: minus 2.
        total = -2
        o = OCTAVES - 1
        for k in range(bins - 1, 0, -1):
            total += histogram[k]
            if k == 4 * o + 1:
                inside[o] = total
                o -= 1
        for o in range(OCTAVES):
            k = inside[o]
            gain[o, h] = 0.0
            contrast[o, h] = 0.0
            if o >= 2 and k > expected[o]:
                rest = m - k
                gain[o, h] = entropy[k] - k * log_in[o] + entropy[rest] - rest * log_out[o]
            wide = inside[o - 2] if o >= 2 else 0
            if 4 * k > wide > 0:
                rest = wide - k
                contrast[o, h] = entropy[k] + entropy[rest] - entropy[wide] - k * quarter - rest * rest_of_it
