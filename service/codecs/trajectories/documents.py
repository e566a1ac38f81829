"""Answers about tracks as JSON."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from estimators import NoFit
from service.codecs.columns import WireTimes
from service.codecs.json import dumps
from service.schemas.trajectories import TrackAnswerQuery
from service.trajectories.cleaned import CleanedTracks, DeviceTrack, refusal_of


def write_json(cleaned: CleanedTracks, query: TrackAnswerQuery) -> Iterator[bytes]:
    """``to_dict()`` of the track, or of the track of each device, with times in the form they came."""
    points = query.points is not False
    times = cleaned.recorded.written_times()
    left_out = cleaned.recorded.recording.left_out
    lost = {"left_out": left_out} if left_out else {}
    if cleaned.recorded.is_many:
        tracks = [_device(item, times, points=points) for item in cleaned.tracks]
        yield dumps({"tracks": tracks, **lost})
        return
    (only,) = cleaned.tracks
    named = {} if only.device is None else {"device": only.device}
    yield dumps(named | _track(only, times, points=points) | lost)


def _device(item: DeviceTrack, times: WireTimes, *, points: bool) -> dict[str, Any]:
    """Entry of a device: its rows, and its track or why there is none."""
    refused = isinstance(item.answer, NoFit)
    rows = {"row": item.rows} if points else {}
    return {
        "device": item.device,
        **rows,
        "track": None if refused else _track(item, times, points=points),
        "refusal": refusal_of(item.answer) if isinstance(item.answer, NoFit) else None,
    }


def _track(item: DeviceTrack, times: WireTimes, *, points: bool) -> dict[str, Any]:
    if isinstance(item.answer, NoFit):
        raise TypeError("a refusal is no track; cleaning refuses a single one before")
    told = item.answer.to_dict(points=points)
    if points:
        told["points"]["time"] = _taken(times, item.rows)
    return told


def _taken(times: WireTimes, rows: np.ndarray[Any, Any]) -> WireTimes:
    if isinstance(times, list):
        return times if rows.size == len(times) else [times[row] for row in rows.tolist()]
    taken: WireTimes = times[rows]
    return taken
