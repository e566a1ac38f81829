"""The arguments of a fit that are not data: each is checked once and named when it cannot be used."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from numbers import Integral, Real
from typing import TypeVar

from estimators.arrays import LARGEST_VALUE, InputError

Row = TypeVar("Row")


def look_up(field: str, name: str, known: Mapping[str, Row]) -> Row:
    """Row of a registry.

    Parameters
    ----------
    field : str
        Name of the argument.
    name : str
    known : mapping

    Raises
    ------
    InputError
        If there is none of this name; the message suggests the closest one.

    Examples
    --------
    >>> look_up("method", "ransack", {"ransac": 1, "ols": 2})
    Traceback (most recent call last):
    estimators.arrays.InputError: method: unknown method 'ransack'; did you mean 'ransac'? known: ransac, ols
    """
    if isinstance(name, str) and name in known:
        return known[name]
    close = difflib.get_close_matches(str(name).lower(), known, n=1)
    hint = f"did you mean {close[0]!r}? " if close else ""
    raise InputError(field, f"unknown {field} {name!r}; {hint}known: {', '.join(known)}")


def check_positive(field: str, value: float | None) -> float | None:
    """Threshold or noise scale: a positive number whose square neither overflows nor underflows.

    Raises
    ------
    InputError
    """
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InputError(field, "must be a number")
    number = float(value)
    if not 1.0 / LARGEST_VALUE <= number <= LARGEST_VALUE:
        raise InputError(field, f"must lie between {1.0 / LARGEST_VALUE:g} and {LARGEST_VALUE:g}")
    return number


def check_fraction(field: str, value: float) -> float:
    """Confidence level: a number between 0 and 1, both excluded.

    Raises
    ------
    InputError
    """
    if isinstance(value, bool) or not isinstance(value, Real) or not 0.0 < value < 1.0:
        raise InputError(field, "must be a number between 0 and 1, both excluded")
    return float(value)


def check_seed(seed: int) -> int:
    """Seed: an integer from 0 to 2**63 - 1.

    Raises
    ------
    InputError
    """
    if isinstance(seed, bool) or not isinstance(seed, Integral) or not 0 <= seed < 2**63:
        raise InputError("seed", "must be an integer from 0 to 2**63 - 1")
    return int(seed)
