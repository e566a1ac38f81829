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
import numpy.typing as npt

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import device

MIN_GAP = 0.3
"""Smallest distance in time of a pair, in the frame [-1, 1]."""

PAIRS = 300
"""Lines proposed; twice as many find hardly more (METHODS_TRENDS: "250 pairs do as well")."""

OCTAVES = 26
"""Octaves of scale below the range of the values that the histogram tells apart."""

_TABLES = 4
"""Points counted side by side."""
_TOP = np.int32((127 << 1) + 3)
"""Exponent and first bit of the mantissa of 1.0 in single precision, and what rounds a quarter of it up."""

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
    inside = np.empty((OCTAVES, count), np.int32)
    _count_inside(t, y, level, slope, count, inside)
    # Entropy terms of integers, so that the loops below take no logarithms of counts.
    m = n - 2
    entropy = np.empty(m + 1)
    entropy[0] = 0.0
    for k in range(1, m + 1):
        entropy[k] = k * math.log(k)
    quarter = math.log(0.25)
    rest_of_it = math.log(0.75)
    gain[:2, :count] = 0.0
    contrast[:2, :count] = 0.0
    for o in range(2, OCTAVES):
        # A band of ± e about a line covers 2 e of a unit range.
        p = min(0.95, 2.0 * 2.0**-o)
        expected = m * p
        log_in = math.log(m * p)
        log_out = math.log(m * (1.0 - p))
        here, broad = inside[o], inside[o - 2]
        gain_here, contrast_here = gain[o], contrast[o]
        # Lines side by side and without a branch, several at a time; evidence that nobody needs costs less.
        for h in range(count):
            k = max(here[h], 0)
            rest = m - k
            value = entropy[k] - k * log_in + entropy[rest] - rest * log_out
            gain_here[h] = value if k > expected else 0.0
        for h in range(count):
            k = max(here[h], 0)
            wide = max(broad[h], k)
            rest = wide - k
            value = entropy[k] + entropy[rest] - entropy[wide] - k * quarter - rest * rest_of_it
            contrast_here[h] = value if 4 * k > wide else 0.0


@device
def _count_inside(
    t: FloatArray,
    y: FloatArray,
    level: FloatArray,
    slope: FloatArray,
    count: int,
    inside: npt.NDArray[np.int32],
) -> None:
    """Fill ``inside[o, h]``: points within 2**-o of line h, but for its own two, which have no residual."""
    n = t.size
    square = np.empty(n, np.float32)
    bits = square.view(np.int32)
    octave = np.empty(n, np.uint8)
    # Neighbouring points often share an octave; in tables of their own they do not wait for each other.
    tables = np.empty((_TABLES, OCTAVES + 2), np.int32)
    whole = n - n % _TABLES
    one = np.int32(1)
    last = np.int32(OCTAVES + 1)
    for h in range(count):
        a = level[h]
        b = slope[h]
        for i in range(n):
            r = y[i] - a - b * t[i]
            square[i] = np.float32(r * r)
        # From the exponent of its square: 1 + o for a residual between half of 2**-o and that.
        for i in range(n):
            octave[i] = min(max((_TOP - (bits[i] >> 22)) >> 2, 0), last)
        tables[:] = 0
        for i in range(0, whole, _TABLES):
            for k in range(_TABLES):
                tables[k, octave[i + k]] += one
        for i in range(whole, n):
            tables[0, octave[i]] += one
        total = -2
        for o in range(OCTAVES, -1, -1):
            for k in range(_TABLES):
                total += tables[k, o + 1]
            if o < OCTAVES:
                inside[o, h] = total
