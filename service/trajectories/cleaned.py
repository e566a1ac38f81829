"""Recorded fixes to cleaned tracks, a device at a time; refusals by their names on the wire."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from estimators import InputError, NoFit, NoFitReason, Track, TrackOptions, clean_trajectory
from estimators.notices import notice_to_dict
from service.errors import FieldError, Problem, ProblemType, invalid_value
from service.schemas.trajectories import TrackArguments
from service.trajectories.recorded import Recorded

Integers = npt.NDArray[np.int64]

#: What the library takes beside times and places, and what of a recording that is.
MEASURED = {
    "height_m": "height_m",
    "accuracy_m": "radius_m",
    "speed_mps": "speed_mps",
    "bearing_deg": "bearing_deg",
}

#: The library's arguments by the names they have on the wire.
WIRE_NAMES = {
    "t_s": "time",
    "lat_deg": "lat",
    "lon_deg": "lon",
    "height_m": "height",
    "accuracy_m": "accuracy",
    "speed_mps": "speed",
    "bearing_deg": "bearing",
    "options.sigma_m": "sigma_m",
    "options.max_speed_mps": "max_speed_mps",
}

#: Where the library speaks of its own arguments.
MESSAGES = {NoFitReason.no_data: "no fix has both a time and a place on Earth; look at time, lat and lon"}


@dataclass(frozen=True, slots=True)
class DeviceTrack:
    """What became of a device.

    Attributes
    ----------
    device : str or None
        None where nobody named it.
    rows : ndarray of int64, shape (m,)
        Its rows of the recording, in input order.
    answer : Track or NoFit
    """

    device: str | None
    rows: Integers
    answer: Track | NoFit


@dataclass(frozen=True, slots=True)
class CleanedTracks:
    """An answer, with what its writers need of the request.

    Attributes
    ----------
    recorded : Recorded
    tracks : tuple of DeviceTrack
        In the order in which devices first appear.
    method : str
    """

    recorded: Recorded
    tracks: tuple[DeviceTrack, ...]
    method: str


def clean_recorded(
    recorded: Recorded, arguments: TrackArguments, progress: Callable[[int, int], object]
) -> CleanedTracks:
    """Clean the track of each device.

    Parameters
    ----------
    recorded : Recorded
    arguments : TrackArguments
    progress : callable
        Called with the devices done and in all; it may raise to end the work.

    Raises
    ------
    Problem
        422 if the library refuses a value, or the one track that was sent cannot be cleaned.
    """
    options = TrackOptions(sigma_m=arguments.sigma_m, max_speed_mps=arguments.max_speed_mps)
    recording = recorded.recording
    measured = {name: getattr(recording, column) for name, column in MEASURED.items()}
    devices = rows_of_devices(recorded)
    found = []
    for done, (device, rows) in enumerate(devices):
        progress(done, len(devices))
        try:
            answer = clean_trajectory(
                recorded.time[rows],
                recording.lat[rows],
                recording.lon[rows],
                **{name: None if column is None else column[rows] for name, column in measured.items()},
                method=arguments.method,
                level=arguments.level,
                options=options,
            )
        except InputError as error:
            raise invalid_value(WIRE_NAMES.get(error.field, error.field), error.message) from error
        found.append(DeviceTrack(device, rows, answer))
    if not recorded.is_many and isinstance(found[0].answer, NoFit):
        raise no_track(found[0].answer)
    return CleanedTracks(recorded, tuple(found), arguments.method)


def rows_of_devices(recorded: Recorded) -> list[tuple[str | None, Integers]]:
    """Name and rows of each device, in the order in which they first appear."""
    recording = recorded.recording
    names = recording.devices or ("",)
    if recording.device is None:
        return [(names[0] or None, np.arange(len(recording)))]
    order = np.argsort(recording.device, kind="stable")
    starts = np.searchsorted(recording.device[order], np.arange(len(names) + 1))
    groups = [order[starts[k] : starts[k + 1]] for k in range(len(names))]
    pairs = [(name or None, rows) for name, rows in zip(names, groups, strict=True) if rows.size]
    return sorted(pairs, key=lambda pair: int(pair[1][0]))


def no_track(refusal: NoFit) -> Problem:
    """Problem of fixes that determine no track."""
    told = refusal_of(refusal)
    message = told.pop("message")
    return Problem(
        ProblemType.no_track,
        message,
        errors=[FieldError("time" if refusal.reason is NoFitReason.constant_time else "lat", message)],
        extra=told,
    )


def refusal_of(refusal: NoFit) -> dict[str, Any]:
    """JSON form of the reason why a device has no track."""
    return {
        "reason": refusal.reason.value,
        "message": MESSAGES.get(refusal.reason, refusal.message),
        "points": {"reason": refusal.points.reason},
        "notices": [notice_to_dict(item) for item in refusal.notices],
    }
