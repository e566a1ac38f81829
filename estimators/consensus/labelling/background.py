"""What contaminates the residuals: a step function that does not fall away from the model, told by EM.

The innermost step, where inliers hide it, reaches as far as they do (Dempster, Laird & Rubin 1977 for EM).
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.labelling.cells import CELLS, EDGES, REACH, SLOTS, octave_width
from estimators.kernels import device

STEPS = 3
_STEP_1, _STEP_2 = 7, 10  # cells at which the background may rise: 3.5 and 5 scales
_CORE = 4  # cells from which the share of inliers is guessed
_EM_STEPS = 8
_PSEUDO = 1.0  # readings of the average background that the innermost step starts from
_LEAST = 0.5  # readings over the range


@device
def step_of(cell: int) -> int:
    """Step of the background that a cell near the model lies on."""
    return 0 if cell < _STEP_1 else (1 if cell < _STEP_2 else 2)


@device
def fit_background(
    counts: FloatArray, total: float, beyond: float, reach: float, mass: FloatArray, steps: FloatArray
) -> tuple[float, float, float]:
    """EM for the number of inliers of a given law and the background per cell.

    Parameters
    ----------
    counts : ndarray of float64, shape (2, SLOTS)
        Residuals per side and cell.
    total, beyond : float
        Their number, and that of those beyond REACH.
    reach : float
        Their range, in scales.
    mass : ndarray of float64, shape (SLOTS,)
        Probability of each cell of a side under the law.
    steps : ndarray of float64, shape (2, STEPS)
        Receives the background per cell of half a scale, of either side on its steps.

    Returns
    -------
    tuple of float
        Number of inliers, how many of them the law puts beyond REACH, and log-likelihood of the counts, all
        beyond REACH taken as one.
    """
    least = _LEAST / (2.0 * reach)
    core = 0.0
    expected = 0.0
    inside = 0.0
    for k in range(CELLS):
        inside += 2.0 * mass[k]
        if k < _CORE:
            core += counts[0, k] + counts[1, k]
            expected += 2.0 * mass[k]
    tail = max(1.0 - inside, 0.0)
    inliers = max(min(0.98 * total, core / expected), 0.5)
    steps[:] = max(total - inliers, _LEAST) / (2.0 * reach)
    gathered = np.empty(STEPS)
    for _ in range(_EM_STEPS):
        found = 0.0
        for side in range(2):
            gathered[:] = 0.0
            for k in range(CELLS):
                step = step_of(k)
                share = steps[side, step] / (inliers * mass[k] + steps[side, step])
                gathered[step] += counts[side, k] * share
                found += counts[side, k] * (1.0 - share)
            # The average is that of the step before: it moves slowly, and either side sees the same.
            average = max(total - inliers, _LEAST) / (2.0 * reach)
            _rising_steps(gathered, average, least, steps[side])
        inliers = max(found + min(beyond, inliers * tail), 0.5)
    likelihood = 0.0
    for side in range(2):
        for k in range(CELLS):
            if counts[side, k] > 0.0:
                step = step_of(k)
                likelihood += counts[side, k] * math.log((inliers * mass[k] + steps[side, step]) / total)
    if beyond > 0.0:
        rest = inliers * tail + max(beyond - inliers * tail, 2.0 * least)
        likelihood += beyond * math.log(rest / total)
    return inliers, inliers * tail, likelihood


@device
def far_likelihood(
    counts: FloatArray,
    beyond: float,
    reach: float,
    farthest: float,
    mass: FloatArray,
    inliers: float,
    tail: float,
) -> float:
    """Log-likelihood of how the residuals beyond REACH lie there, a level background and the law's tail.

    Parameters
    ----------
    counts : ndarray of float64, shape (2, SLOTS)
    beyond, reach, farthest : float
        Number of residuals beyond REACH, range and largest distance of all.
    mass : ndarray of float64, shape (SLOTS,)
    inliers, tail : float
        From :func:`fit_background`.

    Returns
    -------
    float
    """
    rest = max(beyond - tail, _LEAST / reach)
    per_scale = 0.5 * rest / max(farthest - REACH, 1.0)
    likelihood = 0.0
    for k in range(CELLS, SLOTS):
        if EDGES[k] > farthest:
            break
        both = counts[0, k] + counts[1, k]
        if both > 0.0:
            expected = inliers * mass[k] + octave_width(k, farthest) * per_scale
            likelihood += both * math.log(expected / (tail + rest))
    return likelihood


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
