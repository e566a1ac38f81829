"""Every method of labelling a track is one row: a function, and the words by which people choose it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from estimators.arrays import CodeArray, FloatArray
from estimators.trajectories.estimation import Measured, estimate, from_spans, judge, label
from estimators.trajectories.labelling.backward import turned_round
from estimators.trajectories.labelling.reconcile import doubtful, reconcile
from estimators.trajectories.labelling.modes import NOMINAL, SPIKE
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.parameters import TrackParameters

_LAG = 32
"""Fixes after which the probability of a fix is settled."""
_HOPELESS = 18.0
"""Less likely branches hardly ever come back, and cost time; from 15 on the answers are the same."""
_CUSTOMARY_SPEED_MPS = 50.0


@dataclass(frozen=True, slots=True)
class Labelled:
    """What a method says of the fixes that measure something, in order of time.

    Attributes
    ----------
    labels : ndarray of uint8, shape (m,)
        See :mod:`estimators.trajectories.labelling.modes`.
    probability : ndarray, shape (m,)
        Of each fix to be good.
    parameters : TrackParameters
    """

    labels: CodeArray
    probability: FloatArray
    parameters: TrackParameters


@dataclass(frozen=True, slots=True)
class TrackMethod:
    """A named method.

    Attributes
    ----------
    name : str
        What callers pass as ``method``.
    title, summary, when_to_use, source : str
        For people.
    labeller : callable
        From what was measured, in order of time, and the options to labels.
    """

    name: str
    title: str
    summary: str
    when_to_use: str
    source: str
    labeller: Callable[[Measured, TrackOptions], Labelled]


def label_globally(measured: Measured, options: TrackOptions) -> Labelled:
    """Label by a beam over the whole track, its parameters by their evidence."""
    top = np.inf if options.max_speed_mps is None else options.max_speed_mps
    parameters = estimate(measured, options.sigma_m, top)
    labels, probability, _ = label(measured, parameters, _LAG, hopeless=_HOPELESS, top_speed=top)
    # A beam looks ahead by as much as it holds hypotheses; read backward it holds others.
    for part in doubtful(labels):
        some = measured.window(part.start, part.stop)
        turned, turned_probability, _ = label(
            some.backward(), parameters, _LAG, hopeless=_HOPELESS, top_speed=top
        )
        labels[part], probability[part] = reconcile(
            labels[part],
            turned_round(turned),
            probability[part],
            turned_probability[::-1],
            lambda inner, given, some=some: judge(some.window(inner.start, inner.stop), parameters, given),
        )
    return Labelled(labels, probability, parameters)


def label_by_filter(measured: Measured, options: TrackOptions) -> Labelled:
    """Label by one Kalman filter that leaves out, at each fix, what is likelier a fault than noise."""
    top = np.inf if options.max_speed_mps is None else options.max_speed_mps
    parameters = from_spans(measured, options.sigma_m)
    labels, probability, _ = label(measured, parameters, _LAG, width=1, top_speed=top)
    return Labelled(labels, probability, parameters)


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


_ROWS = (
    TrackMethod(
        "auto",
        "Automatic",
        "Weighs sequences of labels for the whole track at once, estimates noise and motion by their "
        "evidence, and keeps what a burst of faults tells about velocity.",
        "Always, unless you want one particular method.",
        "Plumbline; a merging beam over switching Kalman filters",
        label_globally,
    ),
    TrackMethod(
        "kalman",
        "Gated Kalman filter",
        "Follows one hypothesis forward: a fix is noise, a fault or the beginning of a burst, whichever is "
        "likeliest there and then.",
        "To compare with a filter that cannot look back.",
        "Kalman 1960; Rauch, Tung and Striebel 1965",
        label_by_filter,
    ),
    TrackMethod(
        "speed-gate",
        "Speed gate",
        "Leaves out every fix that is farther from the last one kept than the highest speed allows.",
        "To compare with other software; one fault at the start or a lasting one defeats it.",
        "The filter of scikit-mobility and others",
        label_by_speed,
    ),
)

TRACK_METHODS: Mapping[str, TrackMethod] = MappingProxyType({row.name: row for row in _ROWS})
"""The named methods by name, ``auto`` first."""
