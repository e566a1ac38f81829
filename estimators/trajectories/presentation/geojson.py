"""A track as GeoJSON (RFC 7946): lines cut at the antimeridian, as its section 3.1.9 asks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from estimators.presentation.json_values import numbers_to_json
from estimators.trajectories.presentation.dictionary import times

if TYPE_CHECKING:
    from estimators.arrays import IntArray
    from estimators.trajectories.track import Track

_DIGITS = 8
"""Of degrees: a millimetre."""


def track_to_geojson(track: Track, *, points: bool = False) -> dict[str, Any]:
    """Feature collection of the smoothed track.

    Parameters
    ----------
    track : Track
    points : bool
        Whether to add a feature per row: where it was measured, its label and how sure that is.

    Returns
    -------
    dict
        The first feature is the line, with ``coordTimes`` of the vertices as other tools write them.
    """
    rows = np.flatnonzero(np.isfinite(track.lat_deg))
    rows = rows[np.argsort(track.time[rows], kind="stable")]
    features = [_line(track, rows)]
    if points:
        features += _points(track)
    return {"type": "FeatureCollection", "features": features}


def _line(track: Track, rows: IntArray) -> dict[str, Any]:
    vertices, stamps = _vertices(track, rows), [times(track.time)[row] for row in rows]
    parts: list[list[list[float]]] = [[]]
    marks: list[list[Any]] = [[]]
    for vertex, stamp in zip(vertices, stamps, strict=True):
        if parts[-1] and abs(vertex[0] - parts[-1][-1][0]) > 180.0:
            last = parts[-1][-1]
            edge = 180.0 if last[0] > 0.0 else -180.0
            share = (edge - last[0]) / (vertex[0] + 2.0 * edge - last[0])
            crossing = [a + share * (b - a) for a, b in zip(last[1:], vertex[1:], strict=True)]
            parts[-1].append([edge, *(round(value, _DIGITS) for value in crossing)])
            marks[-1].append(stamp)
            parts.append([[-edge, *(round(value, _DIGITS) for value in crossing)]])
            marks.append([stamp])
        parts[-1].append(vertex)
        marks[-1].append(stamp)
    # A line has two positions or more.
    for part, stamp_list in zip(parts, marks, strict=True):
        if len(part) == 1:
            part.append(part[0])
            stamp_list.append(stamp_list[0])
    geometry: dict[str, Any] = {"type": "LineString", "coordinates": parts[0]}
    if len(parts) > 1:
        geometry = {"type": "MultiLineString", "coordinates": parts}
    return {
        "type": "Feature",
        "geometry": geometry,
        "properties": {
            "method": track.method,
            "distance_m": track.distance.cleaned.value,
            "inliers": int(track.points.inlier.sum()),
            "rows": len(track),
            "coordTimes": marks[0] if len(parts) == 1 else marks,
        },
    }


def _vertices(track: Track, rows: IntArray) -> list[list[float]]:
    columns = [track.lon_deg[rows], track.lat_deg[rows]]
    if track.height_m is not None:
        columns.append(track.height_m[rows])
    return [[round(value, _DIGITS) for value in vertex] for vertex in np.column_stack(columns).tolist()]


def _points(track: Track) -> list[dict[str, Any]]:
    stamps, reasons = times(track.time), track.points.reason
    probability, sigma = numbers_to_json(track.points.probability), numbers_to_json(track.sigma_m)
    features = []
    for row in np.flatnonzero(np.isfinite(track.input_lat_deg)).tolist():
        place = [float(track.input_lon_deg[row]), float(track.input_lat_deg[row])]
        features.append(
            {
                "type": "Feature",
                "geometry": {"type": "Point", "coordinates": [round(value, _DIGITS) for value in place]},
                "properties": {
                    "row": row,
                    "time": stamps[row],
                    "inlier": bool(track.points.inlier[row]),
                    "probability": probability[row],
                    "reason": reasons[row],
                    "sigma_m": sigma[row],
                },
            }
        )
    return features
