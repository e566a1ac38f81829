"""What each kind of fix is worth before it is seen, as logarithms.

Every mode carries the same prior per sample, or bursts would become absorbing at high rates.
"""

from __future__ import annotations

import math

from estimators.arrays import FloatArray
from estimators.kernels import arithmetic
from estimators.trajectories.labelling.modes import ADRIFT, LEVELS, SPIKE

(
    R_SPIKE, R_WIDE, R_ENTRY, R_REDRAW, R_TELEPORT, R_LEVEL, R_WALK, R_GROWTH, R_STRAY, R_SWERVE, R_HURRY,
    R_CALM, R_SETTLE,
) = range(13)  # fmt: skip
"""Places in the array of rates; see :class:`estimators.trajectories.parameters.Rates`."""

(
    GOOD_FIX, SPIKED, WIDENED, TELEPORTED, STAYS, ENTERS, SAME_LEVEL, OTHER_LEVEL, SAME_OFFSET, NEW_OFFSET,
    STRAYS, SWERVES, HURRIES, KEEPS_HURRYING, CALMS, SETTLES,
) = range(16)  # fmt: skip
"""Places in the array of priors; see :func:`fill_prior`."""
PRIORS = 16
_ASTRAY_AT_FIRST = 0.02
"""Probability that a track begins with a fault that lasts."""


@arithmetic
def fill_prior(dt: float, rates: FloatArray, prior: FloatArray) -> None:
    """Logarithms of priors for fixes a step apart."""
    enter = -math.expm1(-rates[R_ENTRY] * dt)
    redraw = -math.expm1(-rates[R_REDRAW] * dt)
    shift = -math.expm1(-rates[R_LEVEL] * dt)
    prior[GOOD_FIX] = math.log1p(-rates[R_SPIKE] - rates[R_WIDE] - rates[R_TELEPORT])
    prior[SPIKED] = math.log(rates[R_SPIKE])
    prior[WIDENED] = math.log(rates[R_WIDE])
    prior[TELEPORTED] = math.log(rates[R_TELEPORT])
    prior[STAYS] = math.log1p(-enter)
    prior[ENTERS] = math.log(enter)
    prior[STRAYS] = math.log(rates[R_STRAY] * enter)
    prior[SWERVES] = math.log(-math.expm1(-rates[R_SWERVE] * dt))
    prior[HURRIES] = math.log(-math.expm1(-rates[R_HURRY] * dt))
    prior[KEEPS_HURRYING] = -rates[R_CALM] * dt
    prior[CALMS] = math.log(-math.expm1(-rates[R_CALM] * dt))
    prior[SETTLES] = math.log(-math.expm1(-rates[R_SETTLE] * dt))
    prior[SAME_LEVEL] = math.log1p(-shift)
    prior[OTHER_LEVEL] = math.log(shift / (LEVELS - 1))
    prior[SAME_OFFSET] = math.log1p(-redraw)
    prior[NEW_OFFSET] = math.log(redraw)


@arithmetic
def log_first(kind: int, rates: FloatArray) -> float:
    """Ln prior of what the first fix is."""
    if kind == ADRIFT:
        return math.log(_ASTRAY_AT_FIRST)
    if kind == SPIKE:
        return math.log(rates[R_SPIKE])
    return math.log1p(-rates[R_SPIKE] - rates[R_WIDE] - rates[R_TELEPORT])
