"""The periods of a series, found in the data: peaks of a robust periodogram that chance does not explain.

The series is freed of its trend by an MM-estimate and residuals are drawn in to a few noise scales, so that
neither outliers nor a season that is taken for noise decide. A peak counts if it stands out of the spectrum
around it, which is what tells a season from the slow wandering of correlated noise, and if it pays for its
coefficients (Schwarz 1978). Peaks that fit day, week or year are taken for those.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.found import LinearData, Scale
from estimators.consensus.search.mm import MMSearch
from estimators.noise.mad import MAD_FACTOR
from estimators.options import RobustOptions
from estimators.regression.least_squares import least_squares
from estimators.regression.periodogram import periodogram
from estimators.result import NoFit
from estimators.series import Series
from estimators.trends.bases.design import Design, Season
from estimators.trends.bases.harmonics import FIRST, coefficients_allowed, harmonics_allowed
from estimators.trends.bases.settings import CALENDAR

MOST_FOUND = 3
LEAST_CYCLES = 4.0
"""Cycles in the series from which a period that is none of the calendar's can be found: fewer are as easily
wandering noise."""
LEAST_CALENDAR_CYCLES = 2.0

_CALENDAR = tuple(CALENDAR[name] for name in ("year", "week", "day"))
_OVERSAMPLED = 5.0
_MOST_POINTS = 4000
_MOST_FREQUENCIES = 20000
_CHANCE = 1e-3
"""Chance of a period in noise."""
_DRAWN_IN, _LEFT_OUT = 1.0, 2.5
"""Noise scales to which residuals are drawn in, and beyond which they are left out: tightly, since a season
not yet fitted is part of the scale (``benchmarks.shapes``)."""
_NEIGHBOURHOOD = 1.6
"""Ratio of frequencies around a peak that its background is taken from."""
_LEAST_NEIGHBOURS = 8.0
_REFINEMENTS, _ZOOMS = 41, 2
_RESOLVED = 1.5
"""Difference of two frequencies, in turns over the span, below which one is the shadow of the other."""
_POLISHED_WITHIN, _POLISHINGS, _POLISHING_STEPS = 0.1, 5, 11
"""Turns over the span within which a period is polished, and how finely."""
_LEAST_POINTS = 12


def find_periods(design: Design, series: Series, own: Mapping[str, FloatArray]) -> tuple[float, ...]:
    """Find the periods of a series.

    Parameters
    ----------
    design : Design
        Without seasons.
    series : Series
    own : mapping of str to ndarray
        The caller's own columns at the usable points.

    Returns
    -------
    tuple of float
        In the internal unit of time, the longest first; empty where there is none.
    """
    t = series.t
    span = float(t[-1] - t[0])
    if series.n < _LEAST_POINTS or span <= 0.0:
        return ()
    calendar = _CALENDAR if series.axis.kind == "datetime" else ()
    found: list[float] = []
    while len(found) < MOST_FOUND:
        seasons = _seasons(t, found)
        if seasons is None:
            return tuple(found[:-1])
        residual = _robust_residual(design.with_seasons(seasons), series, own)
        period = None if residual is None else _strongest(t, residual, series.weights, calendar)
        if period is None:
            break
        merged = _merge(found, period, span)
        if merged == found:
            break
        found = merged
        if period not in calendar:
            found = _polish(design, series, own, found, found.index(period))
    return tuple(found)


def _seasons(t: FloatArray, periods: list[float]) -> tuple[Season, ...] | None:
    """Seasons of these periods, for detrending; None where the points cannot carry them."""
    shape = tuple(periods)
    seasons = tuple(
        Season(period, min(FIRST, harmonics_allowed(t, shape, index))) for index, period in enumerate(shape)
    )
    carried = 2 * sum(season.harmonics for season in seasons) + 2
    return seasons if carried <= coefficients_allowed(t.size) else None


def _merge(found: list[float], period: float, span: float) -> list[float]:
    """Add a period, the longest first; one that is a multiple of an earlier one takes its place."""
    for place, earlier in enumerate(found):
        if abs(1.0 / period - 1.0 / earlier) * span < _RESOLVED:
            return found
        for multiple in range(1, 5):
            if abs(period / (multiple * earlier) - 1.0) < 0.02:
                return (
                    sorted([*found[:place], period, *found[place + 1 :]], reverse=True)
                    if multiple > 1
                    else found
                )
            if abs(earlier / (multiple * period) - 1.0) < 0.02:
                return found
    return sorted([*found, period], reverse=True)


def _polish(
    design: Design, series: Series, own: Mapping[str, FloatArray], found: list[float], index: int
) -> list[float]:
    """Fit a period together with the trend and the other seasons: by least squares on what is no outlier."""
    t = series.t
    seasons = _seasons(t, found)
    if seasons is None:
        return found
    residual = _robust_residual(design.with_seasons(seasons), series, own)
    if residual is None:
        return found
    weights = np.where(np.isfinite(residual), 1.0 if series.weights is None else series.weights, 0.0)

    def square(frequency: float) -> float:
        varied = dataclasses.replace(seasons[index], period=1.0 / frequency)
        trial = design.with_seasons((*seasons[:index], varied, *seasons[index + 1 :]))
        off = least_squares(trial.columns(t, own or None), series.y, weights)[1]
        return float(np.sum(weights * off * off))

    center, reach = 1.0 / found[index], _POLISHED_WITHIN / float(t[-1] - t[0])
    for _ in range(_POLISHINGS):
        trials = center + reach * np.linspace(-1.0, 1.0, _POLISHING_STEPS)
        center = float(trials[int(np.argmin([square(frequency) for frequency in trials.tolist()]))])
        reach /= 0.4 * (_POLISHING_STEPS - 1)
    return [*found[:index], 1.0 / center, *found[index + 1 :]]


def _robust_residual(design: Design, series: Series, own: Mapping[str, FloatArray]) -> FloatArray | None:
    """Take what an MM-estimate leaves, drawn in to a few noise scales; NaN for gross outliers."""
    data = LinearData(
        design.columns(series.t, own or None), series.y, design.frame.apply(series.t), series.weights
    )
    floor = max(float(np.max(np.abs(series.y))) * 1e-14, 1e-300)
    fit = MMSearch().run(data, Scale(None, "", None, "", floor), RobustOptions(), 0)
    if isinstance(fit, NoFit):
        return None
    middle = float(np.median(fit.residual))
    off = fit.residual - middle
    scale = MAD_FACTOR * float(np.median(np.abs(off)))
    if scale <= 0.0:
        return None
    return np.where(
        np.abs(off) > _LEFT_OUT * scale, np.nan, np.clip(off, -_DRAWN_IN * scale, _DRAWN_IN * scale)
    )


def _strongest(
    t: FloatArray, residual: FloatArray, weights: FloatArray | None, calendar: tuple[float, ...]
) -> float | None:
    """Period of the strongest peak that chance does not explain."""
    span = float(t[-1] - t[0])
    kept = np.isfinite(residual)
    n = int(np.count_nonzero(kept))
    precision = np.ones(n) if weights is None else weights[kept]
    at, value, weight = _averages(t[kept], residual[kept], precision, max(1, math.ceil(n / _MOST_POINTS)))
    steps = np.diff(at)
    typical = float(np.median(steps[steps > 0.0]))
    step = 1.0 / (_OVERSAMPLED * span)
    first = LEAST_CALENDAR_CYCLES / span
    count = int(min((0.5 / typical - first) / step, _MOST_FREQUENCIES))
    if count < _LEAST_NEIGHBOURS:
        return None
    power = periodogram(at, value, weight, first, step, count)
    frequency = first + step * np.arange(count)
    for known in calendar:
        # A period of the calendar needs no search, and two cycles of it.
        place = round((1.0 / known - first) / step)
        if -1 <= place < count and _stands_out(power, min(max(place, 0), count - 1), len(calendar), n):
            near = power[max(place - 2, 0) : place + 3]
            if near.max() >= 0.5 * float(power.max()):
                return known
    own = np.where(frequency * span >= LEAST_CYCLES, power, 0.0)
    best = int(np.argmax(own))
    looked_at = count / _OVERSAMPLED
    if not _stands_out(power, best, looked_at, n):
        return None
    center, reach = float(frequency[best]), step
    for _ in range(_ZOOMS):
        finer = 2.0 * reach / (_REFINEMENTS - 1)
        near = periodogram(at, value, weight, center - reach, finer, _REFINEMENTS)
        center, reach = center - reach + finer * int(np.argmax(near)), finer
    return 1.0 / center


def _stands_out(power: FloatArray, place: int, looked_at: float, n: int) -> bool:
    """Whether a peak is beyond chance against the spectrum around it, and pays for its coefficients.

    In noise, whatever its colour, the power at a frequency over its mean is exponential; the mean is taken
    from the median of the neighbourhood.
    """
    peak = float(power[max(place - 2, 0) : place + 3].max())
    count = power.size
    order = np.arange(count) + _OVERSAMPLED * LEAST_CALENDAR_CYCLES
    here = float(order[place])
    reach = max(here * (_NEIGHBOURHOOD - 1.0), _LEAST_NEIGHBOURS * _OVERSAMPLED)
    near = (np.abs(order - here) <= reach) & (np.abs(order - here) > _OVERSAMPLED)
    if np.count_nonzero(near) < _LEAST_NEIGHBOURS:
        return False
    background = float(np.median(power[near])) / math.log(2.0)
    gain = -0.5 * n * math.log(max(1.0 - peak, 1e-300))
    return peak > background * math.log(looked_at / _CHANCE) and gain > math.log(n) + math.log(
        max(looked_at, 1.0)
    )


def _averages(
    t: FloatArray, value: FloatArray, weight: FloatArray, size: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Means of ``size`` neighbours each, where there are too many points for every frequency."""
    if size == 1:
        return t, value, weight
    starts = np.arange(0, t.size, size)
    total = np.add.reduceat(weight, starts)
    return np.add.reduceat(weight * t, starts) / total, np.add.reduceat(weight * value, starts) / total, total
