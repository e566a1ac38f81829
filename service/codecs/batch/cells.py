"""Arrow columns to numpy: names of series, numbers, times; an error names the field and the row.

Rows are counted within the column that is handed in; whoever reads a table in pieces adds the rows before
(:func:`counted_from`). What a column may be is listed here by type: anything nested, binary or boolean is
refused by its field.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.compute as pc

from service.codecs.columns import TimeForm, Times, from_epoch
from service.codecs.csv import LONGEST_NUMBER, MISSING
from service.codecs.times import parse_iso
from service.errors import Problem, invalid_value
from service.schemas.fields import TimeUnit

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

_NUMBER = r"^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$"
_INTEGER = r"^[+-]?\d+$"
_ISO_START = re.compile(r"\s*\d{4}-\d\d", re.ASCII)
_MISSING = pa.array(sorted(MISSING))
_UNITS: dict[str, TimeUnit] = {"s": "s", "ms": "ms", "us": "us", "ns": "ns"}


@contextmanager
def counted_from(first: int) -> Iterator[None]:
    """Add the rows before a piece of a table to the row of a problem met in it."""
    try:
        yield
    except Problem as problem:
        if first and problem.errors and problem.errors[0].row is not None:
            found = problem.errors[0]
            raise invalid_value(found.field, found.message, first + (found.row or 0)) from None
        raise


def is_text(kind: Any) -> bool:
    """Whether a type is text, however it is laid out."""
    return bool(pa.types.is_string(kind) or pa.types.is_large_string(kind) or pa.types.is_string_view(kind))


def name_codes(column: Any) -> tuple[Any, Integers]:
    """Names of series, each once and in the order in which they appear, and the place of every row's name.

    Parameters
    ----------
    column : pyarrow.Array
        Text or integers, dictionary-encoded or not, without nulls.

    Returns
    -------
    names : list of str or list of int
    codes : ndarray of int64, shape (n,)
    """
    kind = column.type
    is_encoded = pa.types.is_dictionary(kind)
    inner = kind.value_type if is_encoded else kind
    if not (is_text(inner) or pa.types.is_integer(inner)):
        raise invalid_value("series", "names of series are text or integers, without a mixture")
    encoded = column if is_encoded else pc.dictionary_encode(_plain_text(column))
    _refuse_null(encoded.indices, "series")
    places = encoded.indices.to_numpy(zero_copy_only=False).astype(np.int64)
    values = encoded.dictionary
    # Written backwards, so that what stays is the first row of each entry; entries never used stay at n.
    first = np.full(len(values), places.size, dtype=np.int64)
    first[places[::-1]] = np.arange(places.size - 1, -1, -1)
    used = np.flatnonzero(first < places.size)
    used = used[np.argsort(first[used], kind="stable")]
    names = values.take(pa.array(used)).to_pylist()
    for place, name in enumerate(names):
        if name is None or name == "":
            raise invalid_value("series", "is missing; name every row's series", int(first[used[place]]))
    renamed = np.zeros(len(values), dtype=np.int64)
    renamed[used] = np.arange(used.size)
    return names, renamed[places]


def read_floats(column: Any, field: str) -> Floats:
    """Numbers of a column; NaN where one is null.

    Parameters
    ----------
    column : pyarrow.Array
        Integers, floats or decimals; text as a CSV has it.
    field : str
        Named in errors.

    Returns
    -------
    ndarray of float64, shape (n,)
    """
    if pa.types.is_dictionary(column.type) and not is_text(column.type.value_type):
        column = column.dictionary_decode()
    kind = column.type
    if is_text(kind):
        return _text_floats(column, field)
    is_number = pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_decimal(kind)
    if not (is_number or pa.types.is_null(kind)):
        raise invalid_value(field, "is not a column of numbers; send integers or floats")
    numbers: Floats = pc.cast(column, pa.float64(), safe=False).to_numpy(zero_copy_only=False)
    return numbers


def read_times(
    column: Any, unit: TimeUnit | None, like: TimeForm | None, *, numbers_as_text: bool
) -> tuple[Times, TimeForm | None]:
    """Read a column of times and the form they came in.

    Parameters
    ----------
    column : pyarrow.Array
        Integers, floats, timestamps, dates, or ISO 8601 text.
    unit : {"s", "ms", "us", "ns"} or None
        Unit of numbers since 1970.
    like : TimeForm or None
        Form of the pieces before this one.
    numbers_as_text : bool
        Whether text may also hold numbers, as in a CSV.

    Returns
    -------
    times : ndarray, shape (n,)
    form : TimeForm or None
        None if text cells are all missing, so that there is none to tell.
    """
    kind = column.type
    if pa.types.is_dictionary(kind):
        if is_text(kind.value_type):
            return _dictionary_moments(column, unit)
        column = column.dictionary_decode()
        kind = column.type
    if is_text(kind):
        return _text_times(_plain_text(column), unit, like, numbers_as_text=numbers_as_text)
    if pa.types.is_timestamp(kind) or pa.types.is_date(kind):
        _refuse_unit(unit)
        return _moments(column), TimeForm("iso")
    if pa.types.is_integer(kind) or pa.types.is_null(kind):
        missing = column.is_null().to_numpy(zero_copy_only=False)
        try:
            whole: Integers = pc.cast(pc.fill_null(column, 0), pa.int64()).to_numpy(zero_copy_only=False)
        except pa.ArrowInvalid:
            raise invalid_value("time", "integers must fit into 64 bits") from None
        return _numbers(whole, missing, unit)
    if pa.types.is_floating(kind):
        floats = read_floats(column, "time")
        return _numbers(floats, np.isnan(floats), unit)
    raise invalid_value("time", "is no column of times; send numbers, timestamps, dates or ISO 8601 text")


def _numbers(
    numbers: Floats | Integers, missing: npt.NDArray[np.bool_], unit: TimeUnit | None
) -> tuple[Times, TimeForm]:
    if unit is not None:
        return from_epoch(numbers, unit, "time", missing), TimeForm("epoch", unit)
    if missing.any() and numbers.dtype.kind == "i":
        return np.where(missing, np.nan, numbers), TimeForm("number")
    return numbers, TimeForm("number")


def _moments(column: Any) -> Times:
    """Timestamps and dates as datetime64[ns]; a timestamp without a zone is taken as UTC."""
    kind = column.type
    if pa.types.is_date(kind):
        column, unit = column.cast(pa.timestamp("s")), "s"
    else:
        unit = kind.unit
    missing = column.is_null().to_numpy(zero_copy_only=False)
    counted = pc.fill_null(column.view(pa.int64()), 0).to_numpy(zero_copy_only=False)
    return from_epoch(counted, _UNITS[unit], "time", missing)


def _text_times(
    column: Any, unit: TimeUnit | None, like: TimeForm | None, *, numbers_as_text: bool
) -> tuple[Times, TimeForm | None]:
    form = like or _form_of_text(column, unit, numbers_as_text=numbers_as_text)
    if form is None:
        return np.full(len(column), np.nan), None
    if form.kind == "iso":
        return _dictionary_moments(pc.dictionary_encode(column), unit)
    integers = _text_integers(column, blank=0 if unit is not None else None)
    numbers = _text_floats(column, "time") if integers is None else integers
    missing = np.isnan(numbers) if integers is None else _is_missing(column).to_numpy(zero_copy_only=False)
    return _numbers(numbers, missing, unit)


def _form_of_text(column: Any, unit: TimeUnit | None, *, numbers_as_text: bool) -> TimeForm | None:
    """Form of the first cell that is there."""
    present = pc.index(pc.fill_null(_is_missing(column), True), False).as_py()
    if present < 0:
        return None
    if not numbers_as_text or _ISO_START.match(column[present].as_py()):
        return TimeForm("iso")
    return TimeForm("number") if unit is None else TimeForm("epoch", unit)


def _dictionary_moments(column: Any, unit: TimeUnit | None) -> tuple[Times, TimeForm]:
    """ISO 8601 texts, each distinct one read once: series of a batch mostly share their times."""
    _refuse_unit(unit)
    cells = [_as_iso(cell) for cell in column.dictionary.to_pylist()]
    places = pc.fill_null(column.indices, len(cells)).to_numpy(zero_copy_only=False).astype(np.int64)
    try:
        moments = parse_iso([*cells, None], "time")
    except Problem as problem:
        found = problem.errors[0]
        rows = np.flatnonzero(places == found.row)
        # An entry of a dictionary that no row uses is nobody's mistake worth a row, but it is one.
        raise invalid_value("time", found.message, int(rows[0]) if rows.size else None) from None
    times: Times = moments[places]
    return times, TimeForm("iso")


def _as_iso(cell: str | None) -> str | None:
    return None if cell is None or cell.strip().lower() in MISSING else cell.strip()


def _refuse_unit(unit: TimeUnit | None) -> None:
    if unit is not None:
        raise invalid_value("time_unit", "is for numbers since 1970; leave it out with dates and timestamps")


def _refuse_null(column: Any, field: str) -> None:
    if column.null_count:
        row = int(np.argmax(column.is_null().to_numpy(zero_copy_only=False)))
        raise invalid_value(field, "is missing; name every row's series", row)


def _plain_text(column: Any) -> Any:
    return column.cast(pa.large_string()) if pa.types.is_string_view(column.type) else column


def _is_missing(column: Any) -> Any:
    return pc.or_kleene(
        column.is_null(), pc.is_in(pc.ascii_lower(pc.utf8_trim_whitespace(column)), value_set=_like(column))
    )


def _like(column: Any) -> Any:
    return _MISSING.cast(column.type)


def _text_integers(column: Any, blank: int | None) -> Integers | None:
    """Integers exactly, or None where a cell is something else; ``blank`` stands for a missing one."""
    trimmed = pc.utf8_trim_whitespace(column)
    if blank is not None:
        trimmed = pc.if_else(_is_missing(column), pa.scalar(str(blank), column.type), trimmed)
    if trimmed.null_count or not pc.all(pc.match_substring_regex(trimmed, _INTEGER), min_count=0).as_py():
        return None
    try:
        digits = pc.utf8_ltrim(trimmed, characters="+")
        integers: Integers = pc.cast(digits, pa.int64()).to_numpy(zero_copy_only=False)
    except pa.ArrowInvalid:
        return None
    return integers


def _text_floats(column: Any, field: str) -> Floats:
    column = _plain_text(column)
    missing = _is_missing(column)
    cells = pc.if_else(missing, pa.scalar(None, column.type), pc.utf8_trim_whitespace(column))
    fits = pc.less_equal(pc.binary_length(cells), LONGEST_NUMBER)
    good = pc.or_kleene(missing, pc.and_kleene(fits, pc.match_substring_regex(cells, _NUMBER)))
    if not pc.all(good, min_count=0).as_py():
        row = pc.index(good, False).as_py()
        raise invalid_value(field, "expected a number or an empty cell", row)
    numbers: Floats = pc.cast(pc.utf8_ltrim(cells, characters="+"), pa.float64()).to_numpy(
        zero_copy_only=False
    )
    infinite = np.isinf(numbers)
    if infinite.any():
        raise invalid_value(field, "is too large a number for a 64-bit float", int(np.argmax(infinite)))
    return numbers
