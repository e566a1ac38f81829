"""The served OpenAPI document, taken at its word by a machine that tries to break it."""

from __future__ import annotations

from typing import Any

import pyarrow as pa
import schemathesis
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import positive_data_acceptance

from service.codecs.batch.registry import ARROW_FILE, ARROW_STREAM, PARQUET
from service.main import create_app
from service.settings import Settings
from tests.service.tables import as_csv, as_file, as_parquet, as_stream

ROWS = st.lists(
    st.tuples(st.integers(0, 10**6), st.floats(-1e6, 1e6, allow_nan=False)), min_size=1, max_size=12
)


def table(rows: list[tuple[int, float]]) -> pa.Table:
    """Two series, or one where nobody asks for names."""
    times, values = zip(*rows, strict=True)
    return pa.table({"series": [f"s{row % 2}" for row in range(len(rows))], "time": times, "value": values})


for media_type, write in (
    ("text/csv", as_csv),
    (ARROW_STREAM, as_stream),
    (ARROW_FILE, as_file),
    (PARQUET, as_parquet),
):
    schemathesis.openapi.media_type(media_type, ROWS.map(table).map(write))

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
