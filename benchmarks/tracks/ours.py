"""Plumbline's methods on recordings."""

from __future__ import annotations

import time

import numpy as np

from benchmarks.tracks.recording import Recording
from benchmarks.tracks.scores import Answer
from estimators import NoFit, clean_trajectory


def answer_by(method: str, recording: Recording) -> tuple[Answer, float]:
    """Clean by a method of :func:`estimators.clean_trajectory`.

    Returns
    -------
    answer : Answer
        The raw track, all of it flagged, if there is no answer.
    seconds : float
        Processor time.
    """
    started = time.process_time()
    track = clean_trajectory(
        recording.t_s, recording.lat_deg, recording.lon_deg, accuracy_m=recording.accuracy_m, method=method
    )
    seconds = time.process_time() - started
    if isinstance(track, NoFit):
        everything = np.ones(len(recording), dtype=np.bool_)
        return Answer(recording.lat_deg, recording.lon_deg, everything), seconds
    covariance = np.ascontiguousarray(track.covariance_enu_m2[:, :2, :2])
    return (
        Answer(track.lat_deg, track.lon_deg, ~track.points.inlier, covariance, track.distance.cleaned.value),
        seconds,
    )
