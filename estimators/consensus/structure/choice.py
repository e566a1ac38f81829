"""From candidates to the one structure that leaves the series cheapest to describe."""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.structure.acquittal import ALONE_STEPS, acquit, forbid_contamination, start_alone
from estimators.consensus.structure.candidates import (
    CANDIDATES,
    EVALUATIONS,
    among,
    find_candidates,
    patience,
)
from estimators.consensus.structure.criterion import IMPOSSIBLE, criterion, distance
from estimators.consensus.structure.em import em_step
from estimators.consensus.structure.mixture import (
    ABOVE,
    BELOW,
    INLIERS,
    LEVEL,
    SIGMA,
    SIZE,
    SLOPE,
    start_sides,
)
from estimators.kernels import device

FINALISTS = 5
"""Different lines that are weighed in earnest: the best, and the one with most inliers."""
BANK = CANDIDATES + FINALISTS
"""Rows of a bank: candidates, then the finalists' best variants."""

_LEAST_HEARD = 2
"""The best line and a rival are heard even where the rival is hopeless: it may be worth a mention."""
_FIRST_STEPS = 3
_LAST_STEPS = 3
_LAST_ROUND = 3
"""Finalists that are fitted to the whole series."""
_APART = 2.0
"""Scales by which a runner-up must differ from the best line."""


@device
def find_structure(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    thin_t: FloatArray,
    thin_y: FloatArray,
    thin_root: FloatArray,
    sigma_floor: float,
    fixed: float,
    bank: FloatArray,
    scores: FloatArray,
    sides_of: IntArray,
    counts: IntArray,
) -> int:
    """Weigh lines proposed on the thinned series and rank the finalists on the whole.

    Values have a unit range; ``fixed`` is a given noise scale, or 0. Fills rows of ``bank`` (BANK, SIZE) with
    finalists, their ``scores`` and ``sides_of``, and ``counts``; returns the row of the best, or -1 when no
    line stands out.
    """
    first = np.full(CANDIDATES, IMPOSSIBLE)
    made = find_candidates(thin_t, thin_y, thin_root, sigma_floor, fixed, bank, first, counts)
    finalists = np.empty(FINALISTS, np.int64)
    heard = _choose_finalists(bank, first, made, patience(thin_t.size), finalists)
    variant = np.empty(SIZE)
    for f in range(heard):
        row = CANDIDATES + f
        strong = 1 if bank[finalists[f], ABOVE] > bank[finalists[f], BELOW] else -1
        for sides in (0, strong, 2):
            # Errors to both sides are so dear that only the first needs to be asked.
            if sides == 2 and f > 0:
                break
            variant[:] = bank[finalists[f]]
            start_sides(variant, sides)
            score = _refine(
                thin_t, thin_y, thin_root, sides, sigma_floor, fixed, _FIRST_STEPS, variant, counts
            )
            if sides == 0 or score > scores[row]:
                bank[row] = variant
                scores[row] = score
                sides_of[row] = sides
    order = np.argsort(-scores[CANDIDATES : CANDIDATES + heard])
    best = -1
    for rank in range(heard):
        row = CANDIDATES + order[rank]
        if rank < _LAST_ROUND and scores[row] > IMPOSSIBLE:
            scores[row] = _refine(
                t, y, root_weight, sides_of[row], sigma_floor, fixed, _LAST_STEPS, bank[row], counts
            )
            if scores[row] > IMPOSSIBLE and (best < 0 or scores[row] > scores[best]):
                best = row
        else:
            scores[row] = IMPOSSIBLE
    if best >= 0:
        _acquit_line(t, y, root_weight, sigma_floor, fixed, bank[best])
    return best


@device
def _acquit_line(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    sigma_floor: float,
    fixed: float,
    params: FloatArray,
) -> None:
    """Replace the best structure by plain least squares if contamination explains the series hardly better.

    The least squares are those of normal noise alone, correlated or not.
    """
    n = t.size
    square = 0.0
    for i in range(n):
        r = (y[i] - params[LEVEL] - params[SLOPE] * t[i]) * root_weight[i]
        square += r * r
    alone = params.copy()
    start_alone(alone, fixed if fixed > 0.0 else max(sigma_floor, np.sqrt(square / n)))
    for _ in range(ALONE_STEPS):
        forbid_contamination(alone)
        em_step(t, y, root_weight, 0, sigma_floor, fixed, True, alone)
    acquit(params, alone, 2, n)


@device
def find_second(bank: FloatArray, scores: FloatArray, best: int) -> int:
    """Row of the best finalist whose line is another one than the best's; -1 if there is none."""
    second = -1
    for row in range(CANDIDATES, BANK):
        reach = _APART * max(bank[row, SIGMA], bank[best, SIGMA])
        is_another = scores[row] > IMPOSSIBLE and distance(bank[row], bank[best]) > reach
        if is_another and (second < 0 or scores[row] > scores[second]):
            second = row
    return second


@device
def _refine(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    sides: int,
    sigma_floor: float,
    fixed: float,
    steps: int,
    params: FloatArray,
    counts: IntArray,
) -> float:
    """Take steps of EM, the correlation of neighbours included; returns the criterion."""
    for _ in range(steps):
        em_step(t, y, root_weight, sides, sigma_floor, fixed, True, params)
    counts[EVALUATIONS] += steps * t.size
    return criterion(params, t.size, sides)


@device
def _choose_finalists(
    bank: FloatArray, first: FloatArray, made: int, hopeless: float, finalists: IntArray
) -> int:
    """Fill ``finalists`` with the best different lines, and the one with most inliers; returns how many."""
    order = np.argsort(-first[:made])
    heard = 0
    broadest = -1
    for rank in range(made):
        q = order[rank]
        if first[q] <= IMPOSSIBLE or (heard >= _LEAST_HEARD and first[q] < first[order[0]] - hopeless):
            break
        if heard < FINALISTS - 1 and not among(bank, q, finalists, heard):
            finalists[heard] = q
            heard += 1
        if broadest < 0 or bank[q, INLIERS] > bank[broadest, INLIERS]:
            broadest = q
    if broadest >= 0 and not among(bank, broadest, finalists, heard):
        finalists[heard] = broadest
        heard += 1
    return heard
