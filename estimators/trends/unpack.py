"""What callers hand over as a series: two columns, or one object that carries both."""

from __future__ import annotations

from typing import Any

import numpy as np

from estimators.arrays import ArrayLike, InputError


def unpack_series(t: ArrayLike, y: ArrayLike | None) -> tuple[Any, Any]:
    """Take apart two columns, or one indexed series, into times and values.

    A pandas Series is known by its ``index`` and ``to_numpy``; pandas is not imported. Times with a time
    zone are converted to UTC, which loses nothing that a fit could use.

    Parameters
    ----------
    t : array_like, shape (n,)
        Times, or a pandas Series or DataFrame of one column whose index is the time.
    y : array_like, shape (n,), optional

    Raises
    ------
    InputError
        If there are no values, or several columns of them.
    """
    if y is None:
        if not hasattr(t, "index") or not hasattr(t, "to_numpy"):
            raise InputError("y", "give values, or a pandas Series with its times as the index")
        return plain_column(t.index), plain_column(_only_column(t, "y"))
    return plain_column(_only_column(t, "t")), plain_column(_only_column(y, "y"))


def plain_column(column: Any) -> Any:
    """Convert a pandas column or index to a numpy array; anything else stays as it is.

    Parameters
    ----------
    column : array_like
        Missing entries of nullable integers become None, which leaves the others exact; of other numbers NaN.

    Returns
    -------
    ndarray or the column itself
    """
    if not hasattr(column, "to_numpy"):
        return column
    converted = column
    accessor = getattr(column, "dt", None)
    if getattr(column, "tz", None) is not None:
        converted = column.tz_convert("UTC").tz_localize(None)
    elif accessor is not None and getattr(accessor, "tz", None) is not None:
        converted = accessor.tz_convert("UTC").dt.tz_localize(None)
    # Only pandas' nullable number types (Int64, Float64) say which numpy type is under them.
    nullable = getattr(getattr(converted, "dtype", None), "numpy_dtype", None)
    if nullable is None or nullable.kind not in "iuf" or not converted.isna().any():
        return converted.to_numpy()
    if nullable.kind == "f":
        return converted.to_numpy(dtype=np.float64, na_value=np.nan)
    return converted.to_numpy(dtype=object, na_value=None)


def _only_column(column: Any, field: str) -> Any:
    """Column of a pandas frame that has no other; anything else stays as it is."""
    if not (hasattr(column, "columns") and hasattr(column, "iloc")):
        return column
    names = [repr(name) for name in column.columns]
    if len(names) != 1:
        named = f" ({', '.join(names[:5])}{', ...' if len(names) > 5 else ''})" if names else ""
        raise InputError(field, f"choose one column: the frame has {len(names)}{named}")
    return column.iloc[:, 0]
