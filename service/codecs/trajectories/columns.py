"""JSON bodies of fixes: columns, and the arguments beside them."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec
import numpy as np

from estimators import InputError
from estimators.adapters.tracks import assemble
from estimators.adapters.tracks.assembly import code_names
from service.codecs.arguments import refuse_absent, refuse_beside_json, validated
from service.codecs.json import (
    decode_column,
    is_null,
    read_argument,
    read_numbers,
    read_object,
)
from service.codecs.sent import Sent
from service.codecs.trajectories.clock import read_clock
from service.errors import invalid_value
from service.schemas.trajectories import TrackArguments, TrackQuery
from service.trajectories.ellipses import check_ellipse
from service.trajectories.recorded import Recorded

REQUIRED = ("time", "lat", "lon")
#: Measured columns by their names in the body, and in a recording.
MEASURED = {
    "height": "height_m",
    "accuracy": "accuracy_m",
    "semi_major": "ellipse_major_m",
    "semi_minor": "ellipse_minor_m",
    "orientation": "ellipse_bearing_deg",
    "speed": "speed_mps",
    "bearing": "bearing_deg",
}
COLUMNS = (*REQUIRED, "device", *MEASURED)

_LONGEST_NAME = 100
_NAMES = msgspec.json.Decoder(list[str | int | None])


def read_json_fixes(sent: Sent[TrackQuery]) -> tuple[Recorded, TrackArguments]:
    """Columns and arguments of a JSON body.

    Raises
    ------
    Problem
        If the body is not JSON, holds unknown or repeated keys, or a value of the wrong type.
    """
    refuse_beside_json(sent.query.not_json())
    fields = read_object(sent.content, (*COLUMNS, *TrackArguments.model_fields), "")
    arguments = validated(
        TrackArguments,
        {name: read_argument(raw, name) for name, raw in fields.items() if name not in COLUMNS},
    )
    refuse_absent([name for name in REQUIRED if is_null(fields.get(name))])
    time, form, offsets = read_clock(fields["time"], arguments.time_unit)
    sent.limits.check_points(time.size)
    given = {name: column for name, column in MEASURED.items() if not is_null(fields.get(name))}
    check_ellipse(given.values(), {column: name for name, column in MEASURED.items()})
    numbers = {name: read_numbers(fields[name], name) for name in ("lat", "lon", *given)}
    names = None if is_null(fields.get("device")) else _devices(fields["device"])
    if time.size == 0:
        raise invalid_value("time", "is empty; send at least one fix")
    lengths = {name: column.size for name, column in numbers.items()}
    check_lengths(time.size, lengths if names is None else lengths | {"device": len(names)})
    sent.check()
    device, devices = (None, ()) if names is None else code_names(names)
    sent.limits.check_series(len(devices))
    try:
        recording = assemble(
            "json",
            time=time if time.dtype.kind == "M" else time.astype(np.float64),  # type: ignore[arg-type]
            lat=numbers["lat"],
            lon=numbers["lon"],
            offsets=offsets,
            measured={column: numbers[name] for name, column in given.items()},
            device=device,
            devices=devices,
        )
    except InputError as error:
        raise invalid_value(error.field, error.message) from error
    return Recorded(recording, time, form, is_many=names is not None), arguments


def _devices(raw: msgspec.Raw) -> list[str]:
    """Names of the devices; empty where one is missing."""
    names = ["" if name is None else str(name) for name in decode_column(_NAMES, raw, "device")]
    if all(len(name) <= _LONGEST_NAME and name.isprintable() for name in set(names)):
        return names
    row = next(k for k, name in enumerate(names) if len(name) > _LONGEST_NAME or not name.isprintable())
    raise invalid_value("device", f"expected at most {_LONGEST_NAME} printable characters", row)


def check_lengths(rows: int, lengths: Mapping[str, int]) -> None:
    """Refuse columns of another length than the times."""
    for name, length in lengths.items():
        if length != rows:
            raise invalid_value(name, f"{length} entries for {rows} times; send one per time")
