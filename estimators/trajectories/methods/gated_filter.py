"""Method ``kalman``: one hypothesis, forward."""

from __future__ import annotations

import numpy as np

from estimators.trajectories.estimation import Measured, from_spans, label
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.methods.whole_track import LAG
from estimators.trajectories.options import TrackOptions


def label_by_filter(measured: Measured, options: TrackOptions) -> Labelled:
    """Label by one Kalman filter that leaves out, at each fix, what is likelier a fault than noise."""
    top = np.inf if options.max_speed_mps is None else options.max_speed_mps
    parameters = from_spans(measured, options.sigma_m)
    labels, probability, _ = label(measured, parameters, LAG, width=1, top_speed=top)
    return Labelled(labels, probability, parameters)
