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
    alive = np.empty(count, np.int64)
    inside = np.empty(t.size, np.int64)
    for o in range(2, OCTAVES):
        if made == picks.size:
            break
        scale = 2.0**-o
        living = _find_peaks(evidence, o, count, least, alive)
        for _ in range(per_octave):
            if living == 0 or made == picks.size:
                break
            best = alive[0]
            for k in range(1, living):
                if evidence[o, alive[k]] > evidence[o, best]:
                    best = alive[k]
            mean, spread = _time_of_inliers(t, y, level[best], slope[best], scale, inside)
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
def _find_peaks(evidence: FloatArray, o: int, count: int, least: float, peaks: IntArray) -> int:
    """List the lines whose evidence peaks at octave ``o``; returns how many."""
    here, coarser = evidence[o], evidence[o - 1]
    # Most octaves hold no evidence at all; that is told without a branch per line.
    enough = 0
    for h in range(count):
        enough += 1 if here[h] > least else 0
    if enough == 0:
        return 0
    finest = o + 1 == OCTAVES
    finer = here if finest else evidence[o + 1]
    found = 0
    for h in range(count):
        peaks[found] = h
        beyond = 0.0 if finest else finer[h]
        found += 1 if (here[h] > least) & (here[h] >= coarser[h]) & (here[h] > beyond) else 0
    return found


@device
def _time_of_inliers(
    t: FloatArray, y: FloatArray, level: float, slope: float, scale: float, inside: IntArray
) -> tuple[float, float]:
    """Mean and deviation of the times of the points within ``scale`` of a line; ``inside`` is room."""
    count = 0
    for i in range(t.size):
        inside[count] = i
        count += 1 if abs(y[i] - level - slope * t[i]) <= scale else 0
    s1 = 0.0
    s2 = 0.0
    for k in range(count):
        x = t[inside[k]]
        s1 += x
        s2 += x * x
    mean = s1 / count
    return mean, np.sqrt(max(0.0, s2 / count - mean * mean))


@device
def _is_near(level: float, slope: float, mean: float, spread: float, reach: float) -> bool:
    """Whether a difference of lines stays within ``reach`` where the inliers are."""
    return abs(level + slope * (mean - spread)) < reach and abs(level + slope * (mean + spread)) < reach
