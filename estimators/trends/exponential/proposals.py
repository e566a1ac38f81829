"""Exponentials through pairs of readings, and the few of them worth weighing.

Two readings of one sign fix y = A exp(b t). How good the pair is depends on the level at its readings, not
only on their distance: a steep curve stands above the noise on a short part of the series only, so pairs are
taken at all distances, the nearer ones more often. Which pairs follows Roberts' R2 sequence: the same data
give the same pairs. The evidence of a curve at every scale is that of
:mod:`estimators.consensus.structure.hypotheses`, from its residuals.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.structure.hypotheses import OCTAVES, scale_evidence
from estimators.kernels import device

PROPOSED = 400
"""Pairs looked at; readings of different signs propose nothing."""

STEEPEST = 340.0
"""Largest |rate| in the frame [-1, 1]: exp(2 * 340) is still a 64-bit float (METHODS.md 11.3: 700)."""

SAME_CURVE = 1.25
"""Two curves are the same structure if they differ by less than this many scales where the inliers are."""

_R2_FIRST = 0.7548776662466927
_R2_SECOND = 0.5698402909980532


@device
def bounded_exp(x: float) -> float:
    """exp(x), held within what squares of 64-bit floats can take."""
    return math.exp(min(max(x, -STEEPEST), STEEPEST))


@device
def propose_curves(t: FloatArray, y: FloatArray, level: FloatArray, rate: FloatArray, made: int) -> int:
    """Append exponentials through pairs to ``level`` (at t = 0) and ``rate``; returns the new count."""
    n = t.size
    u = 0.5
    v = 0.5
    for _ in range(PROPOSED):
        u += _R2_FIRST
        u -= math.floor(u)
        v += _R2_SECOND
        v -= math.floor(v)
        apart = 1 + int(v * v * (n - 1))
        if apart >= n or made == level.size:
            continue
        i = int(u * (n - apart))
        j = i + apart
        if y[i] * y[j] <= 0.0 or t[j] <= t[i]:
            continue
        b = math.log(y[j] / y[i]) / (t[j] - t[i])
        if abs(b) > STEEPEST:
            continue
        rate[made] = b
        level[made] = y[i] * bounded_exp(-b * t[i])
        made += 1
    return made


@device
def fill_residuals(t: FloatArray, y: FloatArray, level: float, rate: float, residual: FloatArray) -> None:
    """Fill readings less the curve ``level * exp(rate * t)``."""
    for i in range(t.size):
        residual[i] = y[i] - level * bounded_exp(rate * t[i])


@device
def shortlist(
    t: FloatArray,
    y: FloatArray,
    level: FloatArray,
    rate: FloatArray,
    count: int,
    per_octave: int,
    least: float,
    picks: IntArray,
    pick_octave: IntArray,
) -> int:
    """Fill ``picks`` with the best different curves at every scale, by both measures; returns how many."""
    gain = np.empty((OCTAVES, count))
    contrast = np.empty((OCTAVES, count))
    residual = np.empty(t.size)
    zero = np.zeros(1)
    for h in range(count):
        fill_residuals(t, y, level[h], rate[h], residual)
        scale_evidence(t, residual, zero, zero, 1, gain[:, h : h + 1], contrast[:, h : h + 1])
    made = 0
    for evidence in (gain, contrast):
        for o in range(2, OCTAVES):
            alive = evidence[o] > least
            for _ in range(per_octave):
                best = -1
                for h in range(count):
                    if alive[h] and (best < 0 or evidence[o, h] > evidence[o, best]):
                        best = h
                if best < 0 or made == picks.size:
                    break
                known = _drop_same(t, y, level, rate, count, best, o, alive, picks, pick_octave, made)
                if not known:
                    picks[made] = best
                    pick_octave[made] = o
                    made += 1
    return made


@device
def _drop_same(
    t: FloatArray,
    y: FloatArray,
    level: FloatArray,
    rate: FloatArray,
    count: int,
    best: int,
    octave: int,
    alive: FloatArray,
    picks: IntArray,
    pick_octave: IntArray,
    made: int,
) -> bool:
    """Drop the curves that are the same structure as the best; returns whether it was picked before."""
    scale = 2.0**-octave
    s0 = 0.0
    s1 = 0.0
    s2 = 0.0
    for i in range(t.size):
        r = y[i] - level[best] * bounded_exp(rate[best] * t[i])
        inside = 1.0 if abs(r) <= scale else 0.0
        s0 += inside
        s1 += inside * t[i]
        s2 += inside * t[i] * t[i]
    mean = s1 / max(s0, 1.0)
    spread = math.sqrt(max(0.0, s2 / max(s0, 1.0) - mean * mean))
    early, late = mean - spread, mean + spread
    at_early = level[best] * bounded_exp(rate[best] * early)
    at_late = level[best] * bounded_exp(rate[best] * late)
    reach = SAME_CURVE * scale
    for h in range(count):
        if alive[h]:
            near = abs(level[h] * bounded_exp(rate[h] * early) - at_early) < reach
            alive[h] = not (near and abs(level[h] * bounded_exp(rate[h] * late) - at_late) < reach)
    alive[best] = False
    for q in range(made):
        if abs(pick_octave[q] - octave) <= 1:
            h = picks[q]
            near = abs(level[h] * bounded_exp(rate[h] * early) - at_early) < reach
            if near and abs(level[h] * bounded_exp(rate[h] * late) - at_late) < reach:
                return True
    return False
