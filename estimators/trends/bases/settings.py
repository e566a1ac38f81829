"""What a caller may ask of a trend of columns: degree, seasons, harmonics, own columns; checked here."""

from __future__ import annotations

import datetime as dt
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from numbers import Integral, Real
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from estimators.arrays import LARGEST_TIME, SMALLEST_TIME, ArrayLike, FloatArray, InputError, as_vector
from estimators.time_axis import TimeAxis
from estimators.trends.unpack import plain_column

MOST_DEGREE = 5
MOST_HARMONICS = 8
MOST_COLUMNS = 8
MOST_PERIODS = 4

CALENDAR: Mapping[str, float] = MappingProxyType(
    {"hour": 3600.0, "day": 86400.0, "week": 604800.0, "month": 365.25 * 7200.0, "year": 365.25 * 86400.0}
)
"""Periods by name, in seconds; the year is the Julian one of 365.25 days, the month a twelfth of it."""

_PARAMETER = re.compile(r"slope|slope_end|intercept|level|power_\d+|season_\d+_(amplitude|peak)")
"""What the trend's own parameters are called."""

Period = float | str | np.timedelta64 | dt.timedelta


@dataclass(frozen=True, slots=True)
class Basis:
    """Settings of a trend of columns; every argument is checked.

    Attributes
    ----------
    degree : int or None
        Of the polynomial; None for the shape's own.
    harmonics : int or None
        Pairs of cosine and sine per period; None to choose them from the data.
    columns : mapping of str to ndarray of float64, shape (n,)
        The caller's own columns by name, one entry per input row.
    seasonal : tuple of period, "auto" or None
    found : bool
        Whether the periods were found in the data, and not given.
    """

    degree: int | None = None
    harmonics: int | None = None
    columns: Mapping[str, FloatArray] = field(default_factory=dict)
    seasonal: tuple[Period, ...] | Literal["auto"] | None = None
    found: bool = False

    @property
    def is_plain(self) -> bool:
        """Whether nothing is asked for beyond the shape itself."""
        return not self.columns and not self.seasonal

    def asked(self) -> tuple[str, ...]:
        """Names of the settings that were given."""
        given = {
            "degree": self.degree is not None,
            "harmonics": self.harmonics is not None,
            "columns": bool(self.columns),
            "seasonal": bool(self.seasonal),
        }
        return tuple(name for name, is_given in given.items() if is_given)


def check_basis(degree: int | None, harmonics: int | None, columns: Any, seasonal: Any) -> Basis:
    """Check the settings of a trend of columns.

    Parameters
    ----------
    degree : int or None
        0 to MOST_DEGREE.
    harmonics : int or None
        1 to MOST_HARMONICS; only with ``seasonal``.
    columns : mapping of str to array_like, array_like of shape (n,) or (n, k), or None
    seasonal : period, sequence of periods, "auto" or None
        Periods in the unit of time (seconds for points in time), by a name of :data:`CALENDAR`, or
        timedeltas.

    Raises
    ------
    InputError

    Examples
    --------
    >>> check_basis(None, None, None, 12).seasonal, check_basis(2, None, None, None).asked()
    ((12.0,), ('degree',))
    """
    periods = _check_periods(seasonal)
    if harmonics is not None and not periods:
        raise InputError("harmonics", "goes with seasonal; give its periods, or 'auto'")
    return Basis(
        _check_count("degree", degree, 0, MOST_DEGREE),
        _check_count("harmonics", harmonics, 1, MOST_HARMONICS),
        _check_columns(columns),
        periods,
    )


