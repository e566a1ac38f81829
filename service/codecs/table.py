"""A delimited text file as it is found in the wild to the columns that a fit takes.

Bytes in, arrays out; an error names the line and the column. The command line reads its files with
this; the service's own CSV codec is stricter, since its callers can mend what they send.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import TypeVar

import numpy as np

from service.codecs.columns import Columns, TimeForm, Times, from_epoch
from service.codecs.table_cells import (
    CellError,
    Floats,
    are_compact_dates,
    kind_of,
    read_integers,
    read_moments,
    read_numbers,
)
from service.codecs.table_choice import Choice, Headings, choose_columns, names_a_header
from service.codecs.table_text import DELIMITER_NAMES, TableError, decode, find_delimiter, numbered_rows
from service.errors import Problem
from service.schemas.fields import TimeUnit

__all__ = ["Table", "TableError", "read_delimiter", "read_table"]

# What a column holds is judged by so many rows.
_SAMPLE = 500

_Result = TypeVar("_Result")


@dataclass(frozen=True, slots=True)
class Table:
    """A series from a file.

    Attributes
    ----------
    columns : Columns
        As every codec makes them.
    time_name, value_name : str
        What the columns are called, or ``column 2``.
    remarks : tuple of str
        What was guessed, as sentences for people.
    """

    columns: Columns
    time_name: str
    value_name: str
    remarks: tuple[str, ...]


def read_delimiter(text: str) -> str:
    """Delimiter that a caller names: one character, or ``tab``, ``space``, ``comma``, ``semicolon`` ...

    Raises
    ------
    TableError
        If it is none of these.
    """
    delimiter = DELIMITER_NAMES.get(text.lower(), text)
    if len(delimiter) != 1 or delimiter in '\r\n"#.' or delimiter.isalnum():
        raise TableError(f"{text!r} cannot separate cells; give one character such as ; or the word tab")
    return delimiter


def read_table(
    body: bytes,
    *,
    time: str | None = None,
    value: str | None = None,
    weight: str | None = None,
    own: Sequence[str] = (),
    delimiter: str | None = None,
    time_unit: TimeUnit | None = None,
) -> Table:
    r"""Read a table with or without a header, whatever separates its cells.

    Parameters
    ----------
    body : bytes
    time, value, weight : str, optional
        Name or position (from 1) of a column; default: guessed, and said in ``remarks``.
    own : sequence of str
        Names or positions of further columns, to be fitted along.
    delimiter : str, optional
        One character; default: found out.
    time_unit : {"s", "ms", "us", "ns"}, optional
        Unit of times that are numbers since 1970; without it numbers are plain numbers.

    Returns
    -------
    Table

    Raises
    ------
    TableError
        Naming the line and the column.

    Examples
    --------
    >>> read_table(b"day;level\n2024-05-01;1,5\n2024-05-02;NA\n").columns.value
    array([1.5, nan])
    """
    text = decode(body)
    sheet = _Sheet.of(text, find_delimiter(text) if delimiter is None else delimiter)
    choice = choose_columns(sheet.headings, time, value, weight, own)
    places = (choice.time, choice.value, choice.weight, *choice.own)
    cells = sheet.read([place for place in places if place is not None])
    times, form, remark = _times(sheet, choice.time, cells[choice.time], time_unit)
    columns = Columns(
        time=times,
        value=sheet.numbers(choice.value, cells[choice.value]),
        weight=None if choice.weight is None else _weights(sheet, choice.weight, cells[choice.weight]),
        predict=None,
        form=form,
        own={sheet.headings.title(place): sheet.numbers(place, cells[place]) for place in choice.own},
    )
    return Table(
        columns=columns,
        time_name=sheet.headings.title(choice.time),
        value_name=sheet.headings.title(choice.value),
        remarks=tuple(_guesses(sheet.headings, choice) + remark),
    )


@dataclass(frozen=True, slots=True)
class _Sheet:
    """A text cut into rows, and what was learnt from the first of them."""

    text: str
    delimiter: str
    has_header: bool
    headings: Headings

    @classmethod
    def of(cls, text: str, delimiter: str) -> _Sheet:
        comma = delimiter == ";"
        sample = [row for _, row in islice(numbered_rows(text, delimiter), _SAMPLE)]
        if not sample:
            raise TableError("the input holds nothing but blank lines and comments")
        first, body = sample[0], sample[1:]
        width = len(body[0]) if body else len(first)
        while width > len(first) and not any(row[width - 1].strip() for row in body if len(row) >= width):
            width -= 1
        columns = [[row[place] for row in body if place < len(row)] for place in range(width)]
        kinds = tuple(kind_of(column, decimal_comma=comma) for column in columns)
        own = tuple(kind_of([cell], decimal_comma=comma) for cell in first)
        if names_a_header(first, kinds, own):
            names = tuple(cell.strip() for cell in first)
            while len(names) > width and not names[-1]:
                names = names[:-1]
            return cls(text, delimiter, True, Headings(names, kinds, trusted=len(names) == width))
        columns = [[row[place] for row in sample if place < len(row)] for place in range(len(first))]
        kinds = tuple(kind_of(column, decimal_comma=comma) for column in columns)
        return cls(text, delimiter, False, Headings((), kinds, trusted=False))

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Rows below the header, each with its line."""
        return islice(numbered_rows(self.text, self.delimiter), int(self.has_header), None)

    def read(self, places: list[int]) -> dict[int, list[str]]:
        """Cells of some columns, all the way down."""
        width = len(self.headings.kinds)
        kept: dict[int, list[str]] = {place: [] for place in places}
        adders = [(place, column.append) for place, column in kept.items()]
        for line, row in self.rows():
            if len(row) != width:
                self._check_width(line, row, width)
            for place, add in adders:
                add(row[place])
        return kept

    def _check_width(self, line: int, row: list[str], width: int) -> None:
        # Spreadsheets leave empty cells at the end of a row; more may be a decimal comma, fewer a lost cell.
        if len(row) < width or any(cell.strip() for cell in row[width:]):
            message = f"{len(row)} cell{'s' if len(row) > 1 else ''} where the table has {width}"
            raise TableError(f"{message}; check the delimiters, and quote text that holds one", line=line)

    def numbers(self, place: int, cells: list[str]) -> Floats:
        """Cells of a column as numbers."""
        return self.blamed(place, lambda: read_numbers(cells, decimal_comma=self.delimiter == ";"))

    def blamed(self, place: int, read: Callable[[], _Result]) -> _Result:
        """Return what a conversion makes; its error gets the line and the column."""
        try:
            return read()
        except CellError as error:
            row, message = error.row, str(error)
        except Problem as problem:
            row, message = problem.errors[0].row or 0, problem.errors[0].message
        line, _ = next(islice(self.rows(), row, None))
        raise TableError(message, line=line, column=self.headings.label(place))


