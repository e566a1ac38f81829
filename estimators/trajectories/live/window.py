"""The last fixes of a live track, labelled and smoothed like a track of their own.

A window begins with settled fixes that were good, some way before the first open one and before any burst
that is not over: a filter that began within a burst would take it for the track.
"""

from __future__ import annotations

import numpy as np

from estimators.trajectories.estimation import Measured, estimate, label
from estimators.trajectories.live.stream import Fix, Stream
from estimators.trajectories.measured_rows import MeasuredRows
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.methods.whole_track import label_both_ways
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.parameters import TrackParameters
from estimators.trajectories.rows import Rows, read_rows
from estimators.trajectories.smoothing.blocks import BLOCK
from estimators.trajectories.solve import measured_of, solve, whole
from estimators.trajectories.track import Track

NAME = "fixed-lag"
_CONTEXT = 64
"""Settled fixes before the open ones that a window begins with at least, if there are so many."""
_GOOD_START = 3
_LIVELIER, _CLEARLY = (16.0, 256.0), 3.0
"""A walker may have boarded a train since the motion was learned, and its start looks like a drifting burst:
factors by which the motion may be livelier now, and how much likelier that has to make the open fixes."""
_FEWEST = 8
_LEVEL = 0.95


def solve_window(stream: Stream) -> tuple[Track | None, int]:
    """Label and smooth the open fixes with context before them.

    Returns
    -------
    track : Track or None
        One row per fix of the window, in order of time; None if none of them has a place.
    first : int
        Place in ``stream.held`` where the window begins.
    """
    first = _begin(stream)
    rows = _rows(stream, stream.held[first:])
    if not rows.measures.any():
        return None, first
    settled = int(np.count_nonzero(rows.measures[: stream.settled - first]))

    def label_open(fixes: MeasuredRows) -> Labelled:
        measured = fixes.whole()
        return label_both_ways(measured, _present(measured, settled, stream), _top_speed(stream))

    options = TrackOptions(sigma_m=stream.settings.sigma_m, max_speed_mps=stream.settings.max_speed_mps)
    return whole(solve(rows, label_open, NAME, options, _LEVEL, BLOCK)), first


def _present(measured: Measured, settled: int, stream: Stream) -> TrackParameters:
    """Parameters of the open fixes: those learned, unless a livelier motion foretells them clearly better.

    Parameters
    ----------
    measured : Measured
    settled : int
        So many of the fixes are context, given which the others are judged.
    stream : Stream
    """
    known, top = stream.parameters, _top_speed(stream)
    context = measured.window(0, settled)

    def foretold(parameters: TrackParameters) -> float:
        before = label(context, parameters, top_speed=top)[2] if settled else 0.0
        return label(measured, parameters, top_speed=top)[2] - before

    best, evidence = known, foretold(known) + _CLEARLY
    for factor in _LIVELIER:
        tried = known.with_noise(known.sigma, known.colour_m, factor * known.manoeuvre)
        its_evidence = foretold(tried)
        if its_evidence > evidence:
            best, evidence = tried, its_evidence
    return best


def learn(stream: Stream) -> None:
    """Estimate noise and motion from the fixes held."""
    reported = np.array([fix.accuracy for fix in stream.held])
    known = np.isfinite(reported)
    by_accuracy = 2 * int(known.sum()) >= reported.size
    before = stream.typical_accuracy
    stream.typical_accuracy = float(np.median(reported[known])) if by_accuracy else float("nan")
    measured = measured_of(_rows(stream, stream.held)).whole()
    if measured.t.size < _FEWEST or not measured.t[-1] > measured.t[0]:
        stream.typical_accuracy = before
        return
    stream.parameters = estimate(measured, stream.settings.sigma_m, _top_speed(stream))


def _top_speed(stream: Stream) -> float:
    top = stream.settings.max_speed_mps
    return np.inf if top is None else top


def _begin(stream: Stream) -> int:
    """Last place with enough settled fixes after it where some on end are good; 0 if there is none."""
    for first in range(stream.settled - _CONTEXT, 0, -1):
        if all(stream.good[first : first + _GOOD_START]):
            return first
    return 0


def _rows(stream: Stream, fixes: list[Fix]) -> Rows:
    """Bring fixes through the door of tracks."""
    t = np.array([stream.seconds_between(fixes[0], fix) for fix in fixes])
    columns = np.array([fix[2:] for fix in fixes])
    reported = None
    if np.isfinite(stream.typical_accuracy):
        reported = np.where(np.isfinite(columns[:, 3]), columns[:, 3], stream.typical_accuracy)
    return read_rows(t, columns[:, 0], columns[:, 1], columns[:, 2], reported)
