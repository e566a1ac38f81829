"""From a labelled track to the answer on the caller's rows, block by block, and what is said of the whole."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.geodesy.ellipsoid import to_cartesian
from estimators.trajectories.course import Course, View
from estimators.trajectories.distance import Journey, Way
from estimators.trajectories.findings import Ledger
from estimators.trajectories.headings import directions
from estimators.trajectories.labelling.modes import COLOUR_TIME_S
from estimators.trajectories.motion import StretchGatherer
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.pieces import TrackFacts, TrackPiece
from estimators.trajectories.reasons import FixReason
from estimators.trajectories.rows import Rows
from estimators.trajectories.smoothing.height import estimate_heights, smooth_height, trusted_heights
from estimators.trajectories.smoothing.solved import Solved, at_times
from estimators.trajectories.survey import Survey, survey
from estimators.trajectories.track import Distance, TrackNoise, TrackPoints


class Answer:
    """The answer in the making.

    Parameters
    ----------
    course : Course
    ledger : Ledger
        What was counted before the track was labelled.
    method : str
    options : TrackOptions
    level : float
        Of intervals.
    """

    def __init__(
        self, course: Course, ledger: Ledger, method: str, options: TrackOptions, level: float
    ) -> None:
        self._course, self._rows = course, course.rows
        self._ledger, self._method, self._options, self._level = ledger, method, options, level
        self._survey: Survey = survey(course, ledger.row_step_s)
        self._journey, self._raw = Journey(), Way(0.0)
        self._gatherer = StretchGatherer(self._rows.t, self._survey.moving)

    def blocks(self) -> Iterator[TrackPiece]:
        """Columns of rows with a time, in its order; then of those without."""
        rows = self._rows
        used = model = None
        if rows.height is not None:
            used = trusted_heights(rows.height, self._survey.inlier)
            model = estimate_heights(rows.t, rows.height, used)
        for part in self._course.parts():
            view = self._course.view(part)
            solved, variance = view.solved, view.variance
            latitude, longitude = rows.plane.locate(view.places)
            ground, sigma = _on_ground(latitude, longitude), np.sqrt(variance)
            self._travel(part, ground, sigma)
            if rows.shift is not None and rows.shift[part].any():
                # What stands beside a time is the place at that time, though the clock was off.
                solved, variance = self._shifted(view, rows.shift[part])
                latitude, longitude = rows.plane.locate(solved.states[:, :, 0])
            speed, heading, speed_sigma, heading_sigma = directions(rows.plane, latitude, longitude, solved)
            self._gatherer.add(part.start, ground, sigma, speed)
            height, up = None, np.full(speed.size, math.nan)
            if rows.height is not None and used is not None and model is not None:
                height, up = smooth_height(rows.t, rows.height, used, model, part)
            yield TrackPiece(
                rows.inputs(part),
                self._points(view),
                latitude,
                longitude,
                height,
                variance,
                up,
                speed,
                speed_sigma,
                heading,
                heading_sigma,
            )
        if rows.order is not None and rows.order.size < rows.codes.size:
            yield _without_time(rows)

    def facts(self) -> TrackFacts:
        """Say what holds of the whole, once all blocks have been made."""
        rows, parameters = self._rows, self._course.labelled.parameters
        return TrackFacts(
            method=self._method,
            rows=int(rows.codes.size),
            inliers=int(np.count_nonzero(self._survey.inlier)),
            noise=TrackNoise(
                parameters.sigma * self._ledger.unit,
                parameters.colour_m,
                COLOUR_TIME_S,
                parameters.manoeuvre,
                "estimated" if self._options.sigma_m is None else "given",
            ),
            distance=Distance(self._raw.length_m, self._journey.travelled(rows.t.size, self._level)),
            stretches=self._gatherer.stretches(rows.inputs, self._level),
            level=self._level,
            notices=self._ledger.notices(parameters, self._survey, rows),
        )

    def _travel(self, part: slice, ground: FloatArray, sigma: FloatArray) -> None:
        self._journey.add(ground, sigma)
        raw = self._rows.inputs(part)[self._rows.measures[part]]
        self._raw.add(_on_ground(self._rows.lat_deg[raw], self._rows.lon_deg[raw]), np.zeros(raw.size))

    def _points(self, view: View) -> TrackPoints:
        known = self._rows.codes[self._rows.inputs(view.part)]
        usable = known != FixReason.invalid
        residual, probability = view.residual.copy(), self._probability(view.part)
        residual[~usable] = math.nan
        probability[~usable] = math.nan
        return TrackPoints(
            self._survey.inlier[view.part], probability, residual, self._survey.codes[view.part]
        )

    def _probability(self, part: slice) -> FloatArray:
        """Of rows to be good; of a duplicate, that of its twin, which stands before it."""
        rows, labelled = self._rows, self._course.labelled
        own = slice(*np.searchsorted(rows.duplicates, [part.start, part.stop]).tolist())
        duplicates, twins = rows.duplicates[own], rows.twins[own]
        wide = slice(min(part.start, int(twins[0])) if twins.size else part.start, part.stop)
        measures = rows.measures[wide]
        probability = np.where(rows.repeat[wide] & self._survey.repeats_good[wide], 1.0, 0.0)
        before = self._ledger.measured.before_row(wide.start)
        probability[measures] = labelled.probability[before : before + np.count_nonzero(measures)]
        probability[duplicates - wide.start] = probability[twins - wide.start]
        return probability[part.start - wide.start :]

    def _shifted(self, view: View, shift: FloatArray) -> tuple[Solved, FloatArray]:
        """States and variances where the clock of each row, right or wrong, says."""
        t = self._rows.t
        states, covariances = view.solved.states.copy(), view.solved.covariances.copy()
        variance = view.variance.copy()
        for by in np.unique(shift[shift != 0.0]).tolist():
            off = np.flatnonzero(shift == by)
            when = t[view.part][off] - by
            first, stop = np.searchsorted(t, [when[0], when[-1]], side="right").tolist()
            there = self._course.view(slice(max(first - 1, 0), min(max(stop + 1, first), t.size)))
            states[off], covariances[off] = at_times(there.solved, t[there.part], when)
            variance[off] = np.interp(when, t[there.part], there.variance)
        return Solved(view.solved.labels, view.solved.variance, states, covariances), variance


def _on_ground(latitude: FloatArray, longitude: FloatArray) -> FloatArray:
    return to_cartesian(np.column_stack([latitude, longitude, np.zeros(latitude.size)]))


def _without_time(rows: Rows) -> TrackPiece:
    """Rows that have no place in the track."""
    timed = np.zeros(rows.codes.size, dtype=np.bool_)
    timed[rows.order] = True
    others: IntArray = np.flatnonzero(~timed)
    nothing: FloatArray = np.full(others.size, math.nan)
    points = TrackPoints(np.zeros(others.size, dtype=np.bool_), nothing, nothing, rows.codes[others])
    height = None if rows.height is None else nothing
    return TrackPiece(others, points, nothing, nothing, height, *([nothing] * 6))
