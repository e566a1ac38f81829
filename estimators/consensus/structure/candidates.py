"""The candidates: proposed by pairs, sifted by a few steps of EM, joined by lines parallel to the best."""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.structure.criterion import IMPOSSIBLE, criterion, same_structure
from estimators.consensus.structure.em import em_step
from estimators.consensus.structure.hypotheses import OCTAVES, PAIRS, propose_lines, scale_evidence
from estimators.consensus.structure.mixture import LEVEL, SIGMA, SLOPE, start
from estimators.consensus.structure.ranking import sort_values
from estimators.consensus.structure.shortlist import pick_lines
from estimators.kernels import device

MOST = 40
"""Proposed lines that are weighed."""
PARENTS, PARALLELS = 2, 3
"""Parallels are proposed to this many of the best lines, and this many to each."""
CANDIDATES = MOST + PARENTS * PARALLELS

_PER_OCTAVE = 3
_LEAST_EVIDENCE = 2.5
_FIRST_ROUND = 24
_SECOND_ROUND = 10
"""Candidates that get one step of EM, and those that get more; their scores fall off steeply."""
_ALWAYS = 3
_HOPELESS = 60.0
_HOPELESS_PER_POINT = 0.5
_PARALLEL_STEPS = 2
_START_WIDTH = 2.5
"""Scales within which a reading is first taken for an inlier."""
_CROWD = 4
"""Residuals that must gather for a parallel to be proposed there."""

# Slots of the counts.
PROPOSED, WEIGHED, EVALUATIONS = range(3)


@device
def find_candidates(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    sigma_floor: float,
    fixed: float,
    bank: FloatArray,
    first: FloatArray,
    counts: IntArray,
) -> int:
    """Fill ``bank`` with candidates and ``first`` with their scores; returns how many.

    ``counts`` receives lines proposed, candidates weighed and mixture evaluations of single points.
    """
    level = np.empty(PAIRS)
    slope = np.empty(PAIRS)
    picks = np.empty(MOST, np.int64)
    octave = np.empty(MOST, np.int64)
    made = _shortlist(t, y, level, slope, picks, octave, counts)
    counts[WEIGHED] = made
    if made == 0:
        return 0
    for q in range(made):
        h = picks[q]
        start(t, y, root_weight, level[h], slope[h], 2.0 ** -octave[q], sigma_floor, fixed, bank[q])
        first[q] = criterion(bank[q], t.size, 0)
    sift(t, y, root_weight, sigma_floor, fixed, bank, first, 0, made, _FIRST_ROUND, _ALWAYS, 1, counts)
    sift(t, y, root_weight, sigma_floor, fixed, bank, first, 0, made, _SECOND_ROUND, _ALWAYS, 2, counts)
    base = made
    made = _propose_parallels(t, y, bank, first, base)
    for q in range(base, made):
        width = _START_WIDTH * bank[q, SIGMA]
        start(t, y, root_weight, bank[q, LEVEL], bank[q, SLOPE], width, sigma_floor, fixed, bank[q])
        first[q] = criterion(bank[q], t.size, 0)
    few = made - base
    steps = _PARALLEL_STEPS
    sift(t, y, root_weight, sigma_floor, fixed, bank, first, base, made, few, few, steps, counts)
    counts[WEIGHED] = made
    return made


@device
def _shortlist(
    t: FloatArray,
    y: FloatArray,
    level: FloatArray,
    slope: FloatArray,
    picks: IntArray,
    octave: IntArray,
    counts: IntArray,
) -> int:
    """Propose lines and pick those worth weighing; returns how many."""
    count = propose_lines(t, y, PAIRS, level, slope)
    counts[PROPOSED] = count
    if count == 0:
        return 0
    gain = np.empty((OCTAVES, count))
    contrast = np.empty((OCTAVES, count))
    scale_evidence(t, y, level, slope, count, gain, contrast)
    made = 0
    for evidence in (gain, contrast):
        made = pick_lines(
            t, y, level, slope, count, evidence, _PER_OCTAVE, _LEAST_EVIDENCE, made, picks, octave
        )
    return made


@device
def sift(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    sigma_floor: float,
    fixed: float,
    bank: FloatArray,
    first: FloatArray,
    begin: int,
    end: int,
    keep: int,
    always: int,
    steps: int,
    counts: IntArray,
) -> None:
    """Take steps of EM for the best ``keep`` of the candidates begin:end, reordering them at each step.

    Beyond the first ``always``, hopeless ones are passed over.
    """
    for _ in range(steps):
        order = np.argsort(-first[begin:end])
        hopeless = first[:end].max() - patience(t.size)
        for rank in range(min(keep, end - begin)):
            q = begin + order[rank]
            if rank >= always and first[q] < hopeless:
                break
            em_step(t, y, root_weight, 2, sigma_floor, fixed, False, bank[q])
            first[q] = criterion(bank[q], t.size, 0)
            counts[EVALUATIONS] += t.size


@device
def patience(n: int) -> float:
    """Log evidence behind the best from which a candidate is given up; long series settle later."""
    return max(_HOPELESS, _HOPELESS_PER_POINT * n)


@device
def among(bank: FloatArray, q: int, chosen: IntArray, count: int) -> bool:
    """Whether a candidate has run into one of those already chosen."""
    found = False
    for f in range(count):
        found = found or same_structure(bank[q], bank[chosen[f]])
    return found


@device
def _propose_parallels(t: FloatArray, y: FloatArray, bank: FloatArray, first: FloatArray, made: int) -> int:
    """Append lines parallel to the best candidates where many residuals gather; returns the new count.

    An excursion that keeps its level runs parallel to the trend it left. Once one of them is found, the
    others, and the trend itself, are the modes of its residuals: far easier to find there than by pairs.
    """
    n = t.size
    order = np.argsort(-first[:made])
    parents = np.empty(PARENTS, np.int64)
    count = 0
    for rank in range(made):
        q = order[rank]
        if count == PARENTS or first[q] <= IMPOSSIBLE:
            break
        if among(bank, q, parents, count):
            continue
        parents[count] = q
        count += 1
        residual = np.empty(n)
        for i in range(n):
            residual[i] = y[i] - bank[q, LEVEL] - bank[q, SLOPE] * t[i]
        sort_values(residual)
        width = 2.0 * bank[q, SIGMA]
        free = np.abs(residual) > width
        for _ in range(PARALLELS):
            left = _densest(residual, free, width)
            if left < 0:
                break
            middle = residual[left] + 0.5 * width
            bank[made] = bank[q]
            bank[made, LEVEL] = bank[q, LEVEL] + middle
            made += 1
            free &= np.abs(residual - middle) > width
    return made


@device
def _densest(ordered: FloatArray, free: FloatArray, width: float) -> int:
    """Left end of the window with most free residuals; -1 if none holds a crowd."""
    best = -1
    most = _CROWD - 1
    right = 0
    inside = 0
    for left in range(ordered.size):
        while right < ordered.size and ordered[right] - ordered[left] <= width:
            inside += free[right]
            right += 1
        if inside > most:
            most = inside
            best = left
        inside -= free[left]
    return best
