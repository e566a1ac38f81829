"""From rows behind the door to their answer: labelled by a method, smoothed, piece by piece or as a whole."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields

import numpy as np

from estimators.trajectories.assemble import Answer
from estimators.trajectories.course import Course
from estimators.trajectories.findings import open_ledger
from estimators.trajectories.measured_rows import MeasuredRows, measured_rows
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.pieces import TrackPieces
from estimators.trajectories.rows import Rows
from estimators.trajectories.track import Track, TrackPoints


def measured_of(rows: Rows) -> MeasuredRows:
    """Give the rows that measure something, in order of time."""
    return measured_rows(
        rows.t, rows.fixes, rows.measures, rows.reported, rows.velocity, rows.velocity_variance
    )


def solve(
    rows: Rows,
    labeller: Callable[[MeasuredRows], Labelled],
    method: str,
    options: TrackOptions,
    level: float,
    piece_rows: int,
) -> TrackPieces:
    """Label a track and smooth it under its labels.

    Parameters
    ----------
    rows : Rows
        With one that measures something.
    labeller : callable
    method : str
        Its name.
    options : TrackOptions
    level : float
        Confidence level of intervals.
    piece_rows : int
        Rows of a piece.
    """
    measured = measured_of(rows)
    ledger = open_ledger(rows, measured)
    answer = Answer(Course(rows, labeller(measured)), ledger, method, options, level)
    return TrackPieces(rows, answer.blocks(), answer.facts, piece_rows)


def whole(pieces: TrackPieces) -> Track:
    """Put the pieces on the caller's rows."""
    columns: dict[str, np.ndarray] = {}
    for piece in pieces:
        for name, values in piece.columns().items():
            if name not in columns:
                columns[name] = np.empty(pieces.size, dtype=values.dtype)
            columns[name][piece.rows] = values
    points = TrackPoints(**{field.name: columns.pop(field.name) for field in fields(TrackPoints)})
    facts = pieces.facts()
    time, latitude, longitude = pieces.inputs()
    return Track(
        method=facts.method,
        time=time,
        points=points,
        height_m=columns.pop("height_m", None),
        **columns,
        noise=facts.noise,
        distance=facts.distance,
        stretches=facts.stretches,
        level=facts.level,
        notices=facts.notices,
        input_lat_deg=latitude.copy(),
        input_lon_deg=longitude.copy(),
    )
