"""Answers of a batch as JSON: columns in one document, rows one per line, or features on a map.

Every writer is a generator of bytes over an answer's parts, so that a part can leave before the next is
fitted; the document of columns alone has to wait for all of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import orjson

from service.codecs.batch.answer import Answer
from service.codecs.batch.cells_out import to_rows, to_values
from service.errors import Problem, ProblemType


def write_json(answer: Answer) -> Iterator[bytes]:
    """One document: what was asked for, and a column per number."""
    columns: dict[str, list[Any]] = {}
    for part in answer.parts:
        for name, column in zip(part.schema.names, part.columns, strict=True):
            columns.setdefault(name, []).extend(to_values(column))
    head = {
        "model": answer.model,
        "method": answer.method,
        "level": answer.level,
        "seed": answer.seed,
        "time_unit": answer.time_unit,
    }
    yield orjson.dumps(head | {"columns": columns})


def write_ndjson(answer: Answer) -> Iterator[bytes]:
    """One object per series and line."""
    for part in answer.parts:
        yield b"".join(orjson.dumps(row, option=orjson.OPT_APPEND_NEWLINE) for row in to_rows(part))


def write_geojson(answer: Answer) -> Iterator[bytes]:
    """One feature per series (RFC 7946), its numbers as properties; without a position it has no geometry.

    Raises
    ------
    Problem
        406 if the table has no positions.
    """
    if not answer.has_positions:
        raise Problem(
            ProblemType.not_acceptable,
            "GeoJSON needs the columns lat and lon, in degrees; send them, or ask for another format",
        )
    opening = b'{"type":"FeatureCollection","features":[\n'
    for part in answer.parts:
        features = [orjson.dumps(_feature(row)) for row in to_rows(part)]
        yield opening + b",\n".join(features)
        opening = b",\n"
    yield b"\n]}\n"


def _feature(row: dict[str, Any]) -> dict[str, Any]:
    lat, lon = row.pop("lat"), row.pop("lon")
    # NaN is not equal to itself: such a series has no position.
    geometry = {"type": "Point", "coordinates": [lon, lat]} if lat == lat and lon == lon else None  # noqa: PLR0124
    return {"type": "Feature", "id": row["series"], "geometry": geometry, "properties": row}