def periods_of(seasonal: Sequence[Period], axis: TimeAxis) -> tuple[float, ...]:
    """Periods in the internal unit of time, the longest first.

    Raises
    ------
    InputError
        If a period is given by name or as a timedelta and the times are plain numbers.
    """
    periods = []
    for period in seasonal:
        if isinstance(period, (int, float)):
            periods.append(float(period))
            continue
        if axis.kind != "datetime":
            raise InputError("seasonal", f"{period!r} needs points in time; for plain times give a number")
        if isinstance(period, str):
            periods.append(CALENDAR[period])
        else:
            periods.append(float(np.timedelta64(period) / np.timedelta64(1, "ns")) / 1e9)
    periods.sort(reverse=True)
    for longer, shorter in pairwise(periods):
        if longer <= shorter * (1.0 + 1e-9):
            raise InputError("seasonal", "a period is given twice; give each once")
    return tuple(periods)


def _check_count(name: str, value: Any, least: int, most: int) -> int | None:
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, Integral) or not least <= int(value) <= most:
        raise InputError(name, f"must be an integer from {least} to {most}")
    return int(value)


def _check_periods(seasonal: Any) -> tuple[Period, ...] | Literal["auto"] | None:
    if seasonal is None:
        return None
    if isinstance(seasonal, str) and seasonal == "auto":
        return "auto"
    if isinstance(seasonal, (str, Real, np.timedelta64, dt.timedelta)):
        seasonal = (seasonal,)
    try:
        given = tuple(seasonal)
    except TypeError as error:
        raise InputError("seasonal", "expected periods, or 'auto'") from error
    if not 1 <= len(given) <= MOST_PERIODS:
        raise InputError("seasonal", f"give one to {MOST_PERIODS} periods, 'auto', or nothing")
    return tuple(_check_period(period) for period in given)


def _check_period(period: Any) -> Period:
    if isinstance(period, str):
        if period not in CALENDAR:
            names = ", ".join(CALENDAR)
            raise InputError(
                "seasonal", f"unknown period {period!r}; give a number, 'auto', or one of {names}"
            )
        return period
    if isinstance(period, (np.timedelta64, dt.timedelta)):
        if not period > type(period)(0):
            raise InputError("seasonal", "a period must be positive")
        return period
    if isinstance(period, bool) or not isinstance(period, Real):
        raise InputError("seasonal", "a period must be a number, a timedelta or the name of one")
    if not SMALLEST_TIME <= float(period) <= LARGEST_TIME:
        raise InputError("seasonal", f"a period must lie between {SMALLEST_TIME:g} and {LARGEST_TIME:g}")
    return float(period)


def _check_columns(columns: Any) -> Mapping[str, FloatArray]:
    if columns is None:
        return {}
    return {name: _check_column(name, column) for name, column in named_columns(columns).items()}


def named_columns(columns: Any) -> Mapping[str, ArrayLike]:
    """Columns by name: those of a mapping or a data frame, or ``column_1``, ... of an array.

    Raises
    ------
    InputError
        If there are too many, or their names are not text.
    """
    if isinstance(columns, Mapping):
        made = dict(columns)
    elif hasattr(columns, "columns") and hasattr(columns, "iloc"):
        made = {str(name): columns.iloc[:, k] for k, name in enumerate(columns.columns)}
    else:
        array = np.asarray(plain_column(columns))
        if array.ndim not in (1, 2):
            raise InputError("columns", f"expected one column or a table of them, got shape {array.shape}")
        table = array[:, np.newaxis] if array.ndim == 1 else array
        made = {f"column_{k + 1}": table[:, k] for k in range(table.shape[1])}
    if not all(isinstance(name, str) and name for name in made):
        raise InputError("columns", "the names of columns must be text")
    if len(made) > MOST_COLUMNS:
        raise InputError("columns", f"at most {MOST_COLUMNS} columns can be fitted together")
    return made


def _check_column(name: str, column: ArrayLike) -> FloatArray:
    if _PARAMETER.fullmatch(name):
        raise InputError(
            "columns", f"{name} is the name of a parameter of the trend; call the column otherwise"
        )
    vector = as_vector(plain_column(column), "columns")
    if np.any(np.isfinite(vector) & (np.abs(vector) > LARGEST_TIME)):
        raise InputError("columns", f"{name}: a value is beyond ±{LARGEST_TIME:g}; use a larger unit")
    return vector
