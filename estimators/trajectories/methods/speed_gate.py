"""Method ``speed-gate``: what other cleaners do."""

from __future__ import annotations

import numpy as np

from estimators.trajectories.estimation import Measured, from_spans
from estimators.trajectories.labelling.modes import NOMINAL, SPIKE
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.options import TrackOptions

_CUSTOMARY_SPEED_MPS = 50.0


def label_by_speed(measured: Measured, options: TrackOptions) -> Labelled:
    """Leave out every fix that cannot be reached from the last one kept at the highest speed."""
    top = options.max_speed_mps or _CUSTOMARY_SPEED_MPS
    labels = np.full(measured.t.size, SPIKE, dtype=np.uint8)
    times, places = measured.t.tolist(), measured.fixes.tolist()
    last = 0
    labels[0] = NOMINAL
    for k in range(1, len(times)):
        east, north = places[k][0] - places[last][0], places[k][1] - places[last][1]
        if float(np.hypot(east, north)) <= top * (times[k] - times[last]):
            labels[k], last = NOMINAL, k
    kept = labels == NOMINAL
    return Labelled(labels, kept.astype(np.float64), from_spans(measured.where(kept), options.sigma_m))
