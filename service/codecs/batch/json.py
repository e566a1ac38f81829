"""A batch as JSON: the columns of the long table, as arrays of equal length.

The same columns as in every other format, ``{"series": [...], "time": [...], "value": [...]}``; the
arguments of the fit are query parameters for all of them.
"""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
import pyarrow as pa

from service.codecs.batch.rows import OPTIONAL, REQUIRED, ROLES, Batch, Gatherer, Reading, check_position
from service.codecs.json import decode_column, is_null, read_numbers, read_object, read_times
from service.errors import invalid_value

_NAMES = msgspec.json.Decoder(list[int | str])


def read_json(source: Any, reading: Reading) -> Batch:
    """Batch of a JSON body.

    Parameters
    ----------
    source : pyarrow.NativeFile
    reading : Reading

    Raises
    ------
    Problem
        If the body is not JSON, holds unknown or repeated keys, or an entry of the wrong type.
    """
    keys = {role: reading.columns.get(role) or role for role in ROLES}
    fields = read_object(source.read(), tuple(keys.values()), "")
    given = {role: fields[key] for role, key in keys.items() if not is_null(fields.get(key))}
    for role in REQUIRED:
        if role not in given:
            raise invalid_value(role, "is required")
    check_position(given)
    series = _names(given["series"])
    times, form = read_times(given["time"], "time", reading.time_unit)
    numbers = {role: read_numbers(given[role], role) for role in ("value", *OPTIONAL) if role in given}
    for role, size in [("time", times.size), *((role, column.size) for role, column in numbers.items())]:
        if size != len(series):
            raise invalid_value(role, f"{size} entries for {len(series)} rows of series; send one per row")
    gatherer = Gatherer(reading)
    gatherer.add_read(series, times, form, numbers)
    return gatherer.finish()


def _names(raw: msgspec.Raw) -> Any:
    """Names as an Arrow column, of text or of integers."""
    column = decode_column(_NAMES, raw, "series")
    kinds = set(map(type, column))
    if len(kinds) > 1:
        first = type(column[0])
        row = next(row for row, item in enumerate(column) if type(item) is not first)
        raise invalid_value("series", "mixes text and integers; name all series in one way", row)
    if kinds != {int}:
        try:
            return pa.array(column, pa.large_string())
        except UnicodeEncodeError:
            raise invalid_value("series", "holds text that is not valid Unicode") from None
    try:
        return pa.array(np.array(column, dtype=np.int64))
    except OverflowError:
        row = next(row for row, item in enumerate(column) if not -(2**63) <= item < 2**63)
        raise invalid_value("series", "integers must fit into 64 bits", row) from None
