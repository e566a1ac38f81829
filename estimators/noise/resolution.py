"""The least noise scale that values can show: their floating-point resolution and their quantisation.

A scale below it would make thresholds of zero out of tied values, and outliers out of rounding errors
(METHODS.md 13.5).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray

TIED_SHARE = 0.1
"""More tied values than this make a series quantised (METHODS_TRENDS, "Frame")."""

_SAMPLE = 4096  # values looked at: enough to see ties in a tenth of them
_ULPS = 4.0  # rounding of y, of the product and of the two sums in y - (a + b t)
_ON_GRID = 1e-3  # of a quantum; values off any grid come this near to one in 0.2 % of the cases
_EXPLAINED = 0.9  # share of values on the grid; the rest may be outliers from another source


@dataclass(frozen=True, slots=True)
class Quantisation:
    """How coarse the values are.

    Attributes
    ----------
    tied_share : float
        Share of values that occur more than once at different times.
    quantum : float
        Step of the grid on which the values stand; 0 if none is seen.
    """

    tied_share: float
    quantum: float

    @property
    def is_quantised(self) -> bool:
        """Whether there is a grid and enough ties to tell it from chance."""
        return self.quantum > 0 and self.tied_share > TIED_SHARE


def find_quantisation(y: FloatArray, t: FloatArray | None = None) -> Quantisation:
    """Share of tied values, and the quantum: the smallest gap between tied values that explains the others.

    At most 4,096 values, evenly spread over the series, are looked at.

    Parameters
    ----------
    y : ndarray of float64, shape (n,)
    t : ndarray of float64, shape (n,), optional
        Times, ascending, equal values within equal times adjacent. A reading recorded twice (same time,
        same value) is then one reading, not a tie.

    Returns
    -------
    Quantisation

    Examples
    --------
    >>> import numpy as np
    >>> temperature = np.round(np.random.default_rng(0).normal(20.0, 1.0, 300), 1)
    >>> round(find_quantisation(temperature).quantum, 6)
    0.1
    """
    if y.size > _SAMPLE:
        sample = (np.arange(_SAMPLE) * y.size) // _SAMPLE
        y = y[sample]
        t = None if t is None else t[sample]
    ordered = np.sort(y)
    if 2 * np.count_nonzero(ordered[1:] == ordered[:-1]) <= TIED_SHARE * y.size:
        # The usual case: too few ties for a grid, however they fall.
        return Quantisation(0.0, 0.0)
    if t is not None:
        fresh = np.ones(y.size, dtype=np.bool_)
        fresh[1:] = (t[1:] != t[:-1]) | (y[1:] != y[:-1])
        y = y[fresh]
    levels, counts = np.unique(y, return_counts=True)
    tied = levels[counts > 1]
    tied_share = float(counts[counts > 1].sum()) / max(y.size, 1)
    if tied.size < 2:
        return Quantisation(tied_share, 0.0)
    return Quantisation(tied_share, _grid_step(tied, levels, counts))


def _grid_step(
    tied: FloatArray, levels: FloatArray, counts: np.ndarray[tuple[int], np.dtype[np.int64]]
) -> float:
    resolution = float(np.spacing(np.abs(levels).max()))
    gaps = np.diff(tied)
    gaps = gaps[gaps > 8 * resolution]
    if not gaps.size:
        return 0.0
    step = float(gaps.min())
    # A single gap carries the rounding of two values; the whole span carries the same over many steps.
    span = float(tied[-1] - tied[0])
    step = span / max(round(span / step), 1)
    offset = (levels - tied[0]) / step
    on_grid = np.abs(offset - np.round(offset)) <= _ON_GRID + 8 * resolution / step
    explained = float(counts[on_grid].sum()) / float(counts.sum())
    return step if explained >= _EXPLAINED else 0.0


def scale_floor(y: FloatArray, quantisation: Quantisation | None = None) -> float:
    """Smallest noise scale that is believed, never 0.

    The largest of 4 ulp of |y|, 2.2e-16 times the range of y, and quantum / sqrt(12), the standard deviation
    of rounding to the quantum, where the values are quantised (METHODS.md 13.5). |y| and range are those of
    the central eight tenths (of at most 4,096 values): a fill value of 1e36 says nothing about the others.

    Parameters
    ----------
    y : ndarray of float64, shape (n,)
    quantisation : Quantisation, optional
        From :func:`find_quantisation`; without it quantisation sets no floor.

    Returns
    -------
    float
        In units of y; the smallest normal number where all values are 0.

    Examples
    --------
    >>> import numpy as np
    >>> scale_floor(np.array([1.0, 2.0, 3.0])) < 1e-14
    True
    """
    tiny = float(np.finfo(np.float64).tiny)
    if not y.size:
        return tiny
    sample = y if y.size <= _SAMPLE else y[(np.arange(_SAMPLE) * y.size) // _SAMPLE]
    ordered = np.sort(sample)
    tenth = ordered.size // 10
    low, high = float(ordered[tenth]), float(ordered[-1 - tenth])
    largest = max(abs(low), abs(high))
    floor = max(_ULPS * float(np.spacing(largest)), float(np.finfo(np.float64).eps) * (high - low), tiny)
    if quantisation is not None and quantisation.is_quantised:
        floor = max(floor, quantisation.quantum / math.sqrt(12.0))
    return floor
