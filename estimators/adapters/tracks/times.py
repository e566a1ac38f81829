"""The times of a track in whatever form they came: ISO 8601, numbers since 1970, or plain seconds.

Numbers by their size: seconds since 1970 are near 2e9, milliseconds near 2e12, and so on, with a factor of
1,000 between; nothing in this century lies near a border. Seconds stay numbers, as they came; the finer units
become points in time, since a speed needs to know that they are no seconds.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from estimators.adapters.tracks.moments import Bytes, parse_moments, parse_pieces
from estimators.adapters.tracks.numbers import parse_numbers
from estimators.adapters.tracks.recording import Moments, Offsets
from estimators.arrays import BoolArray, FloatArray, InputError, IntArray

TimeUnit = Literal["s", "ms", "us", "ns"]
NANOSECONDS: dict[TimeUnit, int] = {"s": 1_000_000_000, "ms": 1_000_000, "us": 1_000, "ns": 1}
"""In a unit, from the coarsest to the finest."""
_BORDERS: tuple[tuple[float, TimeUnit], ...] = ((1e17, "ns"), (1e14, "us"), (1e11, "ms"))

Timed = tuple[Moments | FloatArray, Offsets | None, BoolArray]
"""Times, offsets in minutes, and where something stands that is no time."""


def times_of_numbers(values: FloatArray, unreadable: BoolArray, unit: TimeUnit | None = None) -> Timed:
    """Read times of a column of numbers.

    Parameters
    ----------
    values : ndarray of float64, shape (n,)
        NaN where missing.
    unreadable : ndarray of bool, shape (n,)
    unit : {"s", "ms", "us", "ns"}, optional
        The numbers count these since 1970. Default: told by their size; seconds stay numbers.

    Returns
    -------
    Timed

    Raises
    ------
    InputError
        If times of the unit do not lie between the years 1678 and 2261.

    Examples
    --------
    >>> import numpy as np
    >>> times_of_numbers(np.array([1.7e12]), np.zeros(1, dtype=bool))[0]
    array(['2023-11-14T22:13:20.000000000'], dtype='datetime64[ns]')
    """
    if unit is None:
        unit = unit_of(values)
        if unit is None:
            with np.errstate(invalid="ignore"):
                sound = np.abs(values) <= _BORDERS[-1][0]
            return np.where(sound, values, np.nan), None, unreadable | (~sound & ~np.isnan(values))
    step = NANOSECONDS[unit]
    with np.errstate(invalid="ignore"):
        sound = np.abs(values) < 9.2e18 / step
    if not sound.any() and np.isfinite(values).any():
        raise InputError("time", f"numbers of {unit} since 1970 leave the years 1678 to 2261; check the unit")
    # Whole and broken parts apart: the product of both would lose the nanoseconds.
    whole = np.floor(np.where(sound, values, 0.0))
    part = np.round((np.where(sound, values, 0.0) - whole) * step).astype(np.int64)
    moments = (whole.astype(np.int64) * step + part).astype("datetime64[ns]")
    moments[~sound] = np.datetime64("NaT")
    return moments, None, unreadable | (~sound & ~np.isnan(values))


def unit_of(values: FloatArray) -> TimeUnit | None:
    """Tell a unit finer than the second by the size of times since 1970; None where there is none.

    Examples
    --------
    >>> import numpy as np
    >>> unit_of(np.array([1.7e12])), unit_of(np.array([1.7e9]))
    ('ms', None)
    """
    size = _size(values)
    return next((unit for border, unit in _BORDERS if size > border), None)


def times_of_cells(pieces: Sequence[Bytes], unit: TimeUnit | None = None) -> Timed:
    """Read times of a column of text in pieces, numbers or ISO 8601 as most of the first rows are.

    Raises
    ------
    InputError
        If the column is text though a unit was given.
    """
    sample = [cell.decode() for cell in pieces[0][:1000] if cell] if pieces else []
    numeric = int(np.count_nonzero(np.isfinite(parse_numbers(sample)[0])))
    if numeric * 2 <= len(sample):
        if unit is not None:
            raise InputError("time", "holds text where numbers of a unit were announced; drop the unit")
        return parse_pieces(pieces)
    found = [_read_piece([cell.decode() for cell in piece]) for piece in pieces]
    values = np.concatenate([piece[0] for piece in found])
    unreadable = np.concatenate([piece[1] for piece in found])
    exact = [whole for _, _, whole in found if whole is not None]
    if len(exact) == len(found) and (unit == "ns" or (unit is None and _size(values) > _BORDERS[0][0])):
        # As floats they would be rounded to 256 ns.
        return np.concatenate(exact).astype("datetime64[ns]"), None, unreadable
    return times_of_numbers(values, unreadable, unit)


def _read_piece(texts: list[str]) -> tuple[FloatArray, BoolArray, IntArray | None]:
    values, unreadable = parse_numbers(texts)
    # Above 2**53 floats do not hold all integers.
    large = np.abs(values[np.isfinite(values)]).max(initial=0.0) > 2.0**53
    return values, unreadable, _integers(texts) if large else None


def _size(values: FloatArray) -> float:
    """Size that most numbers have; 0 if there are none."""
    sizes = np.abs(values[np.isfinite(values)])
    return float(np.median(sizes)) if sizes.size else 0.0


def _integers(texts: Sequence[str]) -> IntArray | None:
    """64-bit integers exactly; None where a cell is something else."""
    try:
        return np.fromiter(map(int, texts), dtype=np.int64, count=len(texts))
    except (ValueError, OverflowError):
        return None


def times_of_values(values: Sequence[Any]) -> Timed:
    """Read times of JSON values: text or numbers, as most of them are; the others are unreadable."""
    texts = [value if isinstance(value, str) else None for value in values]
    if sum(text is not None for text in texts) * 2 >= len(values):
        moments, offsets, unreadable = parse_moments(texts)
        strange = [value is not None and not isinstance(value, str) for value in values]
        return moments, offsets, unreadable | np.array(strange, dtype=np.bool_)
    numbers = [
        repr(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else
        None if value is None else "?"
        for value in values
    ]  # fmt: skip
    return times_of_numbers(*parse_numbers(numbers))
