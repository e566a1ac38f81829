"""Times on the command line, in the form of the table's time column."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from service.codecs.columns import Columns, TimeForm, Times, from_epoch
from service.codecs.table import TableError
from service.codecs.table_cells import (
    CellError,
    Floats,
    Integers,
    is_number,
    read_integers,
    read_moments,
    read_numbers,
)
from service.errors import Problem

_YEAR = re.compile(r"\s*\d{4}\s*")


def read_moment_like(columns: Columns, texts: Sequence[str], option: str) -> Times:
    """Read times given as options.

    Parameters
    ----------
    columns : Columns
        Of the table: dates are taken where its times are dates (a year is its first day), numbers where
        they are numbers, either where they are numbers since 1970.
    texts : sequence of str, length k
    option : str
        Named in errors.

    Returns
    -------
    ndarray, shape (k,)
        Of the same kind as the table's times.

    Raises
    ------
    TableError
        If a text is not such a time.
    """
    moments: Any = [_read(text, columns.form, option) for text in texts]
    joined: Times = np.concatenate(moments)
    return joined.astype(np.float64) if columns.time.dtype.kind == "f" else joined


def _read(text: str, form: TimeForm, option: str) -> Times:
    """One time, as an array of one."""
    try:
        if form.kind == "iso" or (form.kind == "epoch" and not is_number(text, decimal_comma=False)):
            return read_moments([f"{text.strip()}-01-01" if _YEAR.fullmatch(text) else text])
        number = _number(text)
        if form.unit is not None:
            return from_epoch(number, form.unit, option)
    except CellError as error:
        raise TableError(f"{option} {text!r}: {_expected(form)}") from error
    except Problem as problem:
        raise TableError(f"{option} {text!r} {problem.errors[0].message}") from problem
    if not np.isfinite(number).all():
        raise TableError(f"{option} {text!r}: {_expected(form)}")
    return number


def _number(text: str) -> Floats | Integers:
    integer = read_integers([text])
    return read_numbers([text], decimal_comma=False) if integer is None else integer


def _expected(form: TimeForm) -> str:
    if form.kind == "number":
        return "the times of the table are plain numbers, so give a number"
    if form.kind == "epoch":
        return f"give a number in {form.unit} since 1970, or a date such as 2030-01-31"
    return "the times of the table are dates, so give one such as 2030-01-31 or 2030-01-31T12:00:00Z"
