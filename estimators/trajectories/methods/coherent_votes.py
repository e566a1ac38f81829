"""Method ``gc-ransac``: the votes of windows, and labels that hang together in time.

Graph-Cut RANSAC (Barath and Matas 2018) with the energy of the paper. On a chain its minimum is found
exactly by Viterbi's recursion instead of a maximum flow: within each window, where motion and labels are
improved in turn, and once for the whole track.
"""

from __future__ import annotations

import numpy as np

from estimators.trajectories.estimation import Measured, from_spans
from estimators.trajectories.hypotheses.coherent import cut_in_time, find_coherent_motion
from estimators.trajectories.hypotheses.windows import ballot
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.methods.window_votes import labelled_good
from estimators.trajectories.options import TrackOptions


def label_by_coherent_votes(measured: Measured, options: TrackOptions) -> Labelled:
    """Leave out the fixes that the cheapest cut between good and faulty ones leaves out."""
    parameters = from_spans(measured, options.sigma_m)
    closeness = ballot(measured, parameters, find_coherent_motion, options.max_speed_mps)
    good = cut_in_time(np.ascontiguousarray(measured.t), closeness)
    return labelled_good(good, closeness, parameters)
