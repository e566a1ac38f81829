r"""How far off the smoothed positions may be, beyond what the smoother thinks.

The smoother takes its labels and its parameters for true. Two things it leaves out are added:

- *Slow errors*. What a long average makes of coloured noise depends on its correlation time, which is not
  known; no position is called better than that noise, with a margin.
- *Doubt*. Faults that come and go several times a minute are no faults among good fixes, but the noise of the
  place: then the fixes that pass for good err by as much as those that were called faulty, and what was
  corrected is part of the uncertainty (METHODS_TRACKS, "A composition that works on synthetic tracks",
  steps 5 and 6).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.trajectories.labelling.modes import BURST, ENTRY, LEVEL_STRIDE, REDRAW
from estimators.trajectories.smoothing.solved import Solved

BURSTS = (ENTRY, BURST, REDRAW)
_LEAST_M2 = 1e-4
_SLOW = 1.5
"""Margin on the variance of coloured noise."""
_RESTLESS_PER_MINUTE, _NOISE_PER_MINUTE = 1.5, 3.0
"""Beginnings of bursts up to the first are faults, from the second on they are noise."""
_SHORTEST_S = 60.0
HALF_S = 60.0
"""Half of the window over which corrections are averaged."""
_TYPICAL = 2.0
"""Share of the typical squared correction that good fixes are off by."""


@dataclass(frozen=True, slots=True)
class Doubt:
    """What is added to variances because corrections may be wrong.

    Attributes
    ----------
    share : float
        How sure it is, from 0 to 1, that what was labelled as bursts is noise.
    typical_m2 : float
        Median squared correction of fixes in bursts, per axis.
    """

    share: float
    typical_m2: float


def share_of_doubt(duration_s: float, beginnings: int) -> float:
    """How sure it is, from 0 to 1, that what was labelled as bursts is noise."""
    rate = beginnings / (max(duration_s, _SHORTEST_S) / 60.0)
    share = (rate - _RESTLESS_PER_MINUTE) / (_NOISE_PER_MINUTE - _RESTLESS_PER_MINUTE)
    return float(np.clip(share, 0.0, 1.0))


def corrections(fixes: FloatArray, solved: Solved) -> FloatArray:
    """Squared corrections of fixes in bursts, per axis, shape (m,); 0 elsewhere."""
    off = fixes - solved.states[:, :, 0]
    bursting = np.isin(solved.labels % LEVEL_STRIDE, BURSTS)
    return np.where(bursting, 0.5 * np.sum(off * off, axis=1), 0.0)


def position_variance(
    t: FloatArray, fixes: FloatArray, solved: Solved, colour_m: float, doubt: Doubt
) -> FloatArray:
    """Variance of the smoothed positions per axis.

    Parameters
    ----------
    t : ndarray, shape (m,)
        With the rows of :data:`HALF_S` before and after those of which the variance is wanted.
    fixes : ndarray, shape (m, 2)
    solved : Solved
    colour_m : float
        Standard deviation of coloured noise.
    doubt : Doubt

    Returns
    -------
    ndarray, shape (m,)
    """
    variance = np.maximum(solved.covariances[:, 0, 0], max(_SLOW * colour_m**2, _LEAST_M2))
    if doubt.share == 0.0:
        return variance
    squared = corrections(fixes, solved)
    first, stop = np.searchsorted(t, t - HALF_S), np.searchsorted(t, t + HALF_S, side="right")
    summed = np.concatenate([[0.0], np.cumsum(squared)])
    nearby = (summed[stop] - summed[first]) / (stop - first)
    return np.asarray(variance + doubt.share * (_TYPICAL * doubt.typical_m2 + nearby))
