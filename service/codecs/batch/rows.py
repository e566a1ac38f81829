"""What every format of a batch becomes: :class:`Batch`, series after series, and how it is gathered.

A table may come in pieces and its series in any order. Rows are grouped stably, series in the order in
which they first appear; where they stand together already nothing is moved. Memory: one copy of the columns,
and while one of them is joined or moved a second copy of that one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from service.codecs.batch.cells import Floats, Integers, counted_from, name_codes, read_floats, read_times
from service.codecs.columns import UNIT_NANOSECONDS, Columns, TimeForm, Times
from service.codecs.limits import Limits, check_columns
from service.errors import invalid_value
from service.schemas.fields import TimeUnit

REQUIRED = ("series", "time", "value")
OPTIONAL = ("weight", "lat", "lon")
ROLES = (*REQUIRED, *OPTIONAL)

Names = list[str] | list[int]

_FURTHEST = {"lat": 90.0, "lon": 180.0}


@dataclass(frozen=True, slots=True)
class Reading:
    """How a batch is read.

    Attributes
    ----------
    columns : mapping of str to str or None
        Name of a role's column, None where the caller names none: then it is called as the role is.
    time_unit : {"s", "ms", "us", "ns"} or None
    limits : Limits
    check : callable
        Called between pieces; raises if nobody waits any more.
    """

    columns: Mapping[str, str | None]
    time_unit: TimeUnit | None
    limits: Limits
    check: Callable[[], None]

    def choose(self, header: Sequence[str]) -> dict[str, int]:
        """Places of the roles' columns in a header.

        Raises
        ------
        Problem
            If a column is not there, there twice or in two roles, or a position is half a position.
        """
        places: dict[str, int] = {}
        for role in ROLES:
            asked = self.columns.get(role)
            name = role if asked is None else asked
            found = [place for place, title in enumerate(header) if title == name]
            if len(found) == 1 and found[0] in places.values():
                raise invalid_value(f"{role}_column", "this column has another role already; name another")
            if len(found) == 1:
                places[role] = found[0]
            elif found or asked is not None or role in REQUIRED:
                how_many = "no column" if not found else "more than one column"
                raise invalid_value(f"{role}_column", f"the table has {how_many} of this name")
        check_position(places)
        return places


@dataclass(frozen=True, slots=True)
class Batch:
    """Many series, one after the other: series ``k`` is the rows ``offsets[k]:offsets[k + 1]``.

    Attributes
    ----------
    names : list of str or list of int, length m
        In the order in which they first appear.
    offsets : ndarray of int64, shape (m + 1,)
    row : ndarray of int64, shape (n,), or None
        Row of the table that each row was; None where rows have not been moved.
    time, value, weight : ndarray, shape (n,)
        As in :class:`~service.codecs.columns.Columns`.
    form : TimeForm
    whole : bool
        Whether times are integers, as numbers or since 1970 in their unit.
    lat, lon : ndarray of float64, shape (m,), or None
        Position of each series, from its first row that has one; NaN where none has.
    """

    names: Names
    offsets: Integers
    row: Integers | None
    time: Times
    value: Floats
    weight: Floats | None
    form: TimeForm
    whole: bool
    lat: Floats | None
    lon: Floats | None


class Gatherer:
    """Takes a table piece by piece and makes a :class:`Batch` of it.

    Parameters
    ----------
    reading : Reading
    numbers_as_text : bool
        Whether text may hold numbers, as in a CSV.
    """

    def __init__(self, reading: Reading, *, numbers_as_text: bool = False) -> None:
        self._reading = reading
        self._numbers_as_text = numbers_as_text
        self._codes: dict[Any, int] = {}
        self._form: TimeForm | None = None
        self._rows = 0
        self._pieces: dict[str, list[npt.NDArray[Any]]] = {}

    def add(self, columns: Mapping[str, Any]) -> None:
        """Take some rows as Arrow arrays, one per role."""
        with counted_from(self._rows):
            times, form = read_times(
                columns["time"],
                self._reading.time_unit,
                self._form,
                numbers_as_text=self._numbers_as_text,
            )
            numbers = {
                role: read_floats(columns[role], role)
                for role in ("value", *OPTIONAL)
                if columns.get(role) is not None
            }
        self.add_read(columns["series"], times, form, numbers)

    def add_read(self, series: Any, times: Times, form: TimeForm | None, numbers: dict[str, Floats]) -> None:
        """Take some rows whose times and numbers are numpy already.

        Parameters
        ----------
        series : pyarrow.Array
        times : ndarray, shape (n,)
        form : TimeForm or None
            None where all are missing and none has been seen.
        numbers : dict of str to ndarray, shape (n,)
            ``value`` and those of the other roles that are there.
        """
        self._reading.check()
        self._reading.limits.check_points(self._rows + len(series))
        with counted_from(self._rows):
            names, codes = name_codes(series)
        places = np.array([self._codes.setdefault(name, len(self._codes)) for name in names], dtype=np.int32)
        self._reading.limits.check_series(len(self._codes))
        self._form = self._form or form
        pieces = {"series": places[codes] if places.size else np.empty(0, np.int32), "time": times, **numbers}
        for role, piece in pieces.items():
            self._pieces.setdefault(role, []).append(piece)
        self._rows += len(series)

    def finish(self) -> Batch:
        """Join the pieces and group them by series.

        Raises
        ------
        Problem
            If there are no rows, or a column holds what cannot be computed with.
        """
        if not self._rows:
            raise invalid_value("series", "the table has no rows; send at least one")
        form = self._form or TimeForm("number")
        time = self._join_times(form)
        value = self._join("value")
        weight = self._join("weight") if "weight" in self._pieces else None
        _check(time, value, weight, form)
        codes = self._join("series")
        counts = np.bincount(codes, minlength=len(self._codes))
        lat, lon = self._join_positions(codes, counts.size)
        row: Integers | None = None
        if np.any(codes[1:] < codes[:-1]):
            row = np.argsort(codes, kind="stable")
            time, value = time[row], value[row]
            weight = None if weight is None else weight[row]
        offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        return Batch(
            list(self._codes), offsets, row, time, value, weight, form, _are_whole(time, form), lat, lon
        )

    def _join(self, role: str) -> Any:
        pieces = self._pieces.pop(role)
        return pieces[0] if len(pieces) == 1 else np.concatenate(pieces)

    def _join_times(self, form: TimeForm) -> Times:
        """Join the times; pieces of nothing but missing times take the form of the others."""
        if form.kind != "number":
            blank = np.datetime64("NaT", "ns")
            self._pieces["time"] = [
                np.full(piece.size, blank) if piece.dtype.kind == "f" else piece
                for piece in self._pieces["time"]
            ]
        times: Times = self._join("time")
        return times

    def _join_positions(
        self, codes: npt.NDArray[np.int32], count: int
    ) -> tuple[Floats, Floats] | tuple[None, None]:
        """Position of each series: that of its first row that has one."""
        if "lat" not in self._pieces:
            return None, None
        lat, lon = self._join("lat"), self._join("lon")
        for role, column in (("lat", lat), ("lon", lon)):
            beyond = np.abs(column) > _FURTHEST[role]
            if beyond.any():
                limit = _FURTHEST[role]
                raise invalid_value(role, f"lies beyond ±{limit:g} degrees", int(np.argmax(beyond)))
        rows = np.flatnonzero(np.isfinite(lat) & np.isfinite(lon))[::-1]
        first = np.full(count, -1, dtype=np.int64)
        first[codes[rows]] = rows
        return np.where(first >= 0, lat[first], np.nan), np.where(first >= 0, lon[first], np.nan)


def check_position(roles: Mapping[str, object]) -> None:
    """Refuse half a position."""
    for one, other in (("lat", "lon"), ("lon", "lat")):
        if one in roles and other not in roles:
            raise invalid_value(other, f"a position has both: send {other} with {one}, or neither")


def _check(time: Times, value: Floats, weight: Floats | None, form: TimeForm) -> None:
    """As for a single series, but an infinity is left to the fit, which says so of its row."""
    columns = Columns(time, np.where(np.isinf(value), np.nan, value), weight, None, form)
    check_columns(columns, max_points=time.size)


def _are_whole(times: Times, form: TimeForm) -> bool:
    """Whether all times are integers in the form they came in."""
    if form.kind != "epoch":
        return times.dtype.kind == "i"
    present = times[~np.isnat(times)].astype(np.int64)
    return not np.any(present % UNIT_NANOSECONDS[form.unit or "s"])
