"""Method ``auto``: a beam over the whole track, forward and backward, its parameters by their evidence."""

from __future__ import annotations

import numpy as np

from estimators.arrays import CodeArray, FloatArray
from estimators.consensus.cancellation import stop_if_cancelled
from estimators.trajectories.estimation import Measured, estimate, judge
from estimators.trajectories.labelling.backward import turned_round
from estimators.trajectories.labelling.passage import Passage
from estimators.trajectories.labelling.reconcile import Judge, doubtful, is_good, reconcile
from estimators.trajectories.measured_rows import MeasuredRows
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.parameters import TrackParameters

LAG = 32
"""Fixes after which the probability of a fix is settled."""
_HOPELESS = 18.0
"""Less likely branches hardly ever come back, and cost time. At 15 hard tracks lose .03 of F1."""
_PIECE = 1 << 14
"""Fixes that the beam takes in at once; the labels do not depend on it."""
_LONG = 1 << 17
"""A stretch of more fixes is not lengthened, so that memory stays bounded."""
_SURELY = 8
"""Good fixes on end that a stretch read backward has to come to."""


def label_globally(rows: MeasuredRows, options: TrackOptions) -> Labelled:
    """Label by a beam over the whole track, its parameters by their evidence."""
    top = np.inf if options.max_speed_mps is None else options.max_speed_mps
    return label_both_ways(rows, estimate(rows.sample(), options.sigma_m, top), top)


def label_both_ways(
    track: Measured | MeasuredRows, parameters: TrackParameters, top_speed: float
) -> Labelled:
    """Label under given parameters, forward, and backward where that is likelier.

    Parameters
    ----------
    track : Measured or MeasuredRows
    parameters : TrackParameters
    top_speed : float
        m/s; may be infinite.
    """
    forward = _follow(track, parameters, top_speed)
    labels, probability = forward.labels, forward.probability
    # A beam looks ahead by as much as it holds hypotheses; read backward it holds others.
    for odd in doubtful(labels):
        part, turned, sure = _read_backward(track, odd, parameters, top_speed)
        some = track.window(part.start, part.stop)
        labels[part], probability[part] = reconcile(
            labels[part], turned, probability[part], sure, _judge_of(some, parameters)
        )
    return Labelled(labels, probability, parameters)


def _follow(track: Measured | MeasuredRows, parameters: TrackParameters, top_speed: float) -> Passage:
    """Follow a track from end to end, piece by piece."""
    passage = Passage(track.size, parameters, LAG, hopeless=_HOPELESS, top_speed=top_speed)
    for first in range(0, track.size, _PIECE):
        stop_if_cancelled()
        stop = min(first + _PIECE, track.size)
        # The row before a piece is handed over with it.
        piece = track.window(max(first - 1, 0), stop)
        passage.follow(
            piece.t, piece.fixes, piece.variance(parameters), *piece.velocities(), is_last=stop == track.size
        )
    return passage


def _read_backward(
    track: Measured | MeasuredRows, part: slice, parameters: TrackParameters, top_speed: float
) -> tuple[slice, CodeArray, FloatArray]:
    """Label a stretch backward, and as much before it as it takes to come to good fixes.

    Returns
    -------
    part : slice
    labels : ndarray of uint8
    probability : ndarray
    """
    while True:
        some = track.window(part.start, part.stop).backward()
        turned = _follow(some, parameters, top_speed)
        labels = turned_round(turned.labels)
        long = part.stop - part.start > _LONG
        if part.start == 0 or long or is_good(labels[:_SURELY]).all():
            return part, labels, turned.probability[::-1]
        part = slice(max(0, part.start - 2 * (part.stop - part.start)), part.stop)


def _judge_of(measured: Measured, parameters: TrackParameters) -> Judge:
    return lambda part, labels: judge(measured.window(part.start, part.stop), parameters, labels)
