"""Method ``auto``: a beam over the whole track, forward and backward, its parameters by their evidence."""

from __future__ import annotations

import numpy as np

from estimators.trajectories.estimation import Measured, estimate, judge, label
from estimators.trajectories.labelling.backward import turned_round
from estimators.trajectories.labelling.reconcile import doubtful, reconcile
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.parameters import TrackParameters

LAG = 32
"""Fixes after which the probability of a fix is settled."""
_HOPELESS = 18.0
"""Less likely branches hardly ever come back, and cost time; from 15 on the answers are the same."""

def label_globally(measured: Measured, options: TrackOptions) -> Labelled:
    """Label by a beam over the whole track, its parameters by their evidence."""
    top = np.inf if options.max_speed_mps is None else options.max_speed_mps
    return label_both_ways(measured, estimate(measured, options.sigma_m, top), top)


def label_both_ways(measured: Measured, parameters: TrackParameters, top_speed: float) -> Labelled:
    """Label under given parameters, forward, and backward where that is likelier.

    Parameters
    ----------
    measured : Measured
    parameters : TrackParameters
    top_speed : float
        m/s; may be infinite.
    """
    labels, probability, _ = label(measured, parameters, LAG, hopeless=_HOPELESS, top_speed=top_speed)
    # A beam looks ahead by as much as it holds hypotheses; read backward it holds others.
    for part in doubtful(labels):
        some = measured.window(part.start, part.stop)
        turned, turned_probability, _ = label(
            some.backward(), parameters, LAG, hopeless=_HOPELESS, top_speed=top_speed
        )
        labels[part], probability[part] = reconcile(
            labels[part],
            turned_round(turned),
            probability[part],
            turned_probability[::-1],
            lambda inner, given, some=some: judge(some.window(inner.start, inner.stop), parameters, given),
        )
    return Labelled(labels, probability, parameters)
