"""Method ``ransac``: constant velocity in short windows that overlap, and their votes."""

from __future__ import annotations

import numpy as np

from estimators.arrays import BoolArray, FloatArray
from estimators.trajectories.estimation import Measured, from_spans
from estimators.trajectories.hypotheses.windows import ballot, find_motion
from estimators.trajectories.labelling.modes import NOMINAL, SPIKE
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.parameters import TrackParameters


def label_by_votes(measured: Measured, options: TrackOptions) -> Labelled:
    """Leave out every fix that most of its windows say is off their motion."""
    parameters = from_spans(measured, options.sigma_m)
    closeness = ballot(measured, parameters, find_motion, options.max_speed_mps)
    return labelled_good(closeness >= 0.5, closeness, parameters)


def labelled_good(good: BoolArray, closeness: FloatArray, parameters: TrackParameters) -> Labelled:
    """Turn flags into labels: what is not good tells nothing."""
    labels = np.where(good, NOMINAL, SPIKE).astype(np.uint8)
    return Labelled(labels, closeness, parameters)
