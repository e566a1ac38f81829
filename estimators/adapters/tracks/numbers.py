"""Cells of text to float64, many at a time: what is missing or no number becomes NaN and is told apart."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from estimators.arrays import BoolArray, FloatArray

MISSING = frozenset({"", "na", "n/a", "#n/a", "<na>", "nan", "null", "none", "nat", "-"})
"""What spreadsheets, R, pandas and SQL write for "not available"; compared in lower case."""

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_LONGEST = 400


def parse_numbers(
    cells: Sequence[str | None], *, decimal_comma: bool = False
) -> tuple[FloatArray, BoolArray]:
    """Read numbers.

    Parameters
    ----------
    cells : sequence of str or None, length n
    decimal_comma : bool
        Whether ``1,5`` is one and a half.

    Returns
    -------
    values : ndarray of float64, shape (n,)
        NaN where a cell is missing or no finite number.
    unreadable : ndarray of bool, shape (n,)
        Where something stands that is no finite number.

    Examples
    --------
    >>> parse_numbers(["1.5", "", "north"])
    (array([1.5, nan, nan]), array([False, False,  True]))
    """
    quick = _all_at_once(cells)
    if quick is not None:
        return quick, np.zeros(len(cells), dtype=np.bool_)
    values = np.full(len(cells), np.nan)
    unreadable = np.zeros(len(cells), dtype=np.bool_)
    for row, cell in enumerate(cells):
        text = (cell or "").strip()
        if text.lower() in MISSING:
            continue
        if decimal_comma:
            text = text.replace(",", ".")
        number = float(text) if len(text) <= _LONGEST and _NUMBER.fullmatch(text) else np.inf
        if np.isfinite(number):
            values[row] = number
        else:
            unreadable[row] = True
    return values, unreadable


def _all_at_once(cells: Sequence[str | None]) -> FloatArray | None:
    """All cells where none is missing and none uses Python's own spellings (``1_000``)."""
    present = [cell for cell in cells if cell is not None]
    if len(present) < len(cells):
        return None
    try:
        values = np.fromiter(map(float, present), dtype=np.float64, count=len(present))
    except ValueError:
        return None
    text = "".join(present)
    return values if text.isascii() and "_" not in text and bool(np.isfinite(values).all()) else None
