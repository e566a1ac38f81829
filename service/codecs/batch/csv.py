"""A batch as CSV in long form: a header, and one line per row of ``series,time,value``.

Cells are read as text, in blocks, and made numbers and times here, so that an error names its row and
nothing is guessed from a column's first cells but whether its times are ISO 8601.
"""

from __future__ import annotations

import csv
import io
import re
from typing import Any

import pyarrow as pa
import pyarrow.csv as arrow_csv

from service.codecs.batch.rows import Batch, Gatherer, Reading
from service.errors import FieldError, Problem, ProblemType

#: Bytes of a block; a row must fit into one.
BLOCK = 4 * 2**20

#: The widest header taken: a reader that opens a builder per column could be drowned in commas.
MAX_COLUMNS = 2_000

_ROW = re.compile(r"Row #(\d+)")
_WIDTHS = re.compile(r"Expected (\d+) columns, got (\d+)")


def read_csv(source: Any, reading: Reading, delimiter: str = ",") -> Batch:
    """Batch of a CSV body.

    Parameters
    ----------
    source : pyarrow.NativeFile
        Seekable.
    reading : Reading
    delimiter : str
        One character.

    Raises
    ------
    Problem
        If the body is not CSV in UTF-8, a column is not there, or a cell cannot be read.
    """
    header = _header(source, delimiter)
    places = reading.choose([name.strip() for name in header])
    wanted = [header[place] for place in places.values()]
    kinds = {name: pa.large_string() for name in wanted}
    kinds[header[places["series"]]] = pa.dictionary(pa.int32(), pa.string())
    gatherer = Gatherer(reading, numbers_as_text=True)
    try:
        table = arrow_csv.open_csv(
            source,
            read_options=arrow_csv.ReadOptions(block_size=BLOCK, use_threads=False),
            parse_options=arrow_csv.ParseOptions(delimiter=delimiter, newlines_in_values=True),
            # Only an empty cell is null here: a series may well be called NA.
            convert_options=arrow_csv.ConvertOptions(
                include_columns=wanted, column_types=kinds, strings_can_be_null=True, null_values=[""]
            ),
        )
        for piece in table:
            gatherer.add(dict(zip(places, piece.columns, strict=True)))
    except (pa.ArrowException, OSError) as error:
        raise _malformed(str(error)) from None
    return gatherer.finish()


def _header(source: Any, delimiter: str) -> list[str]:
    """Names of the columns; the source is left at its start."""
    head = source.read(BLOCK)
    source.seek(0)
    text = head.decode("utf-8-sig", errors="replace")
    if len(head) == BLOCK:
        text = text.rpartition("\n")[0]
    try:
        rows = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
        header = next((row for row in rows if row), None)
    except csv.Error:
        raise Problem(
            ProblemType.malformed_body, "the header of the CSV is broken: check its quotes"
        ) from None
    if header is None:
        raise Problem(ProblemType.empty_body)
    if len(header) > MAX_COLUMNS:
        raise Problem(
            ProblemType.malformed_body, f"the header has more than {MAX_COLUMNS} columns; send those needed"
        )
    return header


def _malformed(told: str) -> Problem:
    """Problem of a table that falls apart; what Arrow says of the caller's cells is not repeated."""
    found = _ROW.search(told)
    # Arrow counts the header, and from 1.
    row = max(0, int(found[1]) - 2) if found else None
    widths = _WIDTHS.search(told)
    if widths is not None:
        message = f"a row has {widths[2]} cells, the header has {widths[1]}"
    elif "UTF8" in told:
        message = "the CSV is not valid UTF-8"
    else:
        message = "the CSV is broken: check its quotes and that every row has as many cells as the header"
    return Problem(ProblemType.malformed_body, message, errors=[FieldError("body", message, row)])
