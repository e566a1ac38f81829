"""JSON and CSV bodies of pseudoranges."""

from __future__ import annotations

import msgspec

from service.codecs.arguments import refuse_absent, refuse_beside_json
from service.codecs.columns import TimeForm, Times
from service.codecs.csv import read_cells, read_time_cells, split_table
from service.codecs.json import (
    decode_column,
    is_null,
    read_argument,
    read_numbers,
    read_object,
    read_times,
)
from service.codecs.positions.columns import (
    FIELDS,
    NUMBERS,
    RAW_NUMBERS,
    REQUIRED,
    WORDS,
    RangeColumns,
    checked_words,
    table_arguments,
)
from service.codecs.sent import Sent
from service.errors import invalid_value
from service.schemas.position_query import PositionQuery
from service.schemas.positions import PositionArguments, PositionSettings

_WORD_LIST = msgspec.json.Decoder(list[str])


def read_json_ranges(sent: Sent[PositionQuery]) -> tuple[RangeColumns, PositionArguments]:
    """Columns and arguments of a JSON body.

    Raises
    ------
    Problem
        If the body is not JSON, holds unknown or repeated keys, or a value of the wrong type.
    """
    refuse_beside_json(sent.query.not_json())
    columns = (*FIELDS, *RAW_NUMBERS)
    fields = read_object(sent.content, (*columns, *PositionArguments.model_fields), "")
    arguments = table_arguments(
        {
            name: read_argument(raw, name, tuple(PositionSettings.model_fields))
            for name, raw in fields.items()
            if name not in columns
        }
    )
    refuse_absent([name for name in REQUIRED if is_null(fields.get(name))])
    numbers = {
        name: read_numbers(fields[name], name)
        for name in (*NUMBERS, *RAW_NUMBERS)
        if not is_null(fields.get(name))
    }
    words = {
        name: checked_words(decode_column(_WORD_LIST, fields[name], name), name)
        for name in WORDS
        if not is_null(fields.get(name))
    }
    time: Times | None = None
    form: TimeForm | None = None
    if not is_null(fields.get("time")):
        time, form = read_times(fields["time"], "time", arguments.time_unit)
    return RangeColumns(numbers, words, time, form), arguments


def read_csv_ranges(sent: Sent[PositionQuery]) -> tuple[RangeColumns, PositionArguments]:
    """Columns and arguments of a CSV body; the arguments come from the query string.

    Columns of other names are left alone, and without ``raw`` those that only raw pseudoranges have: tables
    carry more than a position needs.

    Raises
    ------
    Problem
        If the body is not CSV in UTF-8, a column is not there, or a cell cannot be read.
    """
    arguments = table_arguments(sent.query.arguments())
    header, rows = split_table(sent.content)
    refuse_absent([name for name in REQUIRED if name not in header])
    wanted = (*FIELDS, *RAW_NUMBERS) if arguments.raw else FIELDS
    twice = next((name for name in wanted if header.count(name) > 1), None)
    if twice is not None:
        raise invalid_value(twice, "the header has it twice; name each column once")
    cells = {name: [row[header.index(name)] for row in rows] for name in wanted if name in header}
    numbers = {
        name: read_cells(column, name)
        for name, column in cells.items()
        if name not in WORDS and name != "time"
    }
    words = {
        name: checked_words([cell.strip() for cell in cells[name]], name) for name in WORDS if name in cells
    }
    time: Times | None = None
    form: TimeForm | None = None
    if "time" in cells:
        time, form = read_time_cells(cells["time"], "time", arguments.time_unit)
    return RangeColumns(numbers, words, time, form), arguments
