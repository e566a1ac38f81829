"""Times on the command line, in the form of the table's time column."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from service.codecs.columns import Columns, TimeForm, Times, from_epoch
from service.codecs.table import TableError
from service.codecs.table_cells import CellError, Floats, Integers, read_integers, read_moments, read_numbers
from service.errors import Problem

_YEAR = re.compile(r"\d{4}")


def read_moment_like(columns: Columns, texts: Sequence[str], option: str) -> Times:
    """Read times given as options.

    Parameters
    ----------
    columns : Columns
        Of the table: dates are taken where its times are dates (a year is its first day), numbers where
        they are numbers, both where they are numbers since 1970.
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
    form = columns.form
    try:
        if form.kind == "iso" or (form.kind == "epoch" and not all(map(_looks_like_a_number, texts))):
            return read_moments(
                [f"{text}-01-01" if _YEAR.fullmatch(text.strip()) else text for text in texts]
            )
        numbers = _numbers(texts)
        if form.kind == "epoch" and form.unit is not None:
            return from_epoch(numbers, form.unit, option)
    except CellError as error:
        raise TableError(f"{option} {texts[error.row]!r}: {_expected(form)}") from error
    except Problem as problem:
        row = problem.errors[0].row or 0
        raise TableError(f"{option} {texts[row]!r} {problem.errors[0].message}") from problem
    unusable = np.flatnonzero(~np.isfinite(numbers))
    if unusable.size:
        raise TableError(f"{option} {texts[unusable[0]]!r}: {_expected(form)}")
    return numbers if columns.time.dtype.kind == numbers.dtype.kind else numbers.astype(np.float64)


def _looks_like_a_number(text: str) -> bool:
    return read_integers([text]) is not None or text.replace(".", "", 1).lstrip("+-").isdigit()


def _numbers(texts: Sequence[str]) -> Floats | Integers:
    integers = read_integers(texts)
    return read_numbers(texts, decimal_comma=False) if integers is None else integers


def _expected(form: TimeForm) -> str:
    if form.kind == "number":
        return "the times of the table are plain numbers, so give a number"
    if form.kind == "epoch":
        return f"give a number in {form.unit} since 1970, or a date such as 2030-01-31"
    return "the times of the table are dates, so give one such as 2030-01-31 or 2030-01-31T12:00:00Z"
