"""The caller's own columns at times of prediction, and at the rows of the fit."""

from __future__ import annotations

from typing import Any

import numpy as np

from estimators.arrays import FloatArray, InputError, as_vector
from estimators.trends.bases.curve import BasisCurve
from estimators.trends.bases.settings import named_columns
from estimators.trends.curve import Bands, Curve
from estimators.trends.unpack import plain_column


def bands_with_columns(curve: Curve, at: FloatArray, quantile: float, columns: Any) -> Bands:
    """Trend with bands where the caller's own columns have given values.

    Raises
    ------
    InputError
        If the trend has no such columns, or they do not fit the times.
    """
    if not isinstance(curve, BasisCurve) or not curve.design.own:
        raise InputError("columns", "the trend was fitted without columns")
    known = [column.name for column in curve.design.own]
    given = {
        name: as_vector(plain_column(values), "columns") for name, values in named_columns(columns).items()
    }
    if sorted(given) != sorted(known):
        raise InputError("columns", f"give the columns of the fit: {', '.join(known)}")
    for name, values in given.items():
        if values.size != at.size:
            raise InputError("columns", f"{name}: {values.size} entries for {at.size} times; give one each")
    return curve.bands_with(at, quantile, given)


def values_at_rows(curve: Curve, at: FloatArray) -> FloatArray:
    """Trend at the input rows, where the caller's own columns are known."""
    if isinstance(curve, BasisCurve) and curve.design.own:
        return curve.value_with(at, curve.rows)
    return curve.value(at)


def columns_at_rows(curve: Curve, rows: np.ndarray[Any, np.dtype[np.bool_]]) -> dict[str, FloatArray] | None:
    """Take the caller's own columns at some input rows; None for a trend without any."""
    if isinstance(curve, BasisCurve) and curve.design.own:
        return {name: values[rows] for name, values in curve.rows.items()}
    return None
