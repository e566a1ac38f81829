"""What may follow at a fix: the branches of one hypothesis and their scores.

The functions append to ``scores`` and ``kinds`` from a count on and return the new count. Distances are
squared: ``off`` from the fix foretold, ``off_place`` from the place foretold, without its bias.
"""

from __future__ import annotations

import math

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import arithmetic
from estimators.trajectories.labelling.modes import (
    ADRIFT,
    BURST,
    DRAWN_AWAY,
    ENTRY,
    EXIT,
    HURRIED,
    LEVEL_FACTOR,
    LEVEL_STRIDE,
    LEVELS,
    NOMINAL,
    REDRAW,
    RESTLESS,
    SPIKE,
    SWERVED,
    TELEPORT,
    THROWN,
    WIDE,
    WIDE_FACTOR,
    exit_rate,
    log_anywhere,
    log_normal,
    return_rate,
)
from estimators.trajectories.labelling.priors import (
    CALMS,
    ENTERS,
    GOOD_FIX,
    HURRIES,
    KEEPS_HURRYING,
    NEW_OFFSET,
    OTHER_LEVEL,
    SAME_LEVEL,
    SAME_OFFSET,
    SETTLES,
    SPIKED,
    STAYS,
    STRAYS,
    SWERVES,
    TELEPORTED,
    WIDENED,
)

BRANCHES = LEVELS + 8
"""The most of one hypothesis."""


@arithmetic
def branch_nominal(
    mode: int, weight: float, base: float, variance: float, away: float, off: float, off_place: float,
    core: float, reach: float, prior: FloatArray, scores: FloatArray, kinds: IntArray, count: int,
) -> int:  # fmt: skip
    """Append what may follow outside of bursts; ``away`` is the variance of a step after a swerve."""
    stays = weight + prior[STAYS]
    usual = log_normal(off, base + variance)
    elsewhere = log_anywhere(off_place, core, reach)
    aside = prior[GOOD_FIX] + log_normal(off, base + away + variance)
    spike = stays + prior[SPIKED]
    if mode == RESTLESS:
        scores[count] = stays + prior[KEEPS_HURRYING] + prior[GOOD_FIX] + usual
        kinds[count] = NOMINAL + LEVEL_STRIDE * HURRIED
        scores[count + 1] = stays + prior[CALMS] + prior[GOOD_FIX] + usual
        kinds[count + 1] = NOMINAL
        count += 2
    else:
        noise = variance
        for other in range(LEVELS):
            change = prior[SAME_LEVEL] if other == mode else prior[OTHER_LEVEL]
            scores[count] = stays + change + prior[GOOD_FIX] + log_normal(off, base + noise)
            kinds[count] = NOMINAL + LEVEL_STRIDE * other
            count += 1
            noise *= LEVEL_FACTOR
        noise = variance * LEVEL_FACTOR**mode
        scores[count] = (
            stays + prior[SAME_LEVEL] + prior[WIDENED] + log_normal(off, base + WIDE_FACTOR * noise)
        )
        kinds[count] = WIDE + LEVEL_STRIDE * mode
        scores[count + 1] = stays + prior[HURRIES] + prior[GOOD_FIX] + usual
        kinds[count + 1] = NOMINAL + LEVEL_STRIDE * HURRIED
        scores[count + 2] = stays + prior[SWERVES] + aside
        kinds[count + 2] = TELEPORT + LEVEL_STRIDE * SWERVED
        scores[count + 3] = stays + prior[TELEPORTED] + elsewhere
        kinds[count + 3] = TELEPORT
        count += 4
    scores[count] = spike + log_anywhere(off, core, reach)
    kinds[count] = SPIKE + LEVEL_STRIDE * mode
    scores[count + 1] = weight + prior[ENTERS] + prior[GOOD_FIX] + elsewhere
    kinds[count + 1] = ENTRY
    scores[count + 2] = weight + prior[STRAYS] + aside
    kinds[count + 2] = ADRIFT + LEVEL_STRIDE * DRAWN_AWAY
    scores[count + 3] = weight + prior[STRAYS] + prior[GOOD_FIX] + elsewhere
    kinds[count + 3] = ADRIFT + LEVEL_STRIDE * THROWN
    return count + 4


@arithmetic
def branch_burst(
    age: float, dt: float, weight: float, base: float, place: float, variance: float, off: float,
    off_place: float, core: float, reach: float, prior: FloatArray, scores: FloatArray, kinds: IntArray,
    count: int,
) -> int:  # fmt: skip
    """Append what may follow within a burst."""
    lasts = -exit_rate(age) * dt
    ends = math.log(-math.expm1(lasts))
    stays = weight + lasts + prior[SAME_OFFSET]
    scores[count] = stays + prior[GOOD_FIX] + log_normal(off, base + variance)
    kinds[count] = BURST
    scores[count + 1] = stays + prior[SPIKED] + log_anywhere(off, core, reach)
    kinds[count + 1] = SPIKE
    elsewhere = log_anywhere(off_place, core, reach)
    scores[count + 2] = weight + lasts + prior[NEW_OFFSET] + prior[GOOD_FIX] + elsewhere
    kinds[count + 2] = REDRAW
    scores[count + 3] = weight + ends + prior[GOOD_FIX] + log_normal(off_place, place + variance)
    kinds[count + 3] = EXIT
    return count + 4


@arithmetic
def branch_astray(
    age: float, dt: float, weight: float, path: float, place: float, variance: float, off_path: float,
    off_place: float, core: float, reach: float, prior: FloatArray, scores: FloatArray, kinds: IntArray,
    count: int,
) -> int:  # fmt: skip
    """Append what may follow on a path of its own, of variance ``path``."""
    lasts = -return_rate(age, dt) * dt
    ends = math.log(-math.expm1(lasts))
    scores[count] = weight + lasts + prior[GOOD_FIX] + log_normal(off_path, path + variance)
    kinds[count] = ADRIFT
    scores[count + 1] = weight + lasts + prior[SPIKED] + log_anywhere(off_path, core, reach)
    kinds[count + 1] = SPIKE
    scores[count + 2] = weight + ends + prior[GOOD_FIX] + log_normal(off_place, place + variance)
    kinds[count + 2] = EXIT
    scores[count + 3] = (
        weight + lasts + prior[SETTLES] + prior[GOOD_FIX] + log_normal(off_path, path + variance)
    )
    kinds[count + 3] = ENTRY
    return count + 4
