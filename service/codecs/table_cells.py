"""Cells of a table to arrays: numbers, ISO 8601 times, and what to do about those that are neither."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from service.codecs.times import parse_iso
from service.errors import Problem

Kind = Literal["number", "time", "text", "empty"]
Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

#: What spreadsheets, R, pandas and SQL write for "not available"; compared in lower case.
MISSING = frozenset({"", "na", "n/a", "#n/a", "<na>", "nan", "null", "none", "nat"})

_INFINITIES = frozenset({"inf", "+inf", "-inf", "infinity", "+infinity", "-infinity"})
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?")
_ISO_START = re.compile(r"\d{4}-\d\d(-\d\d|$)")
_YEAR_AND_MONTH = re.compile(r"\d{4}-\d\d")
_COMPACT_DATE = re.compile(r"(1[6-9]|20|21)\d\d(0[1-9]|1[0-2])(0[1-9]|[12]\d|3[01])")
# Longer digit strings cost more than linear time to read, and no measurement needs them.
_LONGEST = 400


class CellError(ValueError):
    """A cell that cannot be read.

    Parameters
    ----------
    row : int
        Its place in the column, from 0.
    message : str
    """

    def __init__(self, row: int, message: str) -> None:
        super().__init__(message)
        self.row = row


def is_missing(cell: str) -> bool:
    """Whether a cell says that there is no value."""
    return cell.strip().lower() in MISSING


def is_number(cell: str, *, decimal_comma: bool) -> bool:
    """Whether a cell holds a number, infinities included."""
    text = cell.strip()
    if len(text) > _LONGEST:
        return False
    if _NUMBER.fullmatch(text) or text.lower() in _INFINITIES:
        return True
    return decimal_comma and _DECIMAL_COMMA.fullmatch(text) is not None


def kind_of(cells: Sequence[str], *, decimal_comma: bool) -> Kind:
    """Say what most of a column's cells hold, the missing ones left out.

    Most, not all: in a column of numbers one that is misspelt shall be told by its line, and the column not
    be taken for text.
    """
    present = [cell.strip() for cell in cells if not is_missing(cell)]
    if not present:
        return "empty"
    if sum(is_number(cell, decimal_comma=decimal_comma) for cell in present) > len(present) / 2:
        return "number"
    return "time" if sum(map(bool, map(_ISO_START.match, present))) > len(present) / 2 else "text"


def are_compact_dates(cells: Sequence[str]) -> bool:
    """Whether a column of integers is dates without hyphens (ISO 8601 basic format, 20240131)."""
    present = [cell.strip() for cell in cells if not is_missing(cell)]
    return bool(present) and all(map(_COMPACT_DATE.fullmatch, present))


def read_numbers(cells: Sequence[str], *, decimal_comma: bool) -> Floats:
    """Numbers of a column; NaN where one is missing.

    Parameters
    ----------
    cells : sequence of str, length n
    decimal_comma : bool
        Whether ``1,5`` is one and a half.

    Returns
    -------
    ndarray of float64, shape (n,)

    Raises
    ------
    CellError
        At the first cell that is not a number.
    """
    numbers = _plain_numbers(cells)
    if numbers is not None:
        return numbers
    numbers = np.full(len(cells), np.nan)
    for row, cell in enumerate(cells):
        text = cell.strip()
        if text.lower() in MISSING:
            continue
        if not is_number(text, decimal_comma=decimal_comma):
            raise CellError(
                row, f"{_quoted(text)} is not a number; mend it, or leave the cell empty if it is missing"
            )
        numbers[row] = float(text.replace(",", "."))
        if np.isinf(numbers[row]) and text.lower() not in _INFINITIES:
            raise CellError(row, f"{_quoted(text)} is too large for a 64-bit float")
    return numbers


def _plain_numbers(cells: Sequence[str]) -> Floats | None:
    """All cells at once where none is missing and none uses Python's own spellings (``1_000``)."""
    try:
        numbers = np.fromiter(map(float, cells), dtype=np.float64, count=len(cells))
    except ValueError:
        return None
    text = "".join(cells)
    return numbers if text.isascii() and "_" not in text and bool(np.isfinite(numbers).all()) else None


def read_integers(cells: Sequence[str]) -> Integers | None:
    """Integers exactly, or None where a cell is something else: floats round above 2**53."""
    if "_" in "".join(cells):
        return None
    try:
        return np.fromiter(map(int, cells), dtype=np.int64, count=len(cells))
    except (ValueError, OverflowError):
        return None


def read_moments(cells: Sequence[str], *, compact: bool = False) -> npt.NDArray[np.datetime64]:
    """Points in time of a column, in UTC; NaT where one is missing.

    Parameters
    ----------
    cells : sequence of str, length n
        ISO 8601 with or without offset; a month is its first day.
    compact : bool
        Whether dates are written without hyphens.

    Returns
    -------
    ndarray of datetime64[ns], shape (n,)

    Raises
    ------
    CellError
        At the first cell that is not a time.
    """
    texts = [None if is_missing(cell) else _as_iso(cell.strip(), compact=compact) for cell in cells]
    try:
        return parse_iso(texts, "time")
    except Problem as problem:
        error = problem.errors[0]
        row = error.row or 0
        raise CellError(row, f"{_quoted(cells[row].strip())} {_as_sentence_end(error.message)}") from problem


def _as_iso(text: str, *, compact: bool) -> str:
    if compact and len(text) == 8 and text.isdigit():
        return f"{text[:4]}-{text[4:6]}-{text[6:]}"
    return f"{text}-01" if len(text) == 7 and _YEAR_AND_MONTH.fullmatch(text) else text


def _as_sentence_end(message: str) -> str:
    return message.replace("send ISO 8601", "write ISO 8601")


def _quoted(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:37] + "...")
