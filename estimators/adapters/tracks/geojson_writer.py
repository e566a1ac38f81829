"""A cleaned track as GeoJSON (RFC 7946): :func:`write_geojson`, lines for maps, or points with properties."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from itertools import chain

import numpy as np

from estimators.adapters.tracks.antimeridian import Piece, cut_line
from estimators.adapters.tracks.cleaned import Cleaned
from estimators.adapters.tracks.recording import Recording
from estimators.adapters.tracks.written_columns import (
    PIECE_ROWS,
    Column,
    Layout,
    clock_texts,
    clock_unit,
    position_digits,
    positions,
    written_columns,
)
from estimators.arrays import FloatArray, IntArray

_HEAD = b'{"type":"FeatureCollection","features":[\n'
_TAIL = b"\n]}\n"


def write_geojson(
    recording: Recording, cleaned: Cleaned | None = None, *, points: bool = False
) -> Iterator[bytes]:
    r"""Write a feature for each device, or one for each fix.

    Parameters
    ----------
    recording : Recording
    cleaned : Cleaned, optional
        Default: the recording as it is.
    points : bool
        A Point for each row, in input order, with all columns as properties; its geometry is null where there
        is no position. Default: a LineString or MultiLineString for each device in order of time, with
        ``coordTimes``; segments are lines of their own, lines are cut at longitude 180, a segment of one fix
        is a Point, and rows without time or position are left out.

    Returns
    -------
    iterator of bytes
        Pieces of the file.

    Raises
    ------
    InputError
        If the two differ in length.

    Examples
    --------
    >>> from estimators.adapters.tracks import read_track
    >>> track = read_track(b"t,lat,lon\n0,50,7\n1,50,8\n")
    >>> json.loads(b"".join(write_geojson(track)))["features"][0]["properties"]
    {'coordTimes': [0, 1]}
    """
    columns = written_columns(recording, cleaned)
    if not points:
        return _lines(recording, cleaned)
    return chain([_HEAD], _points(columns, len(recording)), [_TAIL])


def stream_geojson_points(pairs: Iterable[tuple[Recording, Cleaned]], layout: Layout) -> Iterator[bytes]:
    """Write a point for each row as they come; otherwise as :func:`write_geojson` does."""
    yield _HEAD
    comma = b""
    for recording, cleaned in pairs:
        for piece in _points(written_columns(recording, cleaned, layout), len(recording)):
            yield comma + piece
            comma = b",\n"
    yield _TAIL


def _points(columns: dict[str, Column], n: int) -> Iterator[bytes]:
    named = [column for name, column in columns.items() if name not in {"lat", "lon", "height_m"}]
    for start in range(0, n, PIECE_ROWS):
        part = slice(start, min(start + PIECE_ROWS, n))
        lat, lon = columns["lat"].text(part), columns["lon"].text(part)
        height = columns["height_m"].text(part) if "height_m" in columns else [None] * len(lat)
        values = [_values(column, part) for column in named]
        rows = [
            _point(*position, ",".join(row))
            for position, row in zip(
                zip(lon, lat, height, strict=True), zip(*values, strict=True), strict=True
            )
        ]
        yield (",\n" if start else "").encode() + ",\n".join(rows).encode()


def _values(column: Column, part: slice) -> list[str]:
    name = json.dumps(column.name)
    texts = column.text(part)
    if column.kind == "text":
        return [f"{name}:{json.dumps(text)}" for text in texts]
    return [f"{name}:{'null' if text is None else text}" for text in texts]


def _point(lon: str | None, lat: str | None, height: str | None, properties: str) -> str:
    geometry = "null"
    if lat is not None and lon is not None:
        third = "" if height is None else f",{height}"
        geometry = f'{{"type":"Point","coordinates":[{lon},{lat}{third}]}}'
    return f'{{"type":"Feature","geometry":{geometry},"properties":{{{properties}}}}}'


def _lines(recording: Recording, cleaned: Cleaned | None) -> Iterator[bytes]:
    yield _HEAD
    lat, lon, height = positions(recording, cleaned)
    moment = recording.time.astype("datetime64[ns]") if recording.time.dtype.kind == "M" else recording.time
    timed = ~np.isnat(moment) if moment.dtype.kind == "M" else np.isfinite(moment)
    rows = np.flatnonzero(timed & np.isfinite(lat) & np.isfinite(lon))
    device = np.zeros(len(recording), dtype=np.int64) if recording.device is None else recording.device
    segment = np.zeros(len(recording), dtype=np.int64) if recording.segment is None else recording.segment
    rows = rows[np.lexsort((moment[rows], segment[rows], device[rows]))]
    digits = position_digits(recording)
    comma = b""
    for place in np.unique(device[rows]).tolist():
        own = rows[device[rows] == place]
        groups = np.split(own, np.flatnonzero(np.diff(segment[own])) + 1)
        name = recording.devices[place] if recording.devices else None
        lines: list[tuple[str, str]] = []
        for group in groups:
            column = None if height is None or not np.isfinite(height[group]).all() else height
            if group.size == 1:
                ((where, when),) = _texts(recording, group, lon, lat, column, digits)
                geometry = f'{{"type":"Point","coordinates":{where[1:-1]}}}'
                yield comma + _feature(geometry, name, f'"time":{when[1:-1]}')
                comma = b",\n"
            else:
                lines += _texts(recording, group, lon, lat, column, digits)
        if lines:
            yield comma + _line_feature(lines, name)
            comma = b",\n"
    yield _TAIL


def _line_feature(lines: list[tuple[str, str]], name: str | None) -> bytes:
    where, when = lines[0]
    kind = "LineString"
    if len(lines) > 1:
        kind = "MultiLineString"
        where = "[" + ",".join(part for part, _ in lines) + "]"
        when = "[" + ",".join(part for _, part in lines) + "]"
    return _feature(f'{{"type":"{kind}","coordinates":{where}}}', name, f'"coordTimes":{when}')


def _feature(geometry: str, name: str | None, properties: str) -> bytes:
    own = "" if name is None else f'"device":{json.dumps(name)},'
    return f'{{"type":"Feature","geometry":{geometry},"properties":{{{own}{properties}}}}}'.encode()


def _texts(
    recording: Recording,
    group: IntArray,
    lon: FloatArray,
    lat: FloatArray,
    height: FloatArray | None,
    digits: int,
) -> list[tuple[str, str]]:
    """Coordinates and times of each piece of a line, as JSON lists."""
    # The place along the rows is cut along with them, and tells at which time a crossing was.
    columns = [lon[group], lat[group], np.arange(group.size, dtype=np.float64)]
    if height is not None:
        columns.append(height[group])
    return [
        (_coordinates(piece, digits), _times(recording, group, piece[:, 2]))
        for piece in cut_line(np.column_stack(columns))
    ]


def _coordinates(piece: Piece, digits: int) -> str:
    if piece.shape[1] == 3:
        rows = [f"[{row[0]:.{digits}f},{row[1]:.{digits}f}]" for row in piece.tolist()]
    else:
        rows = [f"[{row[0]:.{digits}f},{row[1]:.{digits}f},{row[3]:.3f}]" for row in piece.tolist()]
    return "[" + ",".join(rows) + "]"


def _times(recording: Recording, group: IntArray, places: FloatArray) -> str:
    """Write times of rows, and of crossings between them: interpolated, in the zone of the row before."""
    before = np.floor(places).astype(np.int64)
    after = np.minimum(before + 1, group.size - 1)
    share = places - before
    time = recording.time[group]
    if time.dtype.kind != "M":
        seconds: FloatArray = time.astype(np.float64)
        values = seconds[before] + np.where(share > 0.0, share * (seconds[after] - seconds[before]), 0.0)
        return "[" + ",".join(repr(value).removesuffix(".0") for value in values.tolist()) + "]"
    stamps = time.astype("datetime64[ns]").astype(np.int64)
    gaps = stamps[after] - stamps[before]
    unit = clock_unit(recording)
    # A crossing has no time of its own: milliseconds are enough, unless the track itself has finer ones.
    step = 1_000_000 if unit in {"s", "ms"} else 1
    moments = stamps[before] + np.floor(share * gaps / step).astype(np.int64) * step
    offsets = recording.utc_offset_minutes
    own = Recording(
        recording.form,
        moments.astype("datetime64[ns]"),
        places,
        places,
        np.zeros(places.size, dtype=np.uint8),
        utc_offset_minutes=None if offsets is None else offsets[group][before],
    )
    return json.dumps(clock_texts(own, slice(None), clock_unit(own)), separators=(",", ":"))
