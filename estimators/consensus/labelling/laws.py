"""The laws that residuals may follow: of inliers, near normal or heavy-tailed, and of what contaminates them.

Residuals are counted in cells of half a noise scale on either side of the model. The background is a step
function that does not fall away from the model, its steps told by EM (Dempster, Laird & Rubin 1977); the
innermost, where inliers hide it, reaches as far as they do. Laws of the inliers compete by likelihood.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import ndtr, stdtr

from estimators.arrays import FloatArray
from estimators.kernels import device

REACH = 8  # scales that are looked at; farther out the background is taken as level
CELLS = 2 * REACH  # of half a scale, in which residuals are counted
FINE = 8  # entries of the table of posteriors per scale
TABLE = REACH * FINE
NEAR = 6  # cell from which a residual is far: 3 scales
_STEP_1, _STEP_2 = 7, 10  # cells at which the background may rise: 3.5 and 5 scales
_CORE = 4  # cells from which the share of inliers is guessed
_EM_STEPS = 8
_PSEUDO = 1.0  # readings of the average background that the innermost step starts from
_LEAST_BACKGROUND = 0.5  # readings over the range

_STUDENT = ((2.0, 0.7), (2.0, 1.0), (2.0, 1.4), (4.0, 1.0))
"""Degrees of freedom and scale, in noise scales, of the laws that compete with the normal law."""
_STUDENT_PRIOR = 0.5
_LAWS = 1 + len(_STUDENT)


def _normal_density(u: FloatArray) -> FloatArray:
    return np.asarray(np.exp(-0.5 * u * u) / math.sqrt(2.0 * math.pi))


def _student_density(u: FloatArray, dof: float) -> FloatArray:
    log_height = math.lgamma(0.5 * (dof + 1.0)) - math.lgamma(0.5 * dof) - 0.5 * math.log(dof * math.pi)
    return np.asarray(math.exp(log_height) * (1.0 + u * u / dof) ** (-0.5 * (dof + 1.0)))


_EDGES = np.arange(CELLS + 1) / 2.0
_GRID = np.arange(TABLE + 1) / FINE
_MASS = np.array([np.diff(ndtr(_EDGES)), *(np.diff(stdtr(dof, _EDGES / scale)) for dof, scale in _STUDENT)])
"""Probability of each cell on one side, shape (laws, cells)."""
_DENSITY = np.array(
    [_normal_density(_GRID), *(_student_density(_GRID / scale, dof) / scale for dof, scale in _STUDENT)]
)
"""Density on the grid of the table, shape (laws, TABLE + 1)."""


@device
def tabulate(counts: FloatArray, total: float, reach: float, table: FloatArray) -> tuple[float, float]:
    """Average the posteriors under each law of the inliers, weighted by prior and likelihood.

    Parameters
    ----------
    counts : ndarray of float64, shape (2, CELLS + 1)
        Residuals per side and cell; the last cell holds all beyond.
    total, reach : float
        Number and range of the residuals.
    table : ndarray of float64, shape (2, TABLE + 1)
        Receives the posterior per side and distance.

    Returns
    -------
    tuple of float
        Log-likelihood of the counts, averaged over the laws, and the number of inliers under the likeliest.
    """
    far = 0.0
    for side in range(2):
        for k in range(NEAR, CELLS):
            far += counts[side, k]
    # Where no residual is in the tails, the laws differ on nothing that is asked.
    laws = _LAWS if far > 0.0 else 1
    steps = np.empty((2, 3))
    table[:] = 0.0
    best = -np.inf
    weight_sum = 0.0
    followers = 1.0
    for law in range(laws):
        inliers, likelihood = _fit_background(counts, total, reach, _MASS[law], steps)
        if laws > 1:
            prior = 1.0 - _STUDENT_PRIOR if law == 0 else _STUDENT_PRIOR / (_LAWS - 1)
            likelihood += math.log(prior)
        if likelihood > best:
            # What was gathered so far was measured against the last best law.
            shrink = math.exp(best - likelihood) if weight_sum > 0.0 else 0.0
            weight_sum *= shrink
            table *= shrink
            best = likelihood
            followers = inliers
        weight = math.exp(likelihood - best)
        weight_sum += weight
        for side in range(2):
            for k in range(TABLE + 1):
                cell = min(2 * k // FINE, CELLS - 1)
                step = 0 if cell < _STEP_1 else (1 if cell < _STEP_2 else 2)
                inside = inliers * _DENSITY[law, k]
                table[side, k] += weight * inside / (inside + 2.0 * steps[side, step])
    table /= weight_sum
    table[0, 0] = table[1, 0] = min(table[0, 0], table[1, 0])
    for side in range(2):
        # Averages of falling functions fall; rounding must not say otherwise, nor that one is certain.
        table[side, 0] = min(table[side, 0], 1.0 - 1e-12)
        for k in range(TABLE):
            table[side, k + 1] = min(table[side, k + 1], table[side, k])
    return best + math.log(weight_sum), followers


@device
def _fit_background(
    counts: FloatArray, total: float, reach: float, mass: FloatArray, steps: FloatArray
) -> tuple[float, float]:
    """EM for the number of inliers and the background per cell; returns that number and the likelihood.

    ``steps``, shape (2, 3), receives the background of either side on its three steps.
    """
    least = _LEAST_BACKGROUND / (2.0 * reach)
    core = 0.0
    expected = 0.0
    inside = 0.0
    for k in range(CELLS):
        inside += 2.0 * mass[k]
        if k < _CORE:
            core += counts[0, k] + counts[1, k]
            expected += 2.0 * mass[k]
    tail = max(1.0 - inside, 0.0)
    beyond = counts[0, CELLS] + counts[1, CELLS]
    inliers = max(min(0.98 * total, core / expected), 0.5)
    steps[:] = max(total - inliers, _LEAST_BACKGROUND) / (2.0 * reach)
    gathered = np.empty(3)
    for _ in range(_EM_STEPS):
        found = 0.0
        for side in range(2):
            gathered[:] = 0.0
            for k in range(CELLS):
                step = 0 if k < _STEP_1 else (1 if k < _STEP_2 else 2)
                share = steps[side, step] / (inliers * mass[k] + steps[side, step])
                gathered[step] += counts[side, k] * share
                found += counts[side, k] * (1.0 - share)
            # The average is that of the step before: it moves slowly, and either side sees the same.
            average = max(total - inliers, _LEAST_BACKGROUND) / (2.0 * reach)
            _rising_steps(gathered, average, least, steps[side])
        inliers = max(found + min(beyond, inliers * tail), 0.5)
    likelihood = 0.0
    for side in range(2):
        for k in range(CELLS):
            if counts[side, k] > 0.0:
                step = 0 if k < _STEP_1 else (1 if k < _STEP_2 else 2)
                likelihood += counts[side, k] * math.log((inliers * mass[k] + steps[side, step]) / total)
    if beyond > 0.0:
        rest = inliers * tail + max(beyond - inliers * tail, 2.0 * least)
        likelihood += beyond * math.log(rest / total)
    return inliers, likelihood


@device
def _rising_steps(gathered: FloatArray, average: float, least: float, steps: FloatArray) -> None:
    """Background per cell on three steps that do not fall: neighbours that would are pooled."""
    cells_0, cells_1, cells_2 = 1.0 * _STEP_1, 1.0 * (_STEP_2 - _STEP_1), 1.0 * (CELLS - _STEP_2)
    # So many readings at the average rate take _PSEUDO / average cells.
    first = (gathered[0] + _PSEUDO) / (cells_0 + _PSEUDO / average)
    second = gathered[1] / cells_1
    third = gathered[2] / cells_2
    if second > third:
        second = third = (gathered[1] + gathered[2]) / (cells_1 + cells_2)
        if first > second:
            first = second = third = (first * cells_0 + second * (cells_1 + cells_2)) / CELLS
    elif first > second:
        first = second = (first * cells_0 + second * cells_1) / (cells_0 + cells_1)
        if first > third:
            first = second = third = (first * (cells_0 + cells_1) + third * cells_2) / CELLS
    steps[0] = max(first, least)
    steps[1] = max(second, least)
    steps[2] = max(third, least)
