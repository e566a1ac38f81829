"""Tables as Parquet: only the columns needed, row group by row group, in pieces of bounded size.

What the footer and then the pages say they hold is checked before anything is unpacked. Columns of text
stay dictionary-encoded, so that a name that a million rows share is one name in memory.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from service.codecs.batch.parquet_pages import DELTA_BYTE_ARRAY, pages_of
from service.codecs.batch.rows import Batch, Gatherer, Reading
from service.codecs.batch.taking import Choice, Take
from service.errors import Problem, ProblemType, invalid_value

MAGIC = b"PAR1"

#: Rows that are decoded at one time.
PIECE = 65_536

#: Bytes and elements a footer may make Thrift allocate for one string or list.
_FOOTER_BYTES = 16 * 2**20
_FOOTER_ELEMENTS = 200_000

#: Nesting of a schema; the columns of a batch have none.
_DEEPEST_SCHEMA = 32


def read_parquet(source: Any, reading: Reading) -> Batch:
    """Batch of a Parquet file.

    Parameters
    ----------
    source : pyarrow.NativeFile
        Seekable.
    reading : Reading

    Raises
    ------
    Problem
        If the bytes are no Parquet, a column is not there, or holds what it should not.
    """
    gatherer = Gatherer(reading)
    take_parquet(source, reading, gatherer.add)
    return gatherer.finish()


def take_parquet(source: Any, reading: Choice, take: Take) -> None:
    """Hand over the pieces of a Parquet file, the columns chosen by their roles.

    Parameters
    ----------
    source : pyarrow.NativeFile
        Seekable.
    reading : Choice
    take : callable
        Called with the columns of each piece.

    Raises
    ------
    Problem
        If the bytes are no Parquet.
    """
    try:
        names, places = _columns(source, reading)
        file = _open(source, read_dictionary=[names[place] for place in places.values()])
        order = {names[place]: role for role, place in places.items()}
        for piece in file.iter_batches(PIECE, columns=list(order), use_threads=False):
            piece.validate(full=True)
            take({order[name]: piece.column(name) for name in piece.schema.names})
    except (pa.ArrowException, OSError, UnicodeDecodeError):
        raise Problem(
            ProblemType.malformed_body, "the Parquet file is broken or ends before it is complete"
        ) from None


def _open(source: Any, **options: Any) -> pq.ParquetFile:
    source.seek(0)
    return pq.ParquetFile(
        source,
        thrift_string_size_limit=_FOOTER_BYTES,
        thrift_container_size_limit=_FOOTER_ELEMENTS,
        schema_depth_limit=_DEEPEST_SCHEMA,
        arrow_extensions_enabled=False,
        # Reading ahead would hold all row groups at once.
        pre_buffer=False,
        **options,
    )


def _columns(source: Any, reading: Choice) -> tuple[list[str], dict[str, int]]:
    """Choose the columns and refuse what would be too much, from metadata alone."""
    file = _open(source)
    metadata = file.metadata
    reading.limits.check_points(metadata.num_rows)
    names = list(file.schema_arrow.names)
    places = reading.choose(names)
    # A nested column has several leaves; those of the columns chosen have their own name as path.
    leaves = {metadata.schema.column(k).path: k for k in range(metadata.num_columns)}
    chosen = {role: leaves.get(names[place]) for role, place in places.items()}
    for role, leaf in chosen.items():
        if leaf is None:
            raise invalid_value(role, "is a nested column; send plain ones")
    if reading.limits.unpacked_bytes is not None:
        _check_sizes(source, metadata, [leaf for leaf in chosen.values() if leaf is not None], reading)
    return names, places


def _check_sizes(source: Any, metadata: Any, leaves: list[int], reading: Choice) -> None:
    told = [
        metadata.row_group(group).column(leaf) for group in range(metadata.num_row_groups) for leaf in leaves
    ]
    reading.limits.check_bytes(sum(max(0, chunk.total_uncompressed_size) for chunk in told))
    unpacked = 0
    for chunk in told:
        reading.check()
        for page in _pages(source, chunk):
            unpacked += page.bytes
            reading.limits.check_bytes(unpacked)
            if page.encoding == DELTA_BYTE_ARRAY:
                raise Problem(
                    ProblemType.malformed_body,
                    "a column is encoded as DELTA_BYTE_ARRAY, which is not taken; write it with a dictionary",
                )


def _pages(source: Any, chunk: Any) -> Iterator[Any]:
    start = chunk.data_page_offset
    if chunk.dictionary_page_offset is not None and 0 < chunk.dictionary_page_offset < start:
        start = chunk.dictionary_page_offset
    if start < 0 or chunk.total_compressed_size < 0:
        raise Problem(ProblemType.malformed_body, "the Parquet file is broken: a column lies outside of it")
    source.seek(start)
    return pages_of(source.read(chunk.total_compressed_size))
