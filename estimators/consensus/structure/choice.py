"""From hypotheses to the one structure that leaves the series cheapest to describe."""

from __future__ import annotations

import math

import numpy as np

from estimators.consensus.structure.hypotheses import OCTAVES, propose_lines, scale_evidence
from estimators.consensus.structure.mixture import (
    HELD_COUNT,
    INLIERS,
    LEVEL,
    LIKELIHOOD,
    SIGMA,
    SLOPE,
    TIME_SPREAD,
    em_step,
    start,
)
from estimators.consensus.structure.shortlist import pick_lines
from estimators.kernels import device

PAIRS = 400
PER_OCTAVE = 4
LEAST_EVIDENCE = 2.5
MOST = 48
SECOND_ROUND = 16
FINALISTS = 4
FINAL_STEPS = 6
SHARE_WEIGHT = 2.0
HELD_WEIGHT = 2.0
SCALE_POWER = 1.0
SIDE_PRICE = 0.25
SIDES_PRICE = 3.0
PARENTS = 2
PARALLELS = 4
BANK = MOST + PARENTS * PARALLELS + 4 * FINALISTS


@device
def criterion(params, n, sides):
    """Log evidence of a structure; larger is better.

    The log-likelihood, 2 ln s - ln(S Sxx) / 2 for the posterior volume of level and slope (Laplace),
    a log prior on the share of inliers that settles ties between branches, and a price on sides.
    """
    if params[LIKELIHOOD] < -1e290 or params[INLIERS] < 3.0 or params[TIME_SPREAD] <= 0.0:
        return -1e300
    s = params[SIGMA]
    value = (
        params[LIKELIHOOD] + SCALE_POWER * math.log(s) - 0.4 * math.log(params[INLIERS] * params[TIME_SPREAD])
    )
    value += SHARE_WEIGHT * math.log(params[INLIERS] / n)
    value += HELD_WEIGHT * math.log(params[INLIERS] / (params[INLIERS] + params[HELD_COUNT]))
    if sides == 1 or sides == -1:
        value -= SIDE_PRICE * math.log(n)
    elif sides == 2:
        value -= SIDES_PRICE * math.log(n)
    return value


@device
def find_structure(
    t, y, root_weight, thin_t, thin_y, spread, sigma_floor, fixed, bank, scores, sides_of, counts
):
    """Weigh lines proposed on the thinned series and rank the finalists.

    Fills ``bank`` (BANK, SIZE) with candidates, their ``scores`` and ``sides_of``, and ``counts`` with pairs,
    candidates and passes over the series; returns the index of the best, or -1 when no line stands out.
    ``fixed``: a given noise scale, or 0.
    """
    n = t.size
    level = np.empty(PAIRS)
    slope = np.empty(PAIRS)
    count = propose_lines(thin_t, thin_y, PAIRS, level, slope)
    counts[0] = count
    if count == 0:
        return -1
    gain = np.empty((OCTAVES, count))
    contrast = np.empty((OCTAVES, count))
    scale_evidence(thin_t, thin_y, level, slope, count, gain, contrast)
    picks = np.empty(MOST, np.int64)
    octave = np.empty(MOST, np.int64)
    made = pick_lines(thin_t, thin_y, level, slope, count, gain, PER_OCTAVE, LEAST_EVIDENCE, 0, picks, octave)
    made = pick_lines(
        thin_t, thin_y, level, slope, count, contrast, PER_OCTAVE, LEAST_EVIDENCE, made, picks, octave
    )
    first = np.full(made + PARENTS * PARALLELS, -1e300)
    base = made
    for q in range(made):
        h = picks[q]
        start(t, y, root_weight, level[h], slope[h], 2.0 ** -octave[q], sigma_floor, fixed, bank[q])
        em_step(t, y, root_weight, spread, 2, sigma_floor, fixed, bank[q])
        first[q] = criterion(bank[q], n, 0)
    for _ in range(2):
        order = np.argsort(-first[:made])
        for rank in range(min(SECOND_ROUND, made)):
            q = order[rank]
            em_step(t, y, root_weight, spread, 2, sigma_floor, fixed, bank[q])
            first[q] = criterion(bank[q], n, 0)
    made = propose_parallels(thin_t, thin_y, bank, first, made)
    for q in range(base, made):
        start(
            t,
            y,
            root_weight,
            bank[q, LEVEL],
            bank[q, SLOPE],
            2.5 * bank[q, SIGMA],
            sigma_floor,
            fixed,
            bank[q],
        )
        for _ in range(3):
            em_step(t, y, root_weight, spread, 2, sigma_floor, fixed, bank[q])
        first[q] = criterion(bank[q], n, 0)
    order = np.argsort(-first[:made])
    counts[1] = made
    counts[2] = base + 2 * min(SECOND_ROUND, base) + 3 * (made - base)
    best = -1
    best_score = -1e300
    slot = made
    # A finalist stands for all candidates that have run into the same line.
    taken = np.empty(FINALISTS, np.int64)
    finalists = 0
    for rank in range(made):
        q = order[rank]
        if finalists == FINALISTS or first[q] <= -1e290:
            break
        same = False
        for f in range(finalists):
            same = same or same_line(bank[q], bank[taken[f]])
        if same:
            continue
        taken[finalists] = q
        finalists += 1
        for sides in (0, 1, -1, 2):
            bank[slot] = bank[q]
            start_sides(bank[slot], sides)
            for _ in range(FINAL_STEPS):
                em_step(t, y, root_weight, spread, sides, sigma_floor, fixed, bank[slot])
                counts[2] += 1
            scores[slot] = criterion(bank[slot], n, sides)
            sides_of[slot] = sides
            if scores[slot] > best_score:
                best_score = scores[slot]
                best = slot
            slot += 1
    return best


