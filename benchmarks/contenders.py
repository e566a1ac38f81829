"""Who competes, behind one face: ``contender.fit(t, y) -> Answer``. Plumbline's own entries stand here.

A contender that raises gives no line, which counts as a failure. The peers are in
:mod:`benchmarks.peers`, so that Plumbline alone can be measured where they are not installed.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from estimators import fit_trend
from estimators.arrays import BoolArray, FloatArray
from estimators.trends.trend import Trend

KNOWN_THRESHOLD = 2.7
"""What a user who knows the noise would give, in sigma: 99.3 % of a normal population."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What a contender says about a series.

    Attributes
    ----------
    ends : ndarray of float64, shape (2,)
        The line at the first and last time; NaN if there is none.
    flagged : ndarray of bool, shape (n,)
        Points called outliers.
    low, high : float
        95 % interval of the slope, NaN where none is given.
    p_value : float
        Of "the slope is zero", NaN where none is given.
    """

    ends: FloatArray
    flagged: BoolArray
    low: float = float("nan")
    high: float = float("nan")
    p_value: float = float("nan")


Fit = Callable[[FloatArray, FloatArray, float | None], Answer]
"""``fit(t, y, threshold)``; t ascending."""


@dataclass(frozen=True, slots=True)
class Contender:
    """A method as it appears in the tables.

    Attributes
    ----------
    name : str
    knows_threshold : bool
        Whether it is told the noise: 2.7 sigma as threshold.
    raw : callable
        ``raw(t, y, threshold)``.
    """

    name: str
    knows_threshold: bool
    raw: Fit

    def fit(self, t: FloatArray, y: FloatArray, sigma: float = 1.0) -> Answer:
        """Answer for a series whose noise has scale ``sigma``."""
        threshold = KNOWN_THRESHOLD * sigma if self.knows_threshold else None
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            try:
                return self.raw(t, y, threshold)
            except (ValueError, ArithmeticError, np.linalg.LinAlgError):
                return no_line(t.size)


def no_line(n: int) -> Answer:
    """Answer of a contender that gives up."""
    return Answer(np.full(2, np.nan), np.zeros(n, dtype=bool))


def fit_plumbline(method: str, t: FloatArray, y: FloatArray, threshold: float | None) -> Answer:
    """Answer of Plumbline's method of this name."""
    trend = fit_trend(t, y, method=method, threshold=threshold)
    if not isinstance(trend, Trend):
        return no_line(t.size)
    slope, line = trend.parameters["slope"], trend.geometry
    return Answer(
        ends=line.value(np.array(line.span)),
        flagged=~trend.points.inlier,
        low=np.nan if slope.low is None else slope.low,
        high=np.nan if slope.high is None else slope.high,
        p_value=np.nan if trend.p_value is None else trend.p_value,
    )


OURS: tuple[Contender, ...] = (
    Contender("Plumbline auto", False, partial(fit_plumbline, "auto")),
    Contender("Plumbline msac", True, partial(fit_plumbline, "msac")),
)
AUTO, MSAC = OURS
