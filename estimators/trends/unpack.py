"""What callers hand over as a series: two columns, or one object that carries both."""

from __future__ import annotations

from typing import Any

import numpy as np

from estimators.arrays import ArrayLike, InputError


def unpack_series(t: ArrayLike, y: ArrayLike | None) -> tuple[Any, Any]:
    """Times and values of two columns or of one indexed series.

    A pandas Series is known by its ``index`` and ``to_numpy``; pandas is not imported. Times with a time
    zone are converted to UTC, which loses nothing that a fit could use.

    Parameters
    ----------
    t : array_like, shape (n,)
        Times, or a pandas Series whose index is the time.
    y : array_like, shape (n,), optional

    Raises
    ------
    InputError
        If there are no values.
    """
    if y is None:
        if not hasattr(t, "index") or not hasattr(t, "to_numpy"):
            raise InputError("y", "give values, or a pandas Series with its times as the index")
        return _plain(t.index), _plain(t)
    return _plain(t), _plain(y)


def _plain(column: Any) -> Any:
    """Numpy array of a pandas column or index; anything else as it is."""
    if not hasattr(column, "to_numpy"):
        return column
    converted = column
    accessor = getattr(column, "dt", None)
    if getattr(column, "tz", None) is not None:
        converted = column.tz_convert("UTC").tz_localize(None)
    elif accessor is not None and getattr(accessor, "tz", None) is not None:
        converted = accessor.tz_convert("UTC").dt.tz_localize(None)
    try:
        return converted.to_numpy(na_value=np.nan) if _is_nullable(converted) else converted.to_numpy()
    except (TypeError, ValueError):
        return converted.to_numpy()


def _is_nullable(column: Any) -> bool:
    """Whether a pandas column has a nullable number type (``Int64``, ``Float64``)."""
    return getattr(getattr(column, "dtype", None), "na_value", None) is not None and hasattr(
        column.dtype, "numpy_dtype"
    )
