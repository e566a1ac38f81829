"""The few hypotheses of very many that are weighed in earnest: at each scale the best of different curves.

As for the line: per octave a few, greedily, each dropping what is within 2.5 scales of it where its points
are (METHODS_TRENDS). A curve with many coefficients has many near copies, which would crowd out all others.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.bases.weighing import fill_residual
from estimators.consensus.structure.hypotheses import OCTAVES
from estimators.kernels import device

PER_OCTAVE = 6
"""Different hypotheses taken at each octave of scale."""

_APART = 2.5
_LOOKED_AT = 300
"""Hypotheses that are compared with those taken, per octave."""
_PLACES = 32
"""Points of a curve at which others are compared with it."""


@device
def scale_gains(columns: FloatArray, y: FloatArray, thetas: FloatArray, gain: FloatArray) -> None:
    """Fill ``gain[o, h]``: evidence for hypothesis h at scale 2**-o of a unit range.

    The Kullback-Leibler gain of the count within the scale over a uniform background, as for the line
    (:mod:`estimators.consensus.structure.hypotheses`; a binomial form of the a-contrario score, Moisan &
    Stival 2004; METHODS.md 3.5). The sample itself, which has no residual, does not count.
    """
    p, n = columns.shape
    m = n - p
    inside = np.empty(OCTAVES + 1, np.int64)
    residual = np.empty(n)
    for h in range(thetas.shape[0]):
        fill_residual(columns, y, thetas[h], residual)
        inside[:] = 0
        for i in range(n):
            size = abs(residual[i])
            octave = OCTAVES if size == 0.0 else -math.frexp(size)[1]
            inside[min(max(octave, 0), OCTAVES)] += 1
        k = inside[OCTAVES] - p
        for o in range(OCTAVES - 1, -1, -1):
            k += inside[o]
            chance = min(0.95, 2.0 * 2.0**-o)
            gain[o, h] = 0.0
            if o >= 2 and k > m * chance:
                value = k * math.log(k / (m * chance))
                if k < m:
                    value += (m - k) * math.log((m - k) / (m * (1.0 - chance)))
                gain[o, h] = value


@device
def pick_starts(
    columns: FloatArray,
    y: FloatArray,
    thetas: FloatArray,
    gain: FloatArray,
    picks: IntArray,
    pick_octave: IntArray,
) -> int:
    """Choose hypotheses at each octave of scale whose evidence peaks there; returns how many."""
    count = gain.shape[1]
    octaves = gain.shape[0]
    made = 0
    peaking = np.empty(count, np.int64)
    height = np.empty(count)
    places = np.empty((PER_OCTAVE, _PLACES), np.int64)
    for o in range(2, octaves):
        here = 0
        for h in range(count):
            finer = gain[o + 1, h] if o + 1 < octaves else 0.0
            if gain[o, h] > 0.0 and gain[o, h] >= gain[o - 1, h] and gain[o, h] > finer:
                peaking[here] = h
                height[here] = -gain[o, h]
                here += 1
        order = np.argsort(height[:here], kind="mergesort")
        first = made
        for rank in range(min(here, _LOOKED_AT)):
            if made - first == PER_OCTAVE or made == picks.size:
                break
            h = peaking[order[rank]]
            # The scale of what is within an octave is about half of it.
            reach = _APART * 0.5 * 2.0**-o
            known = False
            for k in range(first, made):
                if _is_near(columns, thetas[h], thetas[picks[k]], places[k - first], reach):
                    known = True
                    break
            if not known:
                _spread_places(columns, y, thetas[h], 2.0**-o, places[made - first])
                picks[made] = h
                pick_octave[made] = o
                made += 1
    return made


@device
def _is_near(
    columns: FloatArray, theta: FloatArray, other: FloatArray, places: IntArray, reach: float
) -> bool:
    """Whether two curves differ by less than the reach, in root mean square over the places."""
    square = 0.0
    used = 0
    for place in places:
        if place < 0:
            break
        d = 0.0
        for j in range(theta.size):
            d += (theta[j] - other[j]) * columns[j, place]
        square += d * d
        used += 1
    return square <= used * reach * reach


@device
def _spread_places(
    columns: FloatArray, y: FloatArray, theta: FloatArray, within: float, places: IntArray
) -> None:
    """Write some of the points within a distance of a curve, spread over all of them; then -1."""
    n = y.size
    residual = np.empty(n)
    fill_residual(columns, y, theta, residual)
    inside = 0
    for i in range(n):
        if abs(residual[i]) <= within:
            inside += 1
    places[:] = -1
    used = seen = 0
    for i in range(n):
        if abs(residual[i]) <= within:
            if used < places.size and seen * places.size >= used * inside:
                places[used] = i
                used += 1
            seen += 1
