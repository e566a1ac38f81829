"""What typed tables hold beside the times, in the order that every writer has: :func:`column_values`."""

from __future__ import annotations

from typing import Any

from estimators.adapters.tracks.assembly import RANGES
from estimators.adapters.tracks.cleaned import Cleaned
from estimators.adapters.tracks.recording import Recording
from estimators.adapters.tracks.written_columns import positions


def column_values(recording: Recording, cleaned: Cleaned) -> dict[str, Any]:
    """Columns without the times, named and ordered as those of CSV.

    Parameters
    ----------
    recording : Recording
    cleaned : Cleaned

    Returns
    -------
    dict of str to ndarray or list of str
        Numbers are NaN where there is none.
    """
    lat, lon, height = positions(recording, cleaned)
    columns: dict[str, Any] = {}
    if recording.devices:
        columns["device"] = recording.device_names()
    if recording.segment is not None:
        columns["segment"] = recording.segment
    columns |= {"lat": lat, "lon": lon}
    if height is not None:
        columns["height_m"] = height
    columns |= {"raw_lat": recording.lat, "raw_lon": recording.lon}
    if recording.height_m is not None and cleaned.height_m is not None:
        columns["raw_height_m"] = recording.height_m
    measured = {name: getattr(recording, name) for name in RANGES if name != "height_m"}
    columns |= {name: values for name, values in measured.items() if values is not None}
    if cleaned.inlier is not None:
        columns["inlier"] = cleaned.inlier
    if cleaned.probability is not None:
        columns["probability"] = cleaned.probability
    if cleaned.reason is not None:
        columns["reason"] = list(cleaned.reason)
    return columns | dict(cleaned.others)
