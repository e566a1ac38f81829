"""The few lines worth weighing: at each scale the best ones that are not the same line again."""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.structure.hypotheses import OCTAVES
from estimators.kernels import device

SAME_LINE = 1.25
"""Two lines are the same structure if they differ by less than this many scales where the inliers are."""


@device
def pick_lines(
    t: FloatArray,
    y: FloatArray,
    level: FloatArray,
    slope: FloatArray,
    count: int,
    evidence: FloatArray,
    per_octave: int,
    least: float,
    made: int,
    picks: IntArray,
    pick_octave: IntArray,
) -> int:
    """Append to ``picks`` and ``pick_octave``; returns their new length.

    A line stands for itself at the scales where its evidence peaks; at every scale the best lines are
    taken greedily, each dropping those that are the same structure. Sameness is measured at mean ±
    deviation of the times of the pick's inliers, not at the ends of the range: otherwise one burst fills
    the list with its tilts.
    """
    n = t.size
    alive = np.empty(count, np.int64)
    for o in range(2, OCTAVES):
        scale = 2.0**-o
        living = 0
        for h in range(count):
            here = evidence[o, h]
            finer = evidence[o + 1, h] if o + 1 < OCTAVES else 0.0
            if here > least and here >= evidence[o - 1, h] and here > finer:
                alive[living] = h
                living += 1
        for _ in range(per_octave):
            if living == 0 or made == picks.size:
                break
            best = alive[0]
            for k in range(1, living):
                if evidence[o, alive[k]] > evidence[o, best]:
                    best = alive[k]
            s0 = 0.0
            s1 = 0.0
            s2 = 0.0
            for i in range(n):
                r = y[i] - level[best] - slope[best] * t[i]
                inside = 1.0 if abs(r) <= scale else 0.0
                s0 += inside
                s1 += inside * t[i]
                s2 += inside * t[i] * t[i]
            mean = s1 / s0
            spread = np.sqrt(max(0.0, s2 / s0 - mean * mean))
            reach = SAME_LINE * scale
            left = 0
            for k in range(living):
                h = alive[k]
                if not _is_near(level[h] - level[best], slope[h] - slope[best], mean, spread, reach):
                    alive[left] = h
                    left += 1
            living = left
            known = False
            for q in range(made):
                if abs(pick_octave[q] - o) <= 1:
                    h = picks[q]
                    da, db = level[h] - level[best], slope[h] - slope[best]
                    known = known or _is_near(da, db, mean, spread, reach)
            if not known:
                picks[made] = best
                pick_octave[made] = o
                made += 1
    return made


@device
def _is_near(level: float, slope: float, mean: float, spread: float, reach: float) -> bool:
    """Whether a difference of lines stays within ``reach`` where the inliers are."""
    return abs(level + slope * (mean - spread)) < reach and abs(level + slope * (mean + spread)) < reach
