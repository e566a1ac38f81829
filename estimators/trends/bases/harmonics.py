"""How many harmonics a season is fitted with: as many as its sampling allows and the data support."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.regression.least_squares import least_squares
from estimators.trends.bases.design import Design, Season
from estimators.trends.bases.settings import MOST_HARMONICS

FIRST = 2
"""Harmonics that a season starts with: most seasons are lopsided."""

MOST_COEFFICIENTS = 24
_POINTS_PER_COEFFICIENT = 5.0
_APART = 1.0
"""Least distance of two frequencies, in turns over the span, at which the data tell them apart."""


def harmonics_allowed(t: FloatArray, periods: tuple[float, ...], index: int) -> int:
    """Harmonics of a period that the sampling resolves and that no shorter period stands for.

    Parameters
    ----------
    t : ndarray of float64, shape (n,)
        Ascending.
    periods : tuple of float
        The longest first.
    index : int
        Of the period asked about.

    Returns
    -------
    int
        At least 1.

    Examples
    --------
    >>> harmonics_allowed(np.arange(120.0), (12.0,), 0), harmonics_allowed(np.arange(120.0), (12.0, 4.0), 0)
    (5, 2)
    """
    period, span = periods[index], float(t[-1] - t[0])
    steps = np.diff(t)
    typical = float(np.median(steps[steps > 0.0]))
    # A harmonic of half the sampling rate has one coefficient only.
    allowed = min(MOST_HARMONICS, math.ceil(period / (2.0 * typical) * (1.0 - 1e-9)) - 1)
    for other in periods[index + 1 :]:
        for k in range(1, allowed + 1):
            if abs(k / period - 1.0 / other) * span < _APART:
                allowed = k - 1
                break
    return max(allowed, 1)


def first_seasons(
    t: FloatArray, periods: tuple[float, ...], harmonics: int | None, chosen: bool
) -> tuple[Season, ...]:
    """Seasons to begin with: of the harmonics asked for, or of two where the sampling allows them."""
    wanted = FIRST if harmonics is None else harmonics
    return tuple(
        Season(period, min(wanted, harmonics_allowed(t, periods, index)), chosen)
        for index, period in enumerate(periods)
    )


def more_harmonics(
    design: Design, t: FloatArray, columns: FloatArray, y: FloatArray, weights: FloatArray, worth: float
) -> Design:
    """Add harmonics while the inliers support them by the criterion of Schwarz (1978).

    Parameters
    ----------
    design : Design
    t, y : ndarray of float64, shape (n,)
        Internal times, values.
    columns : ndarray of float64, shape (p, n)
        Of the design.
    weights : ndarray of float64, shape (n,)
        Of a robust fit: 0 for outliers.
    worth : float
        Independent inliers.

    Returns
    -------
    Design
        The same one where nothing is gained.
    """
    periods = tuple(season.period for season in design.seasons)
    square = _weighted_square(columns, y, weights)
    for index in range(len(periods)):
        allowed = harmonics_allowed(t, periods, index)
        while design.seasons[index].harmonics < allowed and design.size + 2 <= coefficients_allowed(y.size):
            season = design.seasons[index]
            longer = dataclasses.replace(season, harmonics=season.harmonics + 1)
            seasons = (*design.seasons[:index], longer, *design.seasons[index + 1 :])
            trial = design.with_seasons(seasons)
            tried = _weighted_square(trial.columns(t), y, weights)
            if tried <= 0.0 or worth * math.log(square / tried) <= 2.0 * math.log(worth):
                break
            design, square = trial, tried
    return design


def sharpest(design: Design, t: FloatArray) -> Design:
    """Give all seasons as many harmonics as sampling and number of points allow."""
    periods = tuple(season.period for season in design.seasons)
    for index in range(len(periods)):
        spare = (coefficients_allowed(t.size) - design.size) // 2
        season = design.seasons[index]
        most = min(harmonics_allowed(t, periods, index), season.harmonics + max(spare, 0))
        longer = dataclasses.replace(season, harmonics=max(most, season.harmonics))
        design = design.with_seasons((*design.seasons[:index], longer, *design.seasons[index + 1 :]))
    return design


def coefficients_allowed(n: int) -> int:
    """Coefficients that so many points can carry."""
    return int(min(MOST_COEFFICIENTS, n / _POINTS_PER_COEFFICIENT))


def _weighted_square(columns: FloatArray, y: FloatArray, weights: FloatArray) -> float:
    _, residual, _ = least_squares(columns, y, weights)
    return float(np.sum(weights * residual * residual))
