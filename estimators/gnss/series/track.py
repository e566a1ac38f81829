"""Where the windows of a moving receiver start: smoothed fixes of single epochs, and clocks that fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.series.clocks import FREE_CLOCK, SMOOTH_CLOCK, by_system, is_smooth, jumps_of
from estimators.gnss.series.observed import Observations
from estimators.gnss.series.snapshots import START_SCALE, Snapshots, score_at, solvable

_SPACING_S = 1.0
"""A receiver that moves is started from an epoch per second; those between lie between."""
_HALF_WIDTH = 2


@dataclass(frozen=True, slots=True)
class Track:
    """Starting values for every epoch of a series.

    Attributes
    ----------
    position_m : ndarray, shape (epochs, 3)
    clock_m : ndarray, shape (epochs,)
        Of the first system, without jumps.
    offset_m : ndarray, shape (systems - 1,)
        Of the further systems' clocks.
    jumps_m : ndarray, shape (epochs,)
        Whole milliseconds by which the clock was set.
    row_jumps_m : ndarray, shape (rows,)
    clock_noise : tuple of float
        Densities of clock and drift.
    """

    position_m: FloatArray
    clock_m: FloatArray
    offset_m: FloatArray
    jumps_m: FloatArray
    row_jumps_m: FloatArray
    clock_noise: tuple[float, float]


def epochs_to_start(observations: Observations) -> IntArray:
    """Epochs that are to be solved on their own: at most one a second."""
    kept, last = [], -np.inf
    for k in solvable(observations):
        if observations.seconds[k] >= last + _SPACING_S - 1e-6:
            kept.append(k)
            last = observations.seconds[k]
    return np.array(kept, dtype=np.int64)


def lay_track(observations: Observations, snapshots: Snapshots, fault_prior: float) -> Track:
    """Derive starting values from the snapshots of :func:`epochs_to_start`.

    Parameters
    ----------
    observations : Observations
    snapshots : Snapshots
        At least one.
    fault_prior : float
    """
    position = _smoothed(observations.seconds, snapshots)
    clocks = by_system(observations, score_at(observations.table, position, START_SCALE, fault_prior).clock_m)
    offsets = np.zeros(clocks.shape[1])
    for j in range(1, clocks.shape[1]):
        both = clocks[:, j] - clocks[:, 0]
        offsets[j] = np.median(both[np.isfinite(both)]) if np.isfinite(both).any() else 0.0
    level = clocks - offsets
    # The first system that was received speaks for the epoch.
    first = np.argmax(np.isfinite(level), axis=1)
    clock = level[np.arange(len(observations)), first]
    jumps = jumps_of(clock)
    smooth = is_smooth(observations.seconds, clock - jumps)
    known = np.isfinite(clock)
    filled = np.interp(observations.seconds, observations.seconds[known], (clock - jumps)[known])
    return Track(
        position_m=position,
        clock_m=filled,
        offset_m=offsets[1:],
        jumps_m=jumps,
        row_jumps_m=np.repeat(jumps, np.diff(observations.table.offsets)),
        clock_noise=SMOOTH_CLOCK if smooth else FREE_CLOCK,
    )


def _smoothed(seconds: FloatArray, snapshots: Snapshots) -> FloatArray:
    """Run medians over the fixes that are reliable, or of all where too few are; lines between them."""
    reliable = np.flatnonzero(snapshots.reliable)
    chosen = (
        reliable if reliable.size >= max(3, snapshots.epochs.size // 4) else np.arange(snapshots.epochs.size)
    )
    places, at = snapshots.position_m[chosen], seconds[snapshots.epochs[chosen]]
    near = [
        np.median(places[max(0, k - _HALF_WIDTH) : k + _HALF_WIDTH + 1], axis=0) for k in range(chosen.size)
    ]
    middle = np.array(near)
    return np.ascontiguousarray(
        np.stack([np.interp(seconds, at, middle[:, axis]) for axis in range(3)], axis=1)
    )
