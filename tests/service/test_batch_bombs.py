"""Small bodies that would unpack to very much are refused before they are unpacked."""

from __future__ import annotations

import io
import struct

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fastapi.testclient import TestClient

from service.codecs.batch.arrow_messages import sizes_of
from service.codecs.batch.parquet_pages import pages_of
from service.codecs.batch.registry import ARROW_STREAM, PARQUET
from service.errors import Problem, ProblemType
from tests.service.tables import ENDPOINT, as_parquet, as_stream, long_table

#: The clients of these tests take 200 kB and 5000 rows.
MANY = 10**7


def ask(client: TestClient, body: bytes, media_type: str) -> tuple[int, str]:
    assert len(body) < 200_000
    before = pa.default_memory_pool().bytes_allocated()
    response = client.post(ENDPOINT, content=body, headers={"content-type": media_type})
    assert pa.default_memory_pool().bytes_allocated() - before < 2**20
    return response.status_code, response.json().get("type", "")


def constant(rows: int) -> pa.Table:
    return pa.table(
        {
            "series": pa.DictionaryArray.from_arrays(np.zeros(rows, np.int8), ["a"]),
            "time": np.zeros(rows, np.int8),
            "value": np.zeros(rows, np.int8),
        }
    )


def wordy(rows: int = 1_000) -> pa.Table:
    """Long names that compress to nothing."""
    return pa.table({"series": ["a" * 1_000] * rows, "time": range(rows), "value": [0.0] * rows})


def test_a_parquet_file_of_very_many_equal_rows_is_refused_by_its_footer(client: TestClient) -> None:
    body = as_parquet(constant(MANY), compression="zstd")
    assert ask(client, body, PARQUET) == (413, ProblemType.too_many_points.uri)


def test_a_parquet_file_that_unpacks_to_too_much_is_refused(client: TestClient) -> None:
    body = as_parquet(wordy(), compression="zstd", use_dictionary=False)
    assert ask(client, body, PARQUET) == (413, ProblemType.body_too_large.uri)


def test_names_that_are_written_once_may_be_long(client: TestClient) -> None:
    body = as_parquet(wordy(), compression="zstd", use_dictionary=["series"])
    assert ask(client, body, PARQUET) == (200, "")


def test_an_encoding_by_which_text_grows_without_bound_is_refused(client: TestClient) -> None:
    body = as_parquet(wordy(), use_dictionary=False, column_encoding={"series": "DELTA_BYTE_ARRAY"})
    assert ask(client, body, PARQUET) == (400, ProblemType.malformed_body.uri)


def test_columns_that_are_not_needed_may_be_anything(client: TestClient) -> None:
    wide = long_table().append_column("junk", pa.array([["x" * 10_000] * 3] * 120))
    assert ask(client, as_parquet(wide, compression="zstd"), PARQUET) == (200, "")


@pytest.mark.parametrize("compression", ["none", "snappy", "gzip", "zstd"])
def test_what_the_pages_say_is_what_the_footer_says(compression: str) -> None:
    body = as_parquet(long_table(40), compression=compression, data_page_version="2.0")
    metadata = pq.ParquetFile(io.BytesIO(body)).metadata
    for place in range(3):
        chunk = metadata.row_group(0).column(place)
        start = chunk.dictionary_page_offset or chunk.data_page_offset
        pages = list(pages_of(body[start : start + chunk.total_compressed_size]))
        # The footer counts the headers of the pages too.
        told = chunk.total_uncompressed_size
        assert told - 100 * len(pages) < sum(page.bytes for page in pages) < told


@pytest.mark.parametrize("chunk", [b"\x15", b"\xff" * 20, b"\x15\x00\x15\x02\x15\x7f\x00", b"\x1c" * 50])
def test_bytes_that_are_no_pages_are_refused(chunk: bytes) -> None:
    with pytest.raises(Problem) as caught:
        list(pages_of(chunk))
    assert caught.value.kind is ProblemType.malformed_body


@pytest.mark.parametrize("codec", ["zstd", "lz4"])
def test_an_arrow_stream_that_unpacks_to_too_much_is_refused(client: TestClient, codec: str) -> None:
    body = as_stream(wordy(), compression=codec)
    assert ask(client, body, ARROW_STREAM) == (413, ProblemType.body_too_large.uri)


def test_a_compressed_arrow_stream_within_bounds_is_answered(client: TestClient) -> None:
    assert ask(client, as_stream(long_table(), compression="zstd"), ARROW_STREAM) == (200, "")


def test_an_arrow_buffer_that_claims_a_terabyte_is_refused_before_it_is_allocated(client: TestClient) -> None:
    table = pa.table({"series": ["a"] * 500, "time": [0] * 500, "value": [0.0] * 500})
    body = as_stream(table, compression="zstd")
    honest = struct.pack("<q", 4_000)
    assert honest in body
    assert ask(client, body.replace(honest, struct.pack("<q", 2**40)), ARROW_STREAM) == (
        413,
        ProblemType.body_too_large.uri,
    )


@pytest.mark.parametrize("kind", ["nulls", "runs"])
def test_rows_that_take_no_bytes_are_counted(client: TestClient, kind: str) -> None:
    column = pa.nulls(MANY) if kind == "nulls" else pa.RunEndEncodedArray.from_arrays([MANY], ["a"])
    table = pa.table({"series": column, "time": pa.nulls(MANY), "value": pa.nulls(MANY)})
    assert ask(client, as_stream(table), ARROW_STREAM) == (413, ProblemType.too_many_points.uri)


def test_the_size_of_a_message_is_that_of_its_columns() -> None:
    table = pa.table({"value": np.arange(1_000.0)})
    for options, slack in (({}, 64), ({"compression": "zstd"}, 64)):
        messages = pa.ipc.MessageReader.open_stream(as_stream(table, **options))
        sizes = [sizes_of(message) for message in messages]
        assert sum(size.rows for size in sizes) == 1_000
        assert 8_000 <= sum(size.bytes for size in sizes) <= 8_000 + slack