@device
def start_sides(params, sides):
    """Turn off the sides that a finalist is tried without."""
    if sides in (0, -1):
        params[4] = 0.0
    if sides in (0, 1):
        params[6] = 0.0
    params[3] = max(0.05, 1.0 - params[4] - params[6])


@device
def propose_parallels(t, y, bank, first, made):
    """Append lines parallel to the best candidates where many residuals gather; returns the new count.

    An excursion that keeps its level runs parallel to the trend it left. Once one of them is found, the
    others, and the trend itself, are the modes of its residuals: far easier to find there than by pairs.
    """
    n = t.size
    residual = np.empty(n)
    order = np.argsort(-first[:made])
    top = made
    parents = 0
    for rank in range(made):
        q = order[rank]
        if parents == PARENTS or first[q] <= -1e290:
            break
        new = True
        for f in range(rank):
            o = order[f]
            if same_line(bank[q], bank[o]):
                new = False
                break
        if not new:
            continue
        parents += 1
        s = bank[q, SIGMA]
        for i in range(n):
            residual[i] = y[i] - bank[q, LEVEL] - bank[q, SLOPE] * t[i]
        ordered = np.sort(residual)
        free = np.ones(n, np.bool_)
        for i in range(n):
            free[i] = abs(ordered[i]) > 2.0 * s
        for _ in range(PARALLELS):
            best_count = 3
            best_left = -1
            right = 0
            count = 0
            for left in range(n):
                while right < n and ordered[right] - ordered[left] <= 2.0 * s:
                    count += free[right]
                    right += 1
                if count > best_count:
                    best_count = count
                    best_left = left
                count -= free[left]
            if best_left < 0:
                break
            middle = ordered[best_left] + s
            bank[made] = bank[q]
            bank[made, LEVEL] = bank[q, LEVEL] + middle
            for i in range(n):
                if abs(ordered[i] - middle) <= 2.0 * s:
                    free[i] = False
            made += 1
    return made


@device
def same_line(one, other):
    """Whether two candidates have run into the same line and scale."""
    reach = 0.5 * (one[SIGMA] + other[SIGMA])
    at_left = abs(one[LEVEL] - other[LEVEL] - one[SLOPE] + other[SLOPE])
    at_right = abs(one[LEVEL] - other[LEVEL] + one[SLOPE] - other[SLOPE])
    ratio = one[SIGMA] / other[SIGMA]
    return at_left < reach and at_right < reach and 0.5 < ratio < 2.0
