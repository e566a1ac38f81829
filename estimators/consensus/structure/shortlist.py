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
    height = np.empty(count)
    for o in range(2, OCTAVES):
        scale = 2.0**-o
        for h in range(count):
            here = evidence[o, h]
            finer = evidence[o + 1, h] if o + 1 < OCTAVES else 0.0
            height[h] = here if here > least and here >= evidence[o - 1, h] and here > finer else 0.0
        for _ in range(per_octave):
            best = -1
            best_height = 0.0
            for h in range(count):
                if height[h] > best_height:
                    best_height = height[h]
                    best = h
            if best < 0 or made == picks.size:
                break
            s0 = 0.0
            s1 = 0.0
            s2 = 0.0
            for i in range(n):
                r = y[i] - level[best] - slope[best] * t[i]
                if abs(r) <= scale:
                    s0 += 1.0
                    s1 += t[i]
                    s2 += t[i] * t[i]
            mean = s1 / s0
            spread = np.sqrt(max(0.0, s2 / s0 - mean * mean))
            reach = SAME_LINE * scale
            for h in range(count):
                if height[h] > 0.0:
                    da = level[h] - level[best]
                    db = slope[h] - slope[best]
                    if abs(da + db * (mean - spread)) < reach and abs(da + db * (mean + spread)) < reach:
                        height[h] = 0.0
            height[best] = 0.0
            known = False
            for q in range(made):
                if abs(pick_octave[q] - o) <= 1:
                    da = level[picks[q]] - level[best]
                    db = slope[picks[q]] - slope[best]
                    near = abs(da + db * (mean - spread)) < reach and abs(da + db * (mean + spread)) < reach
                    known = known or near
            if not known:
                picks[made] = best
                pick_octave[made] = o
                made += 1
    return made
