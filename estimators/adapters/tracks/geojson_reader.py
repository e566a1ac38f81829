"""GeoJSON to a :class:`Recording`: lines with ``coordTimes``, and points with a time among their properties.

RFC 7946 has no place for times; ``coordTimes`` is what togeojson, Mapbox and most converters write, newer
ones ``coordinateProperties.times``. Coordinates are longitude, latitude and perhaps height.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import IO, Any

import numpy as np

from estimators.adapters.tracks.assembly import RANGES, assemble, code_names
from estimators.adapters.tracks.field_names import find_columns
from estimators.adapters.tracks.recording import FIELD, Recording
from estimators.adapters.tracks.times import times_of_values
from estimators.arrays import FloatArray, InputError

_TIMES = ("coordTimes", "times", "timestamps")


class _Rows:
    """Columns that grow as features are read."""

    def __init__(self) -> None:
        self.positions: list[Any] = []
        self.times: list[Any] = []
        self.segment: list[int] = []
        self.device: list[str] = []
        self.measured: dict[str, dict[int, Any]] = {}
        self.pieces = 0


def read_geojson(stream: IO[bytes]) -> Recording:
    """Read a FeatureCollection, a Feature or a bare line.

    Raises
    ------
    InputError
        If it is no JSON, no GeoJSON, holds neither lines nor points, or lacks times.

    Examples
    --------
    >>> import io
    >>> body = b'{"type": "LineString", "coordinates": [[7, 50]], "coordTimes": ["2021-07-28T07:00:00Z"]}'
    >>> read_geojson(io.BytesIO(body)).lat
    array([50.])
    """
    try:
        document = json.loads(stream.read())
    except InputError:
        raise
    except (ValueError, RecursionError) as error:
        place = f" at character {error.pos}" if isinstance(error, json.JSONDecodeError) else ""
        raise InputError(FIELD, f"is not valid JSON{place}; was it cut off?") from error
    rows = _Rows()
    for feature in _features(document):
        _take(feature, rows)
    if not rows.positions:
        raise InputError(FIELD, "is GeoJSON without lines or points; send LineString or Point features")
    time, offsets, bad_time = times_of_values(rows.times)
    triples = [_numbers(position) for position in rows.positions]
    coordinates = np.array(triples, dtype=np.float64)
    device, devices = code_names(rows.device)
    measured: dict[str, FloatArray] = {"height_m": coordinates[:, 2]}
    for column, found in rows.measured.items():
        if column == "height_m":
            continue
        values = np.full(len(triples), np.nan)
        values[list(found)] = [_number(value) for value in found.values()]
        measured[column] = values
    if "height_m" in rows.measured:
        own = rows.measured["height_m"]
        heights = measured["height_m"].copy()
        heights[list(own)] = [_number(value) for value in own.values()]
        measured["height_m"] = np.where(np.isnan(coordinates[:, 2]), heights, coordinates[:, 2])
    unreadable = np.isnan(coordinates[:, :2]).any(axis=1) & np.array(
        [position is not None for position in rows.positions]
    )
    return assemble(
        "geojson",
        time=time,
        lat=coordinates[:, 1].copy(),
        lon=coordinates[:, 0].copy(),
        time_unreadable=bad_time,
        position_unreadable=unreadable,
        offsets=offsets,
        measured=measured,
        device=device,
        devices=devices if any(devices) else (),
        segment=np.array(rows.segment, dtype=np.int64),
    )


def _features(document: Any) -> Iterator[dict[str, Any]]:
    """Features of a document; a bare geometry is a feature whose foreign members are its properties."""
    if not isinstance(document, dict) or not isinstance(document.get("type"), str):
        raise InputError(FIELD, "is JSON but not GeoJSON: the outermost object needs a type")
    kind = document["type"]
    if kind == "FeatureCollection":
        features = document.get("features")
        if not isinstance(features, list):
            raise InputError(FIELD, "is a FeatureCollection whose features are not a list")
        yield from (feature for feature in features if isinstance(feature, dict))
    elif kind == "Feature":
        yield document
    else:
        yield {"geometry": document, "properties": document}


def _take(feature: Mapping[str, Any], rows: _Rows) -> None:
    geometry, properties = feature.get("geometry"), feature.get("properties")
    properties = properties if isinstance(properties, dict) else {}
    if geometry is None:
        _take_point(None, properties, rows)
        return
    if not isinstance(geometry, dict):
        raise InputError(FIELD, "has a feature whose geometry is not an object")
    kind, coordinates = geometry.get("type"), geometry.get("coordinates")
    if kind == "Point":
        _take_point(coordinates, properties, rows)
    elif kind in {"LineString", "MultiLineString"}:
        if not isinstance(coordinates, list):
            raise InputError(FIELD, f"has a {kind} whose coordinates are not a list")
        times = _line_times(properties, geometry)
        lines = coordinates if kind == "MultiLineString" else [coordinates]
        moments = times if kind == "MultiLineString" and times and isinstance(times[0], list) else [times]
        if len(moments) == 1 and len(lines) > 1:
            moments = _cut(times, lines)
        if [len(line) if isinstance(line, list) else -1 for line in lines] != [
            len(part) if isinstance(part, list) else -1 for part in moments
        ]:
            raise InputError("coordTimes", "must hold one time for each position of the line")
        for line, part in zip(lines, moments, strict=True):
            _extend(line, part, str(_device(properties) or properties.get("name") or ""), rows)


@lru_cache(maxsize=64)
def _columns_of(names: tuple[str, ...]) -> dict[str, str]:
    """Look up the columns once for all features that have the same properties."""
    return find_columns(names)


def _extend(line: list[Any], moments: list[Any], device: str, rows: _Rows) -> None:
    rows.positions += line
    rows.times += moments
    rows.segment += [rows.pieces] * len(line)
    rows.device += [device] * len(line)
    rows.pieces += 1


def _take_point(position: Any, properties: Mapping[str, Any], rows: _Rows) -> None:
    named = _columns_of(tuple(properties))
    row = len(rows.positions)
    rows.positions.append(position)
    time = named.get("time", named.get("date"))
    rows.times.append(None if time is None else properties[time])
    piece = properties[named["segment"]] if "segment" in named else 0
    rows.segment.append(piece if isinstance(piece, int) and 0 <= piece < 1 << 31 else 0)
    rows.device.append(str(_device(properties) or ""))
    for column in RANGES:
        if column in named:
            rows.measured.setdefault(column, {})[row] = properties[named[column]]


def _device(properties: Mapping[str, Any]) -> Any:
    named = _columns_of(tuple(properties))
    return properties[named["device"]] if "device" in named else None


def _line_times(properties: Mapping[str, Any], geometry: Mapping[str, Any]) -> list[Any]:
    nested = properties.get("coordinateProperties")
    for place in (properties, nested if isinstance(nested, dict) else {}, geometry):
        for name in _TIMES:
            if isinstance(place.get(name), list):
                return list(place[name])
    raise InputError("coordTimes", "is missing: a line needs a list of times among its properties")


def _cut(times: list[Any], lines: list[Any]) -> list[list[Any]]:
    """One list of times for a line of several pieces, cut as the line is."""
    parts, start = [], 0
    for line in lines:
        size = len(line) if isinstance(line, list) else 0
        parts.append(times[start : start + size])
        start += size
    return [*parts[:-1], times[start - len(parts[-1]) :]] if parts else []


def _numbers(position: Any) -> tuple[float, float, float]:
    if not isinstance(position, list) or len(position) < 2:
        return np.nan, np.nan, np.nan
    return _number(position[0]), _number(position[1]), _number(position[2]) if len(position) > 2 else np.nan


def _number(value: Any) -> float:
    """Read a finite number of JSON; NaN for anything else (true and "12" included)."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return np.nan
    try:
        number = float(value)
    except OverflowError:
        return np.nan
    return number if np.isfinite(number) else np.nan
