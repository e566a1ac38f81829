"""Columns of a batch for what is asked beyond the trend: values to reach, and the present regime.

Which columns there are is settled by the question, not by the answers, so that every slice of a batch has the
same ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from estimators import Crossing, TrendTable
from service.codecs.columns import UNIT_NANOSECONDS, TimeForm
from service.schemas.options import FitArguments

_CHANCES = ("probability", "reading_probability")


def values_to_reach(arguments: FitArguments) -> tuple[float, ...]:
    """Values that every series is asked about.

    Examples
    --------
    >>> values_to_reach(FitArguments(reach=90.0)), values_to_reach(FitArguments())
    ((90.0,), ())
    """
    reach = arguments.reach
    return () if reach is None else tuple(reach) if isinstance(reach, list) else (reach,)


def crossing_columns(
    table: TrendTable, arguments: FitArguments, form: TimeForm, *, with_horizon: bool
) -> dict[str, Any]:
    """When each series reaches each value, as Arrow columns.

    Parameters
    ----------
    table : TrendTable
    arguments : FitArguments
    form : TimeForm
        How times are written.
    with_horizon : bool
        Whether chances by a horizon were asked for.

    Returns
    -------
    dict of str to pyarrow.Array
        ``crossing_1_value``, ... for the first value, ``crossing_2_value`` for the next, and so on.
    """
    columns: dict[str, Any] = {}
    for place, value in enumerate(values_to_reach(arguments)):
        told: list[Crossing | None] = [found[place] if found else None for found in table.crossings]
        name = f"crossing_{place + 1}_"
        columns[name + "value"] = pa.array(np.full(len(table), value))
        for part in ("direction", "status"):
            columns[name + part] = pa.array(_parts(told, part), pa.string())
        for part in ("time", "low", "high"):
            columns[name + part] = _moments(_parts(told, part), form)
        for part in _CHANCES if with_horizon else ():
            columns[name + part] = pa.array(_parts(told, part), pa.float64())
    return columns


def regime_columns(table: TrendTable, form: TimeForm) -> dict[str, Any]:
    """How many regimes each series has, and where the present one starts."""
    present = [found[-1] if found else None for found in table.regimes]
    return {
        "regimes": pa.array([len(found) for found in table.regimes], pa.int64()),
        "regime_start": _moments(_parts(present, "start"), form),
    }


def _parts(items: Sequence[object | None], part: str) -> list[Any]:
    return [None if item is None else getattr(item, part) for item in items]


def _moments(moments: list[Any], form: TimeForm) -> Any:
    """Write times in the caller's form; fractions of a unit are kept."""
    if form.kind == "number":
        return pa.array([None if moment is None else float(moment) for moment in moments], pa.float64())
    column = np.array([np.datetime64("NaT") if moment is None else moment for moment in moments], "M8[ns]")
    if form.kind == "iso":
        return pa.array(column).cast(pa.timestamp("ns", "UTC"))
    whole, rest = np.divmod(column.astype(np.int64), UNIT_NANOSECONDS[form.unit or "s"])
    return pa.array(whole + rest / UNIT_NANOSECONDS[form.unit or "s"], mask=np.isnat(column))
