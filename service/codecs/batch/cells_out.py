"""Columns of an answer: as Arrow arrays, and from those as Python values for the formats that are text.

NaN stands for "there is none": null in Arrow, and orjson writes it as null.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pyarrow as pa

from service.codecs.columns import UNIT_NANOSECONDS, TimeForm, Times

_ISO = TimeForm("iso")


def number_array(column: Any) -> Any:
    """Floats as an Arrow array, with null for NaN."""
    return pa.array(np.asarray(column, dtype=np.float64), from_pandas=True)


def time_array(times: Times, form: TimeForm, *, whole: bool) -> Any:
    """Render times as an Arrow array in the form they came: numbers, timestamps, or numbers since 1970.

    Parameters
    ----------
    times : ndarray, shape (n,)
    form : TimeForm
    whole : bool
        Whether numbers since 1970 are written as integers.
    """
    if form.kind == "number":
        return number_array(times) if times.dtype.kind == "f" else pa.array(times)
    moments = times.astype("datetime64[ns]")
    if form.kind == "iso":
        return pa.array(moments).cast(pa.timestamp("ns", "UTC"))
    factor = UNIT_NANOSECONDS[form.unit or "s"]
    missing = np.isnat(moments)
    quotient, rest = np.divmod(moments.astype(np.int64), factor)
    if whole:
        return pa.array(quotient, mask=missing)
    return pa.array(quotient + rest / factor, mask=missing)


def to_values(column: Any) -> list[Any]:
    """Entries of a column; a list column gives lists, a point in time ISO 8601 text.

    Parameters
    ----------
    column : pyarrow.Array

    Returns
    -------
    list, length n

    Examples
    --------
    >>> to_values(pa.array([[1, 2], [], [3]]))
    [[1, 2], [], [3]]
    """
    kind = column.type
    if pa.types.is_list(kind):
        offsets = column.offsets.to_numpy().tolist()
        flat = to_values(column.values)
        return [flat[start:stop] for start, stop in itertools.pairwise(offsets)]
    if pa.types.is_timestamp(kind):
        rendered = _ISO.render(column.cast(pa.timestamp("ns")).to_numpy(zero_copy_only=False))
        if isinstance(rendered, list):
            return rendered
        texts: list[str] = np.datetime_as_string(np.asarray(rendered, dtype="datetime64[s]")).tolist()
        return [f"{text}Z" for text in texts]
    if pa.types.is_floating(kind) or (pa.types.is_primitive(kind) and not column.null_count):
        values: list[Any] = column.to_numpy(zero_copy_only=False).tolist()
        return values
    listed: list[Any] = column.to_pylist()
    return listed


def to_rows(part: Any) -> list[dict[str, Any]]:
    """Rows of a record batch as dicts."""
    names = part.schema.names
    columns = [to_values(column) for column in part.columns]
    return [dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)]
