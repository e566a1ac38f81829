"""Contamination has to pay for itself; a structure that does not is clean noise about its line or curve.

A mixture always takes a little of the tails of clean noise for contamination, and may take a part of a clean
series for its trend. Its parameters pay by half a log n each (Schwarz 1978), and for having been searched
for (:mod:`estimators.consensus.labelling.chance`).
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.labelling.chance import gain_of_search
from estimators.consensus.structure.criterion import CORRELATION_PRICE
from estimators.consensus.structure.mixture import (
    ABOVE,
    BELOW,
    CORRELATION,
    ENTER,
    HELD_COUNT,
    INLIERS,
    LIKELIHOOD,
    SIGMA,
    STAY,
    UNIFORM,
)
from estimators.kernels import device

ALONE_STEPS = 3
"""Steps of EM without contamination: the first find scale and correlation, the last their likelihood."""

_NEVER = 1e-9
"""Chance of contamination where there is none."""
_PARAMETERS = 3.0
"""Parameters of contamination: how often it comes, how long it stays, what it looks like."""


@device
def start_alone(alone: FloatArray, scale: float) -> None:
    """Make a structure into one without contamination and without correlation, of a given scale."""
    alone[SIGMA] = scale
    alone[UNIFORM] = 1.0
    alone[ABOVE] = 0.0
    alone[BELOW] = 0.0
    alone[CORRELATION] = 0.0


@device
def forbid_contamination(alone: FloatArray) -> None:
    """Before a step of EM: no reading is contaminated, whatever the last step made of it."""
    alone[ENTER] = _NEVER
    alone[STAY] = 0.5


@device
def acquit(params: FloatArray, alone: FloatArray, coefficients: int, n: int) -> bool:
    """Replace a structure by what there is without contamination, if that explains n readings about as well.

    Parameters
    ----------
    params, alone : ndarray of float64
        The structure, and clean noise about its line or curve, each with its likelihood.
    coefficients, n : int
        Of the line or curve, and number of readings.

    Returns
    -------
    bool
        Whether it was replaced.
    """
    gain = params[LIKELIHOOD] - alone[LIKELIHOOD]
    if params[CORRELATION] > 0.0:
        gain -= CORRELATION_PRICE
    if alone[CORRELATION] > 0.0:
        gain += CORRELATION_PRICE
    if gain >= gain_of_search(coefficients, params[INLIERS], n) + _PARAMETERS * 0.5 * np.log(n):
        return False
    params[:] = alone
    params[UNIFORM] = 1.0
    params[INLIERS] = n
    params[HELD_COUNT] = 0.0
    return True
