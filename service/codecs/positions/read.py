"""JSON and CSV bodies of pseudoranges."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import msgspec

from service.codecs.columns import TimeForm, Times
from service.codecs.csv import read_cells, read_time_cells, split_table
from service.codecs.json import decode_column, is_null, read_numbers, read_object, read_times
from service.codecs.positions.columns import (
    FIELDS,
    NUMBERS,
    REQUIRED,
    WORDS,
    RangeColumns,
    read_position_arguments,
)
from service.errors import FieldError, Problem, ProblemType, invalid_value
from service.schemas.positions import PositionArguments, PositionQuery, PositionSettings

ReadRanges = Callable[[bytes, PositionQuery], tuple[RangeColumns, PositionArguments]]

_WORD_LIST = msgspec.json.Decoder(list[str])
_ANY = msgspec.json.Decoder(Any)
_LONGEST_WORD = 100


def read_json_ranges(body: bytes, query: PositionQuery) -> tuple[RangeColumns, PositionArguments]:
    """Columns and arguments of a JSON body.

    Raises
    ------
    Problem
        If the body is not JSON, holds unknown or repeated keys, or a value of the wrong type.
    """
    misplaced = query.csv_only()
    if misplaced:
        raise Problem(
            ProblemType.unknown_field,
            "with a JSON body these belong into the body: " + ", ".join(misplaced),
            errors=[FieldError(name, "belongs into the body") for name in misplaced],
        )
    fields = read_object(body, (*FIELDS, *PositionArguments.model_fields), "")
    arguments = read_position_arguments(
        {name: _argument(raw, name) for name, raw in fields.items() if name not in FIELDS}
    )
    _refuse_absent([name for name in REQUIRED if is_null(fields.get(name))])
    numbers = {name: read_numbers(fields[name], name) for name in NUMBERS if not is_null(fields.get(name))}
    words = {name: _words(fields[name], name) for name in WORDS if not is_null(fields.get(name))}
    time: Times | None = None
    form: TimeForm | None = None
    if not is_null(fields.get("time")):
        time, form = read_times(fields["time"], "time", arguments.time_unit)
    return RangeColumns(numbers, words, time, form), arguments


def read_csv_ranges(body: bytes, query: PositionQuery) -> tuple[RangeColumns, PositionArguments]:
    """Columns and arguments of a CSV body; the arguments come from the query string.

    Columns of other names are left alone: tables carry more than a position needs.

    Raises
    ------
    Problem
        If the body is not CSV in UTF-8, a column is not there, or a cell cannot be read.
    """
    arguments = read_position_arguments(query.arguments())
    header, rows = split_table(body)
    _refuse_absent([name for name in REQUIRED if name not in header])
    twice = next((name for name in FIELDS if header.count(name) > 1), None)
    if twice is not None:
        raise invalid_value(twice, "the header has it twice; name each column once")
    cells = {name: [row[header.index(name)] for row in rows] for name in FIELDS if name in header}
    numbers = {name: read_cells(cells[name], name) for name in NUMBERS if name in cells}
    words = {name: _checked([cell.strip() for cell in cells[name]], name) for name in WORDS if name in cells}
    time: Times | None = None
    form: TimeForm | None = None
    if "time" in cells:
        time, form = read_time_cells(cells["time"], "time", arguments.time_unit)
    return RangeColumns(numbers, words, time, form), arguments


RANGE_READERS: dict[str, ReadRanges] = {"application/json": read_json_ranges, "text/csv": read_csv_ranges}


def _refuse_absent(names: list[str]) -> None:
    if names:
        raise Problem(
            ProblemType.invalid_value,
            f"{', '.join(names)}: is required",
            errors=[FieldError(name, "is required") for name in names],
        )


def _argument(raw: msgspec.Raw, name: str) -> Any:
    if name == "options":
        known = tuple(PositionSettings.model_fields)
        inner = read_object(raw, known, "options.")
        return {key: _argument(text, f"options.{key}") for key, text in inner.items()}
    try:
        return _ANY.decode(raw)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise invalid_value(
            name, "cannot be read; numbers must fit into 64 bits and text be UTF-8"
        ) from error


def _words(raw: msgspec.Raw, name: str) -> list[str]:
    return _checked(decode_column(_WORD_LIST, raw, name), name)


def _checked(words: list[str], name: str) -> list[str]:
    for row, word in enumerate(words):
        if not 0 < len(word) <= _LONGEST_WORD or not word.isprintable():
            raise invalid_value(name, f"expected 1 to {_LONGEST_WORD} printable characters", row)
    return words
