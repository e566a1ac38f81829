"""Faults that last as long as a series, which more epochs of the same satellites do not betray.

A joint solution takes faults to come and go. A satellite that lies all the time is found by the others or not
at all: with as many satellites as an epoch has unknowns it moves every position, and with one more two do so
unnoticed (:mod:`estimators.gnss.snapshot.untested` says the same of one epoch).
"""

from __future__ import annotations

import dataclasses

import numpy as np

from estimators.gnss.options import PositionOptions
from estimators.gnss.series.joint import Joint
from estimators.gnss.series.observed import Observations

_TELLS = 2
"""Satellites beyond the unknowns from which one that lies is found and two are noticed."""


def widen_unwatched(joint: Joint, observations: Observations, options: PositionOptions) -> Joint:
    """Take back what a series of too few satellites cannot promise.

    Parameters
    ----------
    joint : Joint
    observations : Observations
    options : PositionOptions

    Returns
    -------
    Joint
        With infinite protection levels where the satellites of the whole series are at most one more than the
        unknowns of an epoch, and the probability of a fault among the far ones where they are no more.
    """
    satellites = len(set(observations.table.names))
    spare = satellites - 3 - len(observations.letters)
    if spare >= _TELLS:
        return joint
    level = np.where(joint.solved, np.inf, np.nan)
    far = joint.far_probability
    if spare <= 0:
        far = np.maximum(far, 1.0 - (1.0 - options.fault_prior) ** satellites)
    return dataclasses.replace(joint, hpl_m=level, vpl_m=level.copy(), far_probability=far)
