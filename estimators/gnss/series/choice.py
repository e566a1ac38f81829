"""Standing or moving, open sky or streets: decided by the data where the caller leaves it open."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from estimators.gnss.options import PositionOptions
from estimators.gnss.series.observed import Observations
from estimators.gnss.series.snapshots import Snapshots, score_at
from estimators.gnss.series.static import Climbed

Motion = Literal["static", "moving", "independent"]
Surroundings = Literal["open", "city"]

_STILL_M = 3.0
"""A receiver that stayed this close to one place stood, as far as pseudoranges can tell."""
_PRICE = 6.0
"""Log likelihood by which an epoch must gain from a position of its own: e^2 for each coordinate."""
_CITY_RESIDUAL_M = 3.0
"""Ranges under an open sky, corrections applied, disagree by .3 to 1 m; reflected ones by more."""
_LEAN = 3.0
"""Standard deviations by which large residuals must rather be positive: reflections lengthen."""
_LARGE = 2.0
_LEAST_LARGE = 20


def choose_motion(
    observations: Observations,
    snapshots: Snapshots,
    places: list[Climbed],
    options: PositionOptions,
    window_s: float,
) -> tuple[Motion, str]:
    """Standing or moving.

    Compared are one position for all epochs and one for each, by the likelihood of the ranges, each epoch's
    own position paid for; a receiver whose fixes stay within a few metres stands in any case, since errors of
    the atmosphere wander as far.

    Parameters
    ----------
    observations : Observations
    snapshots : Snapshots
        Some epochs, solved each on its own.
    places : list of Climbed
        Positions that these epochs can share, the likeliest first.
    options : PositionOptions
    window_s : float
        Epochs farther apart than this say nothing of one another's positions if the receiver moves.
    """
    if len(observations) < 2:
        return "independent", "There is one epoch."
    if not places:
        return "independent", "No single epoch gives a position to start from."
    best, scale = places[0], snapshots.scale
    chosen = np.flatnonzero(snapshots.reliable)
    if chosen.size < max(3, snapshots.epochs.size // 5):
        chosen = np.arange(snapshots.epochs.size)
    off = np.linalg.norm(snapshots.position_m[chosen] - best.position_m, axis=1)
    spread = float(np.percentile(off, 75.0))
    if spread <= _STILL_M:
        return "static", f"Three of four fixes of single epochs lie within {spread:.1f} m of one place."
    # Each side at the noise that it sees itself; the larger of the two forgives the atmosphere.
    own = score_at(snapshots.table, snapshots.position_m, max(scale, 0.1), options.fault_prior)
    shared = score_at(snapshots.table, best.position_m, best.scale, options.fault_prior)
    gain = float((own.likelihood - shared.likelihood).sum()) / max(snapshots.epochs.size, 1)
    if gain < _PRICE:
        return "static", (
            f"One place explains the ranges as well as one for each epoch (gain {gain:.1f} per epoch, "
            f"{_PRICE:g} would be needed)."
        )
    apart = float(np.median(np.diff(observations.seconds)))
    if apart > 0.5 * window_s:
        return "independent", (
            f"The receiver moves, and epochs {apart:g} s apart say little of one another's positions."
        )
    return "moving", (
        f"Fixes of single epochs lie {spread:.0f} m around, and a place for each explains the ranges better "
        f"(gain {gain:.0f} per epoch)."
    )


def choose_surroundings(snapshots: Snapshots, options: PositionOptions) -> tuple[Surroundings, str]:
    """Open sky or streets, by how large residuals are and to which side they lean.

    Parameters
    ----------
    snapshots : Snapshots
        Some epochs, solved each on its own.
    options : PositionOptions
    """
    scores = score_at(snapshots.table, snapshots.position_m, max(snapshots.scale, 0.1), options.fault_prior)
    residual = scores.residual_m
    if residual.size < _LEAST_LARGE:
        return "open", "There are too few ranges to tell; an open sky is assumed."
    typical = float(np.median(np.abs(residual)))
    large = residual[np.abs(residual) > _LARGE * typical]
    lean = float(np.sign(large).sum()) / math.sqrt(max(large.size, 1))
    if typical > _CITY_RESIDUAL_M and large.size >= _LEAST_LARGE and lean > _LEAN:
        return "city", (
            f"Ranges disagree by {typical:.1f} m, and those that disagree most are too long: reflections."
        )
    if typical > _CITY_RESIDUAL_M:
        return "open", f"Ranges disagree by {typical:.1f} m, as often too short as too long."
    return "open", f"Ranges disagree by no more than {typical:.1f} m, faults apart."
