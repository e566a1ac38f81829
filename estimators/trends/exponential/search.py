"""The compiled search for an exponential under additive noise: threshold-free, without random numbers."""

from __future__ import annotations

import numpy as np
from numba import types

from estimators.arrays import FloatArray
from estimators.consensus.structure.criterion import IMPOSSIBLE, criterion
from estimators.consensus.structure.finish import TABLE, fill_tables
from estimators.consensus.structure.frame import thin
from estimators.consensus.structure.mixture import ABOVE, BELOW, SIGMA, start, start_sides
from estimators.kernels import device, kernel, ro
from estimators.trends.exponential.proposals import (
    PROPOSED,
    bounded_exp,
    fill_residuals,
    propose_curves,
    shortlist,
)
from estimators.trends.exponential.weighing import (
    AMPLITUDE,
    RATE,
    SLOTS,
    acquit_curve,
    linearise,
    newton_curve,
    refine_curve,
)

PROPOSE_FROM = 300
"""Readings that curves are proposed from and sifted on."""
WEIGH_ON = 1000
"""Readings that the finalists are fitted to; both subsets are spread over the whole series."""
MOST = 40
FINALISTS = 6
ROWS = MOST + FINALISTS

_PER_OCTAVE = 3
_LEAST_EVIDENCE = 2.5
_FIRST_ROUND = 24
_SECOND_ROUND = 10
_REFINED = 5
_LAST_ROUND = 3
_LAST_STEPS = 4
_NEWTON_STEPS = 60

# Slots of the record.
FOUND, SCORE, TAU_ZERO, SCALE, WEIGHED, EVALUATIONS, RIVAL, RIVAL_LEVEL, RIVAL_RATE, RIVAL_SCALE = range(10)
LEVEL_AT_ZERO, FITTED_RATE, RIVAL_MARGIN = 10, 11, 12
RECORD = 13


@device
def weigh_candidates(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    seeds: FloatArray,
    sigma_floor: float,
    fixed: float,
    bank: FloatArray,
    first: FloatArray,
    record: FloatArray,
) -> int:
    """Fill ``bank`` with candidates and ``first`` with their scores; returns how many.

    ``seeds`` (k, 2) are curves (level, rate) to propose beside those through pairs.
    """
    n = t.size
    level = np.empty(PROPOSED + seeds.shape[0])
    rate = np.empty(PROPOSED + seeds.shape[0])
    for k in range(seeds.shape[0]):
        level[k] = seeds[k, 0]
        rate[k] = seeds[k, 1]
    count = propose_curves(t, y, level, rate, seeds.shape[0])
    picks = np.empty(MOST, np.int64)
    octave = np.empty(MOST, np.int64)
    made = 0
    if count > 0 and n > 3:
        made = shortlist(t, y, level, rate, count, _PER_OCTAVE, _LEAST_EVIDENCE, picks, octave)
    residual = np.empty(n)
    for q in range(made):
        h = picks[q]
        fill_residuals(t, y, level[h], rate[h], residual)
        start(t, residual, root_weight, 0.0, 0.0, 2.0 ** -octave[q], sigma_floor, fixed, bank[q])
        bank[q, AMPLITUDE] = level[h]
        bank[q, RATE] = rate[h]
        first[q] = criterion(bank[q], n, 0)
    for keep, steps in ((_FIRST_ROUND, 2), (_SECOND_ROUND, 4)):
        order = np.argsort(-first[:made])
        for rank in range(min(keep, made)):
            q = order[rank]
            first[q] = refine_curve(t, y, root_weight, 2, sigma_floor, fixed, False, steps, bank[q])
        record[EVALUATIONS] += min(keep, made) * steps * n
    record[WEIGHED] = made
    record[EVALUATIONS] += count * n
    return made


@device
def same_curve(one: FloatArray, other: FloatArray, reach: float) -> bool:
    """Whether two candidates differ by less than ``reach`` all over the frame."""
    for k in range(9):
        at = -1.0 + 0.25 * k
        a = one[AMPLITUDE] * bounded_exp(one[RATE] * at)
        b = other[AMPLITUDE] * bounded_exp(other[RATE] * at)
        if abs(a - b) > reach:
            return False
    return True


