"""The bed: random series with a known line, a known share of outliers and a known set of inliers.

The noise of an inlier has sigma = 1, the line climbs or falls up to 40 sigma over the range, and the times
are irregular with one long gap. What contaminates it is one of :data:`KINDS` or :data:`FAMILIES`.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from benchmarks.families import FAMILIES, STEP_SHARE
from benchmarks.kinds import KINDS, SIGMA, SPAN, Kind
from estimators.arrays import BoolArray, FloatArray

RISE = 40.0
"""Largest change of the trend over the span, in sigma."""

ALL_KINDS: MappingProxyType[str, Kind] = MappingProxyType({**KINDS, **FAMILIES})


@dataclass(frozen=True, slots=True)
class Draw:
    """One random series and the truth about it.

    Attributes
    ----------
    t, y : ndarray of float64, shape (n,)
        Times ascending from 0 to :data:`SPAN`, and values.
    truth_slope, truth_intercept : float
        The line: ``truth_intercept + truth_slope * t``.
    inlier_mask : ndarray of bool, shape (n,)
        True for every point that was not contaminated.
    sigma : float
        Scale of an inlier's noise.
    """

    t: FloatArray
    y: FloatArray
    truth_slope: float
    truth_intercept: float
    inlier_mask: BoolArray
    sigma: float


def make_series(kind: str, n: int, share: float, rng: np.random.Generator) -> Draw:
    """Draw one series.

    Parameters
    ----------
    kind : str
        A key of :data:`KINDS` or :data:`FAMILIES`.
    n : int
        Number of points, at least 3.
    share : float
        Share of outliers; ``round(share * n)`` points are contaminated. For ``step`` they come on top of
        the points before the step.
    rng : numpy.random.Generator

    Returns
    -------
    Draw

    Examples
    --------
    >>> draw = make_series("uniform", 50, 0.4, np.random.default_rng(7))
    >>> int(draw.inlier_mask.sum())
    30
    """
    slope = rng.uniform(-RISE, RISE) / SPAN
    intercept = rng.uniform(-RISE, RISE)
    made = ALL_KINDS[kind](n, round(share * n), rng)
    y = intercept + slope * made.t + made.offset
    return Draw(
        t=made.t,
        y=np.round(y / made.quantum) * made.quantum if made.quantum > 0 else y,
        truth_slope=float(slope),
        truth_intercept=float(intercept),
        inlier_mask=made.inlier,
        sigma=SIGMA,
    )


def true_inliers(kind: str, n: int, share: float) -> int:
    """Inliers that a draw has; for ``step``, whose uniform outliers fall on both branches, about as many."""
    branch = n - round(STEP_SHARE * n) if kind == "step" else n
    return branch - round(share * branch)


def draw_rng(seed: int, kind: str, n: int, share: float, index: int) -> np.random.Generator:
    """Return the generator of one draw: a pure function of the cell and the index, whatever else is drawn."""
    return np.random.default_rng([seed, zlib.crc32(kind.encode()), n, round(1000 * share), index])


__all__ = ["ALL_KINDS", "FAMILIES", "KINDS", "Draw", "draw_rng", "make_series", "true_inliers"]
