"""The served OpenAPI document, taken at its word by a machine that tries to break it."""

from __future__ import annotations

import gzip
import json
from typing import Any

import pyarrow as pa
import schemathesis
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import positive_data_acceptance

from service.codecs.batch.registry import ARROW_FILE, ARROW_STREAM, PARQUET
from service.codecs.trajectories.registry import GPX
from service.main import create_app
from service.settings import Settings
from tests.service.fixes import as_csv as as_csv_track
from tests.service.fixes import as_geojson, as_gpx, as_kml
from tests.service.tables import as_csv, as_file, as_parquet, as_stream

ROWS = st.lists(
    st.tuples(st.integers(0, 10**6), st.floats(-1e6, 1e6, allow_nan=False)), min_size=1, max_size=12
)


def table(rows: list[tuple[int, float]]) -> pa.Table:
    """Two series, or one where nobody asks for names, of a device that moves."""
    times, values = zip(*rows, strict=True)
    return pa.table(
        {
            "series": [f"s{row % 2}" for row in range(len(rows))],
            "time": times,
            "value": values,
            "lat": [value / 1e4 for value in values],
            "lon": [value / 1e4 for value in values],
        }
    )


def track(rows: list[tuple[int, float]]) -> dict[str, Any]:
    """The same rows as fixes with points in time."""
    times = [f"2024-05-01T{time // 3600 % 24:02d}:{time // 60 % 60:02d}:{time % 60:02d}Z" for time, _ in rows]
    places = [value / 1e4 for _, value in rows]
    return {"time": times, "lat": places, "lon": places}


for media_type, write in (
    ("text/csv", as_csv),
    (ARROW_STREAM, as_stream),
    (ARROW_FILE, as_file),
    (PARQUET, as_parquet),
):
    schemathesis.openapi.media_type(media_type, ROWS.map(table).map(write))
for media_type, write_track in (
    (GPX, as_gpx),
    ("application/vnd.google-earth.kml+xml", as_kml),
    ("application/geo+json", lambda fields: json.dumps(as_geojson(fields)).encode()),
    ("application/octet-stream", lambda fields: gzip.compress(as_csv_track(fields))),
):
    schemathesis.openapi.media_type(media_type, ROWS.map(track).map(write_track))
for media_type in ("application/vnd.google-earth.kmz", "application/vnd.ant.fit", "application/vnd.nmea"):
    schemathesis.openapi.media_type(media_type, st.binary())

api = schemathesis.openapi.from_asgi(
    "/openapi.json", create_app(Settings(log_level="error", deadline_seconds=60))
)


@api.parametrize()
@settings(max_examples=200, deadline=None, suppress_health_check=list(HealthCheck))
def test_every_answer_is_one_that_the_document_describes(case: schemathesis.Case[Any]) -> None:
    # What the schema allows may still make no sense together, such as columns of unequal length.
    excluded: list[Any] = [positive_data_acceptance]
    if case.operation.path == "/readyz":
        excluded.append(not_a_server_error)  # 503 until warm is what it is there for
    case.call_and_validate(excluded_checks=excluded)