@device
def find_curve(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    seeds: FloatArray,
    sigma_floor: float,
    fixed: float,
    bank: FloatArray,
    scores: FloatArray,
    record: FloatArray,
) -> int:
    """Weigh proposals on a part of the readings and rank finalists on all; the row of the best, or -1."""
    n = t.size
    part = np.empty(min(n, PROPOSE_FROM), np.int64)
    thin(n, PROPOSE_FROM, part)
    thin_t, thin_y, thin_root = t[part], y[part], root_weight[part]
    first = np.full(MOST, IMPOSSIBLE)
    made = weigh_candidates(thin_t, thin_y, thin_root, seeds, sigma_floor, fixed, bank, first, record)
    order = np.argsort(-first[:made])
    heard = 0
    variant = np.empty(SLOTS)
    for rank in range(made):
        q = order[rank]
        if heard == FINALISTS or first[q] <= IMPOSSIBLE:
            break
        known = False
        for f in range(heard):
            other = bank[MOST + f]
            ratio = bank[q, SIGMA] / other[SIGMA]
            near = same_curve(bank[q], other, 0.5 * (bank[q, SIGMA] + other[SIGMA]))
            known = known or (near and 0.5 < ratio < 2.0)
        if known:
            continue
        row = MOST + heard
        heard += 1
        strong = 1 if bank[q, ABOVE] > bank[q, BELOW] else -1
        for sides in (0, strong, 2):
            variant[:] = bank[q]
            start_sides(variant, sides)
            score = refine_curve(
                thin_t, thin_y, thin_root, sides, sigma_floor, fixed, True, _REFINED, variant
            )
            record[EVALUATIONS] += _REFINED * thin_t.size
            if sides == 0 or score > scores[row]:
                bank[row] = variant
                scores[row] = score
    final = np.argsort(-scores[MOST : MOST + heard])
    best = -1
    for rank in range(heard):
        row = MOST + final[rank]
        if rank < _LAST_ROUND and scores[row] > IMPOSSIBLE:
            one, two = bank[row, ABOVE] > 0.0, bank[row, BELOW] > 0.0
            sides = 2 if one and two else (1 if one else (-1 if two else 0))
            scores[row] = refine_curve(
                t, y, root_weight, sides, sigma_floor, fixed, True, _LAST_STEPS, bank[row]
            )
            record[EVALUATIONS] += _LAST_STEPS * n
            if scores[row] > IMPOSSIBLE and (best < 0 or scores[row] > scores[best]):
                best = row
        else:
            scores[row] = IMPOSSIBLE
    return best


@device
def find_rival(bank: FloatArray, scores: FloatArray, best: int, record: FloatArray) -> None:
    """Record the best finalist that is another curve than the best's."""
    second = -1
    for row in range(MOST, ROWS):
        if scores[row] > IMPOSSIBLE and row != best:
            reach = 2.0 * max(bank[row, SIGMA], bank[best, SIGMA])
            if not same_curve(bank[row], bank[best], reach) and (second < 0 or scores[row] > scores[second]):
                second = row
    if second >= 0:
        record[RIVAL] = 1.0
        record[RIVAL_LEVEL] = bank[second, AMPLITUDE]
        record[RIVAL_RATE] = bank[second, RATE]
        record[RIVAL_SCALE] = bank[second, SIGMA]
        record[RIVAL_MARGIN] = scores[best] - scores[second]


_f8 = types.float64
_out = types.Array(_f8, 1, "C")


@kernel(types.void(ro(_f8), ro(_f8), ro(_f8), ro(_f8, 2), _f8, _f8, _out, _out, _out, _out, _out))
def fit_additive(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    seeds: FloatArray,
    sigma_floor: float,
    given_sigma: float,
    tau: FloatArray,
    z: FloatArray,
    root: FloatArray,
    weight: FloatArray,
    record: FloatArray,
) -> None:
    """Fit ``y = A exp(b t)`` to values of about unit range at times in [-1, 1].

    ``tau``, ``z``, ``root`` receive the weighted line that stands for the curve, ``weight`` the tabulated
    weight function, ``record`` the rest.
    """
    n = t.size
    record[:] = 0.0
    index = np.empty(min(n, WEIGH_ON), np.int64)
    thin(n, WEIGH_ON, index)
    bank = np.zeros((ROWS, SLOTS))
    scores = np.full(ROWS, IMPOSSIBLE)
    part_t, part_y, part_root = t[index], y[index], root_weight[index]
    best = find_curve(part_t, part_y, part_root, seeds, sigma_floor, given_sigma, bank, scores, record)
    if best < 0:
        return
    find_rival(bank, scores, best, record)
    chosen = bank[best]
    record[SCORE] = scores[best]
    acquit_curve(part_t, part_y, part_root, sigma_floor, given_sigma, chosen)
    follow = np.empty(2 * TABLE + 1)
    fill_tables(chosen, part_t.size, weight, follow)
    s = chosen[SIGMA]
    for _ in range(_NEWTON_STEPS):
        if newton_curve(t, y, root_weight, s, weight, chosen, tau, z, root) < 1e-12:
            break
    anchor = linearise(t, y, root_weight, chosen[RATE], tau, z, root)
    level = chosen[AMPLITUDE] * bounded_exp(chosen[RATE] * anchor)
    record[FOUND] = 1.0
    record[TAU_ZERO] = anchor
    record[LEVEL_AT_ZERO] = level
    record[FITTED_RATE] = chosen[RATE]
    record[SCALE] = s
