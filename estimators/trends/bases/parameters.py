"""What people ask of a trend of columns: slope, intercept, curvature, amplitude and peak of each season.

Each is a linear combination of the coefficients, or, for amplitude and peak, is taken for one near the
estimate (delta method).
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.inference.columns import ColumnUncertainty
from estimators.inference.intervals import student_quantile
from estimators.result import Estimate
from estimators.trends.bases.curve import weighted_sum
from estimators.trends.bases.design import (
    Design,
    polynomial_columns,
    polynomial_powers,
    season_columns,
    season_slopes,
)

_PHASES = 1440
_NEWTON_STEPS = 6


def polynomial_directions(design: Design, intercept_at: float, constant: str) -> dict[str, FloatArray]:
    """Find the combinations of coefficients that are the parameters of the trend without its seasons.

    Parameters
    ----------
    design : Design
    intercept_at : float
        Internal time at which the intercept is taken.
    constant : str
        Name of the parameter of degree 0.

    Returns
    -------
    dict of str to ndarray of float64, shape (p,)
    """
    degree, half = design.degree, design.frame.half
    found: dict[str, FloatArray] = {}
    k = np.arange(degree + 1)
    if degree > 0:
        # P_k(1) - P_k(-1) is 2 for odd k and 0 for even k; P_k'(1) = k (k + 1) / 2.
        found["slope"] = _padded(design, np.where(k % 2 == 1, 1.0, 0.0) / half)
    if degree > 1:
        found["slope_end"] = _padded(design, 0.5 * k * (k + 1.0) / half)
        powers = polynomial_powers(degree)
        for power in range(2, degree + 1):
            found[f"power_{power}"] = _padded(design, powers[:, power] / half**power)
    at = design.frame.apply(np.array([intercept_at]))
    constant_direction = _padded(design, polynomial_columns(at, degree)[:, 0])
    for index, column in enumerate(design.own):
        row = design.own_column(index)
        constant_direction[row] = -column.mean / column.size
    found[constant] = constant_direction
    for index, column in enumerate(design.own):
        direction = np.zeros(design.size)
        direction[design.own_column(index)] = 1.0 / column.size
        found[column.name] = direction
    return found


def parameters_of(
    design: Design,
    theta: FloatArray,
    uncertainty: ColumnUncertainty | None,
    intercept_at: float,
    constant: str,
    level: float,
) -> dict[str, Estimate]:
    """Parameters with intervals.

    Parameters
    ----------
    design : Design
    theta : ndarray of float64, shape (p,)
    uncertainty : ColumnUncertainty or None
    intercept_at : float
        Internal time at which the intercept is taken.
    constant : str
        Name of the parameter of degree 0.
    level : float
        Confidence level.

    Returns
    -------
    dict of str to Estimate
        Names as in :data:`estimators.trends.models.MODELS`; amplitude is half of a season from trough to
        peak, its peak the time after ``intercept_at`` at which it is first at its highest.
    """
    directions = polynomial_directions(design, intercept_at, constant)
    found = {name: _estimate(theta, uncertainty, row, level) for name, row in directions.items()}
    for index in range(len(design.seasons)):
        amplitude, peak = _season(design, theta, uncertainty, index, intercept_at, level)
        found[f"season_{index + 1}_amplitude"] = amplitude
        found[f"season_{index + 1}_peak"] = peak
    return found


def _season(
    design: Design,
    theta: FloatArray,
    uncertainty: ColumnUncertainty | None,
    index: int,
    intercept_at: float,
    level: float,
) -> tuple[Estimate, Estimate]:
    season, part = design.seasons[index], design.season(index)
    coefficients = theta[part]
    highest = _extreme(coefficients, season.harmonics)
    lowest = _extreme(-coefficients, season.harmonics)
    phases = np.array([highest, lowest])
    at_peak, at_trough = season_columns(phases, season.harmonics).T
    swing = np.zeros(design.size)
    swing[part] = 0.5 * (at_peak - at_trough)
    amplitude = _estimate(theta, uncertainty, swing, level)
    # The slope of the season is 0 at its peak; its error there, by the curvature, moves the peak.
    bend = -float(np.sum(_bends(phases[:1], season.harmonics)[:, 0] * coefficients))
    move = np.zeros(design.size)
    if bend > 0.0:
        move[part] = season_slopes(phases, season.harmonics)[:, 0] / bend
    per_radian = season.period / (2.0 * math.pi)
    start = float(design.phase(np.array([intercept_at]), season)[0])
    value = (highest - start) % (2.0 * math.pi) * per_radian
    if uncertainty is None or bend <= 0.0:
        return amplitude, Estimate(value, None, None, None)
    stderr = float(uncertainty.stderr(move[np.newaxis])[0]) * per_radian
    half = student_quantile(level, uncertainty.dof) * stderr
    return amplitude, Estimate(value, stderr, value - half, value + half)


def _extreme(coefficients: FloatArray, harmonics: int) -> float:
    """Phase at which a season is highest: the best of a grid, then Newton's method."""
    grid = np.linspace(0.0, 2.0 * math.pi, _PHASES, endpoint=False)
    values = weighted_sum(season_columns(grid, harmonics), coefficients)
    phase = float(grid[int(np.argmax(values))])
    for _ in range(_NEWTON_STEPS):
        here = np.array([phase])
        slope = float(np.sum(coefficients * season_slopes(here, harmonics)[:, 0]))
        bend = float(np.sum(coefficients * _bends(here, harmonics)[:, 0]))
        if not bend < 0.0 or abs(slope / bend) > 2.0 * math.pi / _PHASES:
            break
        phase -= slope / bend
    return phase


def _bends(phase: FloatArray, harmonics: int) -> FloatArray:
    """Second derivatives of the columns of a season by the phase."""
    squares = np.repeat(np.arange(1, harmonics + 1) ** 2.0, 2)
    return np.asarray(-squares[:, np.newaxis] * season_columns(phase, harmonics))


def _padded(design: Design, polynomial: FloatArray) -> FloatArray:
    direction = np.zeros(design.size)
    direction[design.polynomial] = polynomial
    return direction


def _estimate(
    theta: FloatArray, uncertainty: ColumnUncertainty | None, direction: FloatArray, level: float
) -> Estimate:
    value = float(np.sum(theta * direction))
    if uncertainty is None:
        return Estimate(value, None, None, None)
    stderr = float(uncertainty.stderr(direction[np.newaxis])[0])
    half = student_quantile(level, uncertainty.dof) * stderr
    return Estimate(value, stderr, value - half, value + half)
