"""Every method of labelling a track is one row: a function, and the words by which people choose it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from estimators.trajectories.estimation import Measured
from estimators.trajectories.measured_rows import MeasuredRows
from estimators.trajectories.methods.coherent_votes import label_by_coherent_votes
from estimators.trajectories.methods.gated_filter import label_by_filter
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.methods.speed_gate import label_by_speed
from estimators.trajectories.methods.whole_track import label_globally
from estimators.trajectories.methods.window_votes import label_by_votes
from estimators.trajectories.options import TrackOptions


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
        From the rows that measure something and the options to labels. One that takes the whole track at once
        is wrapped in :func:`at_once`.
    """

    name: str
    title: str
    summary: str
    when_to_use: str
    source: str
    labeller: Callable[[MeasuredRows, TrackOptions], Labelled]


def at_once(
    labeller: Callable[[Measured, TrackOptions], Labelled],
) -> Callable[[MeasuredRows, TrackOptions], Labelled]:
    """Hand the whole track to a function that takes it at once."""
    return lambda rows, options: labeller(rows.whole(), options)


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
        at_once(label_by_filter),
    ),
    TrackMethod(
        "ransac",
        "RANSAC in windows",
        "Finds the steady motion with the best consensus in every short window, and leaves out the fixes "
        "that most windows leave out.",
        "To compare with consensus that looks at a window at a time; faults that fill a window pass.",
        "Fischler and Bolles 1981; Torr and Zisserman 2000",
        at_once(label_by_votes),
    ),
    TrackMethod(
        "gc-ransac",
        "Graph-Cut RANSAC in windows",
        "The same with labels that hang together in time, by the cheapest cut of the chain of fixes, found "
        "exactly.",
        "To compare; it closes gaps within runs of faults, and fills a window no better than RANSAC.",
        "Barath and Matas 2018, the energy of the paper; Viterbi 1967",
        at_once(label_by_coherent_votes),
    ),
    TrackMethod(
        "speed-gate",
        "Speed gate",
        "Leaves out every fix that is farther from the last one kept than the highest speed allows.",
        "To compare with other software; one fault at the start or a lasting one defeats it.",
        "The filter of scikit-mobility and others",
        at_once(label_by_speed),
    ),
)

TRACK_METHODS: Mapping[str, TrackMethod] = MappingProxyType({row.name: row for row in _ROWS})
"""The named methods by name, ``auto`` first."""
