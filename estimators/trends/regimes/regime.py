"""A regime: a stretch of the series that follows a line of its own."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from estimators.result import Estimate


@dataclass(frozen=True, slots=True)
class Regime:
    """A stretch of the series and the straight line that it follows.

    Attributes
    ----------
    start, end : float or int or numpy.datetime64
        Its first and last time, in the caller's form.
    n : int
        Usable points in it.
    inliers : int
        Of them on its line.
    slope : Estimate or None
        Per unit of time (per second for points in time); None where no line can be drawn.
    level : Estimate or None
        Of the line at ``end``.
    """

    start: float | int | np.datetime64
    end: float | int | np.datetime64
    n: int
    inliers: int
    slope: Estimate | None
    level: Estimate | None

    def in_value_units(self, unit: float) -> Regime:
        """Turn the regime of ``y / unit`` into that of ``y``."""
        slope = None if self.slope is None else self.slope.scaled(unit)
        level = None if self.level is None else self.level.scaled(unit)
        return dataclasses.replace(self, slope=slope, level=level)
