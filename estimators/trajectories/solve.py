"""Between the door and the answer: what measures something, and the track smoothed under its labels."""

from __future__ import annotations

import numpy as np

from estimators.trajectories.estimation import Measured
from estimators.trajectories.labelling.modes import MISSING
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.rows import Rows
from estimators.trajectories.smoothing.rts import smooth_track
from estimators.trajectories.smoothing.solved import Solved
from estimators.trajectories.velocities import velocity_variance


def measured_of(rows: Rows) -> Measured:
    """Give the rows that measure something, in order of time."""
    return all_of(rows).where(rows.measures)


def all_of(rows: Rows) -> Measured:
    """Give all rows that have a time, those that measure nothing too."""
    if rows.velocity is None:
        return Measured(rows.t, rows.fixes, rows.reported)
    used = rows.measures
    variance = np.full(rows.t.size, np.inf)
    variance[used] = velocity_variance(rows.t[used], rows.fixes[used], rows.velocity[used])
    return Measured(rows.t, rows.fixes, rows.reported, np.nan_to_num(rows.velocity), variance)


def smooth_rows(rows: Rows, labelled: Labelled) -> Solved:
    """Smooth at every time, through rows that measure nothing too."""
    m, parameters = rows.t.size, labelled.parameters
    labels = np.full(m, MISSING, dtype=np.uint8)
    labels[rows.measures] = labelled.labels
    measured = all_of(rows)
    variance = measured.variance(parameters)
    states, covariances = np.zeros((m, 2, 3)), np.zeros((m, 3, 3))
    smooth_track(
        rows.t,
        rows.fixes,
        variance,
        *measured.velocities(),
        parameters.colour_m,
        parameters.manoeuvre,
        parameters.rates.as_array(),
        labels,
        states,
        covariances,
    )
    return Solved(labels, variance, states, covariances)
