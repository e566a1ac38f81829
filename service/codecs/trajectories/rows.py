"""Answers about tracks as columns over all rows that came, whatever device each is of."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from estimators import NoFit, Track
from estimators.adapters.tracks import Cleaned
from estimators.adapters.tracks.column_values import column_values
from service.trajectories.cleaned import CleanedTracks

Floats = npt.NDArray[np.float64]

#: What is written of each fix beside its place and label, by name.
OTHERS: dict[str, Callable[[Track], Floats]] = {
    "residual_m": lambda track: track.points.residual_m,
    "sigma_m": lambda track: track.sigma_m,
    "speed_mps": lambda track: track.speed_mps,
    "speed_sigma_mps": lambda track: track.speed_sigma_mps,
    "heading_deg": lambda track: track.heading_deg,
    "heading_sigma_deg": lambda track: track.heading_sigma_deg,
}


def cleaned_rows(cleaned: CleanedTracks) -> Cleaned:
    """Columns of all tracks in the order of the rows; rows of a device without a track have its reason."""
    n = len(cleaned.recorded.recording)
    heights = any(
        isinstance(item.answer, Track) and item.answer.height_m is not None for item in cleaned.tracks
    )
    numbers: dict[str, Floats] = {
        name: np.full(n, np.nan) for name in ("lat", "lon", "height_m", "probability", *OTHERS)
    }
    inlier = np.zeros(n, dtype=np.bool_)
    reason = np.empty(n, dtype=object)
    for item in cleaned.tracks:
        rows, answer = item.rows, item.answer
        if isinstance(answer, NoFit):
            reason[rows] = [answer.reason.value if word == "ok" else word for word in answer.points.reason]
            continue
        numbers["lat"][rows], numbers["lon"][rows] = answer.lat_deg, answer.lon_deg
        if answer.height_m is not None:
            numbers["height_m"][rows] = answer.height_m
        numbers["probability"][rows] = answer.points.probability
        for name, column in OTHERS.items():
            numbers[name][rows] = column(answer)
        inlier[rows] = answer.points.inlier
        reason[rows] = answer.points.reason
    return Cleaned(
        numbers["lat"],
        numbers["lon"],
        height_m=numbers["height_m"] if heights else None,
        inlier=inlier,
        probability=numbers["probability"],
        reason=reason.tolist(),
        others={name: numbers[name] for name in OTHERS},
    )


def columns_of(cleaned: CleanedTracks) -> dict[str, Any]:
    """Columns without the times, named and ordered as the writer of CSV has them.

    Returns
    -------
    dict of str to ndarray or list of str
        Numbers are NaN where there is none.
    """
    return column_values(cleaned.recorded.recording, cleaned_rows(cleaned))