def _times(
    sheet: _Sheet, place: int, cells: list[str], unit: TimeUnit | None
) -> tuple[Times, TimeForm, list[str]]:
    """Column of times, the form it came in, and what is to be said about it."""
    label = sheet.headings.label(place)
    is_time = sheet.headings.kinds[place] == "time"
    compact = not is_time and unit is None and are_compact_dates(cells[:_SAMPLE])
    if is_time and unit is not None:
        raise TableError("a time unit is for numbers since 1970; leave it out with dates", column=label)
    if is_time or compact:
        remark = [f"Read column {label} as dates without hyphens."] if compact else []
        return sheet.blamed(place, lambda: read_moments(cells, compact=compact)), TimeForm("iso"), remark
    integers = read_integers(cells)
    numbers = sheet.numbers(place, cells) if integers is None else integers
    if unit is None:
        return numbers, TimeForm("number"), []
    return sheet.blamed(place, lambda: from_epoch(numbers, unit, "time")), TimeForm("epoch", unit), []


def _weights(sheet: _Sheet, place: int, cells: list[str]) -> Floats:
    def checked() -> Floats:
        weights = read_numbers(cells, decimal_comma=sheet.delimiter == ";")
        bad = ~((weights >= 0) & np.isfinite(weights))
        if np.any(bad):
            raise CellError(int(np.argmax(bad)), "a weight is a precision: a finite number, not negative")
        return weights

    return sheet.blamed(place, checked)


def _guesses(headings: Headings, choice: Choice) -> list[str]:
    places = {"time": choice.time, "value": choice.value, "weight": choice.weight}
    told = [
        f"{role} from column {headings.label(place)}"
        for role, place in places.items()
        if role in choice.guessed and place is not None
    ]
    return [f"Took {', '.join(told)}."] if told else []
