"""Numbers and times as people write them: digits that the uncertainty supports, units that fit the span."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from estimators.trends.trend import Trend

MISSING = "–"
"""What stands where there is nothing to say."""


@dataclass(frozen=True, slots=True)
class TimeUnit:
    """A unit to state slopes in.

    Attributes
    ----------
    name : str
        Singular; empty for plain numbers, whose unit nobody told us.
    seconds : float
        Its length; 1 for plain numbers.
    """

    name: str
    seconds: float

    @property
    def per(self) -> str:
        """Suffix of a slope: ``" per day"``, or nothing for plain numbers."""
        return f" per {self.name}" if self.name else ""


SECOND = TimeUnit("second", 1.0)
PLAIN = TimeUnit("", 1.0)
# The Julian year of 365.25 days is the astronomers' and climatologists' year of fixed length.
_UNITS = (
    TimeUnit("year", 365.25 * 86400.0),
    TimeUnit("day", 86400.0),
    TimeUnit("hour", 3600.0),
    TimeUnit("minute", 60.0),
)


def natural_unit(span_s: float) -> TimeUnit:
    """Choose the largest unit of which a span holds at least two.

    Parameters
    ----------
    span_s : float
        Seconds.

    Returns
    -------
    TimeUnit

    Examples
    --------
    >>> natural_unit(3 * 86400).name
    'day'
    """
    return next((unit for unit in _UNITS if span_s >= 2 * unit.seconds), SECOND)


def slope_unit(trend: Trend) -> TimeUnit:
    """Choose the unit of time in which the slope reads best."""
    if trend.axis.kind != "datetime":
        return PLAIN
    first, last = trend.geometry.span
    return natural_unit(last - first)


def significant(value: float, digits: int = 4) -> str:
    """Write a number with so many significant digits, scientific only far from 1."""
    if not math.isfinite(value):
        return MISSING
    return f"{value:.{digits}g}"


def rounded(value: float, uncertainty: float | None) -> str:
    """Write a number to the second significant digit of its uncertainty.

    Parameters
    ----------
    value : float
    uncertainty : float or None
        Standard error; without one the number has six digits, with one that is next to nothing seven.

    Returns
    -------
    str

    Examples
    --------
    >>> rounded(0.0192345, 0.00061), rounded(12345678.9, 2300.0), rounded(-6.1e-10, 2e-11)
    ('0.01923', '1.23457e+07', '-6.10e-10')
    """
    if not math.isfinite(value):
        return MISSING
    if value == 0.0:
        return "0"
    if uncertainty is None or not math.isfinite(uncertainty) or uncertainty <= 0.0:
        return f"{value:.6g}"
    last = math.floor(math.log10(uncertainty)) - 1
    first = math.floor(math.log10(abs(value)))
    if first - last > 6:
        return f"{value:.7g}"
    largest = max(first, last + 1)
    if -4 <= largest < 7:
        return f"{value:.{max(-last, 0)}f}"
    return f"{value:.{max(first - last, 0)}e}"


def percent(share: float) -> str:
    """Write a share as a percentage that never rounds up to certainty.

    Examples
    --------
    >>> percent(0.963), percent(0.99999), percent(1.0)
    ('96.3 %', '> 99.9 %', '100 %')
    """
    if share in (0.0, 1.0):
        return f"{100 * share:.0f} %"
    if share > 0.999:
        return "> 99.9 %"
    if share < 0.001:
        return "< 0.1 %"
    return f"{100 * share:.1f} %"


def p_value_text(p_value: float | None) -> str:
    """Write a p-value with two digits; what floating point cannot hold is said to be smaller than it can."""
    if p_value is None or not math.isfinite(p_value):
        return MISSING
    return f"{p_value:.2g}" if p_value > 0.0 else "< 1e-300"


def moment_text(moment: float | np.integer | np.datetime64) -> str:
    """Write a time for people: a date where it is midnight, no empty seconds, numbers as they are.

    Examples
    --------
    >>> moment_text(np.datetime64("2024-02-29T00:00")), moment_text(np.datetime64("2024-02-29T14:05:00"))
    ('2024-02-29', '2024-02-29 14:05')
    """
    if not isinstance(moment, np.datetime64):
        if not math.isfinite(moment):
            return MISSING
        return str(moment) if isinstance(moment, (int, np.integer)) else f"{moment:.10g}"
    if np.isnat(moment):
        return MISSING
    day, _, clock = str(moment.astype("datetime64[ns]")).partition("T")
    clock = clock.rstrip("0").rstrip(".") if not clock.endswith(":00.000000000") else clock[:5]
    return day if clock == "00:00" else f"{day} {clock}"
