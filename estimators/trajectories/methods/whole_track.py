"""Method ``auto``: a beam over the whole track, forward and backward, its parameters by their evidence."""

from __future__ import annotations

import numpy as np

from estimators.arrays import CodeArray, FloatArray
from estimators.trajectories.estimation import Measured, estimate, judge, label
from estimators.trajectories.labelling.backward import turned_round
from estimators.trajectories.labelling.reconcile import Judge, doubtful, is_good, reconcile
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.parameters import TrackParameters

LAG = 32
"""Fixes after which the probability of a fix is settled."""
_HOPELESS = 18.0
"""Less likely branches hardly ever come back, and cost time; from 15 on the answers are the same."""
_SURELY = 8
"""Good fixes on end that a stretch read backward has to come to."""


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
    for odd in doubtful(labels):
        part, turned, sure = _read_backward(measured, odd, parameters, top_speed)
        labels[part], probability[part] = reconcile(
            labels[part],
            turned,
            probability[part],
            sure,
            _judge_of(measured.window(part.start, part.stop), parameters),
        )
    return Labelled(labels, probability, parameters)


def _read_backward(
    measured: Measured, part: slice, parameters: TrackParameters, top_speed: float
) -> tuple[slice, CodeArray, FloatArray]:
    """Label a stretch backward, and as much before it as it takes to come to good fixes.

    Returns
    -------
    part : slice
    labels : ndarray of uint8
    probability : ndarray
    """
    while True:
        some = measured.window(part.start, part.stop).backward()
        turned, sure, _ = label(some, parameters, LAG, hopeless=_HOPELESS, top_speed=top_speed)
        labels = turned_round(turned)
        if part.start == 0 or is_good(labels[:_SURELY]).all():
            return part, labels, sure[::-1]
        part = slice(max(0, part.start - 2 * (part.stop - part.start)), part.stop)


def _judge_of(measured: Measured, parameters: TrackParameters) -> Judge:
    return lambda part, labels: judge(measured.window(part.start, part.stop), parameters, labels)
