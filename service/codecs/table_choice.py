"""Which column of a table is which: as the caller says, or by a guess that is told."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass

from service.codecs.table_cells import Kind
from service.codecs.table_text import TableError

# Names by which people call the column of times, and those of columns that only number the rows.
_TIME_NAMES = frozenset({"time", "timestamp", "datetime", "date", "year", "t", "x", "epoch", "ts"})
_VALUE_NAMES = frozenset({"value", "values", "y"})
_ROW_NAMES = frozenset({"", "index", "id", "row", "rownames", "row_names", "unnamed: 0"})
_LISTED = 20


@dataclass(frozen=True, slots=True)
class Headings:
    """Names of the columns and what they hold.

    Attributes
    ----------
    names : tuple of str
        Empty for columns without a name.
    kinds : tuple of Kind
        One per column of the rows.
    trusted : bool
        Whether there is one name per column; if not, columns go by position alone.
    """

    names: tuple[str, ...]
    kinds: tuple[Kind, ...]
    trusted: bool

    def label(self, place: int) -> str:
        """Name of a column for people: its own, or its position counted from 1."""
        name = self.names[place] if self.trusted else ""
        return repr(name) if name else str(place + 1)

    def title(self, place: int) -> str:
        """Name of a column as it stands beside an axis."""
        name = self.names[place] if self.trusted else ""
        return name or f"column {place + 1}"

    def listing(self) -> str:
        """All columns in a sentence."""
        labels = [self.label(place) for place in range(min(len(self.kinds), _LISTED))]
        return ", ".join(labels) + (", ..." if len(self.kinds) > _LISTED else "")


@dataclass(frozen=True, slots=True)
class Choice:
    """Positions of the columns, and the roles that nobody named."""

    time: int
    value: int
    weight: int | None
    guessed: tuple[str, ...]
    own: tuple[int, ...] = ()


def choose_columns(
    headings: Headings, time: str | None, value: str | None, weight: str | None, own: Sequence[str] = ()
) -> Choice:
    """Decide which column is which.

    A time is guessed to be the first column of dates, else the first number column with a usual name,
    else the first number column that does not just number the rows; a value the first other number
    column; a weight only the column that is called ``weight``, as in the service.

    Parameters
    ----------
    headings : Headings
    time, value, weight : str or None
        Name or position (from 1) of a column, None to guess.
    own : sequence of str
        Names or positions of further columns, to be fitted along.

    Returns
    -------
    Choice

    Raises
    ------
    TableError
        If a column is not there, is asked for twice, or cannot be guessed.
    """
    weight_place = None if weight is None else find_column(headings, weight, "weight")
    if weight is None and headings.trusted and "weight" in headings.names and "weight" not in (time, value):
        weight_place = headings.names.index("weight")
    value_place = None if value is None else find_column(headings, value, "value")
    own_places = tuple(find_column(headings, name, "column") for name in own)
    taken = {place for place in (weight_place, value_place, *own_places) if place is not None}
    time_place = _guess_time(headings, taken) if time is None else find_column(headings, time, "time")
    if value_place is None:
        value_place = _guess_value(headings, taken | {time_place})
    if time_place == value_place:
        raise TableError(
            f"column {headings.label(time_place)} cannot be both time and value; give two columns"
        )
    guesses = {
        "time": time is None,
        "value": value is None,
        "weight": weight is None and weight_place is not None,
    }
    for place in own_places:
        if place in (time_place, value_place, weight_place) or own_places.count(place) > 1:
            raise TableError(f"column {headings.label(place)} has another role already; name another")
    return Choice(
        time_place,
        value_place,
        weight_place,
        tuple(role for role, told in guesses.items() if told),
        own_places,
    )


def find_column(headings: Headings, asked: str, role: str) -> int:
    """Position of a column by its name, else by its position counted from 1.

    Raises
    ------
    TableError
        Listing the columns if there is none.
    """
    if headings.trusted:
        for wanted, names in (
            (asked, headings.names),
            (asked.strip().lower(), tuple(name.lower() for name in headings.names)),
        ):
            places = [place for place, name in enumerate(names) if name == wanted]
            if len(places) > 1:
                positions = " or ".join(f"--{role} {place + 1}" for place in places)
                raise TableError(f"more than one column is called {asked!r}; say {positions}")
            if places:
                return places[0]
    if asked.isascii() and asked.isdigit() and 1 <= int(asked) <= len(headings.kinds):
        return int(asked) - 1
    _refuse_untrusted(headings)
    close = difflib.get_close_matches(asked, headings.names, n=1)
    hint = f" (did you mean {close[0]!r}?)" if close else ""
    columns = headings.listing()
    raise TableError(f"there is no column {asked!r} for --{role}{hint}; the columns are: {columns}")


def _guess_time(headings: Headings, taken: set[int]) -> int:
    def rank(place: int) -> tuple[bool, bool, bool, int]:
        name = _name(headings, place)
        return headings.kinds[place] != "time", name not in _TIME_NAMES, name in _ROW_NAMES, place

    usable = [
        place
        for place, kind in enumerate(headings.kinds)
        if kind in ("time", "number") and place not in taken
    ]
    if not usable:
        raise TableError(f"no column holds times or numbers; the columns are: {headings.listing()}")
    _refuse_untrusted(headings)
    return min(usable, key=rank)


def _guess_value(headings: Headings, taken: set[int]) -> int:
    def rank(place: int) -> tuple[bool, bool, int]:
        name = _name(headings, place)
        return name not in _VALUE_NAMES, name in _ROW_NAMES, place

    usable = [place for place, kind in enumerate(headings.kinds) if kind == "number" and place not in taken]
    if not usable:
        raise TableError(
            f"no column of numbers is left for the values; the columns are: {headings.listing()} (if cells "
            "are cut in the wrong places, say what separates them with --delimiter)"
        )
    _refuse_untrusted(headings)
    return min(usable, key=rank)


def _refuse_untrusted(headings: Headings) -> None:
    """Refuse to go by names where there is not one for every column."""
    if headings.names and not headings.trusted:
        raise TableError(
            f"the header names {len(headings.names)} columns but the rows have {len(headings.kinds)}; say "
            f"which to take by position, for example --time 1 --value {min(2, len(headings.kinds))}"
        )


def _name(headings: Headings, place: int) -> str:
    return headings.names[place].strip().lower() if place < len(headings.names) else "column"


def names_a_header(first: Sequence[str], kinds: Sequence[Kind], first_kinds: Sequence[Kind]) -> bool:
    """Whether the first row names the columns: it has text where the rows below have numbers or times.

    Parameters
    ----------
    first : sequence of str
        The first row.
    kinds : sequence of Kind
        What the columns hold below it.
    first_kinds : sequence of Kind
        What each of its own cells is.
    """
    if not any(cell.strip() for cell in first):
        return False
    below = list(zip(first_kinds, kinds, strict=False))
    if any(kind in ("number", "time") for _, kind in below):
        return any(own == "text" and kind in ("number", "time") for own, kind in below)
    return "number" not in first_kinds and "time" not in first_kinds
