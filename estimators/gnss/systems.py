"""Satellite navigation systems, by the letters of RINEX and by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from estimators.arrays import InputError, IntArray

SYSTEMS: Mapping[str, str] = MappingProxyType(
    {
        "G": "GPS",
        "R": "GLONASS",
        "E": "Galileo",
        "C": "BeiDou",
        "J": "QZSS",
        "I": "NavIC",
        "S": "SBAS",
    }
)
"""Letter (RINEX 3) to name. Each system keeps a time of its own: the receiver has a clock for each."""

_BY_NAME = {name.lower(): letter for letter, name in SYSTEMS.items()} | {"bds": "C", "irnss": "I"}


def system_letter(name: str, field: str = "system") -> str:
    """Letter of a system given by letter or name.

    Parameters
    ----------
    name : str
    field : str
        Name used in errors.

    Raises
    ------
    InputError
        If there is no such system.

    Examples
    --------
    >>> system_letter("Galileo"), system_letter("g")
    ('E', 'G')
    """
    if isinstance(name, str):
        letter = name.strip().upper()
        if letter in SYSTEMS:
            return letter
        found = _BY_NAME.get(name.strip().lower())
        if found is not None:
            return found
    known = ", ".join(f"{letter} ({title})" for letter, title in SYSTEMS.items())
    raise InputError(field, f"{name!r} is no satellite system; known are {known}")


def read_systems(systems: str | Sequence[str] | None, n: int) -> tuple[tuple[str, ...], IntArray]:
    """Clocks of an epoch, in the order of :data:`SYSTEMS`, and the clock of each satellite.

    Parameters
    ----------
    systems : str, sequence of str or None
        One for all or one per satellite; None counts all as GPS.
    n : int
        Number of satellites.

    Returns
    -------
    letters : tuple of str
    clock : ndarray of int64, shape (n,)
        Index into ``letters``.

    Raises
    ------
    InputError
    """
    given: list[Any]
    if systems is None:
        given = ["G"] * n
    elif isinstance(systems, str):
        given = [systems] * n
    else:
        given = list(systems)
    if len(given) != n:
        raise InputError("system", f"expected one per satellite, {n}, got {len(given)}")
    letters = [system_letter(name) for name in given]
    present = tuple(letter for letter in SYSTEMS if letter in set(letters))
    return present, np.array([present.index(letter) for letter in letters], dtype=np.int64)
