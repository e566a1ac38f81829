"""The slope per second, minute, hour, day, week or year, and the unit that suits the span."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from estimators.arrays import InputError
from estimators.result import Estimate
from estimators.trends.presentation.units import natural_unit

if TYPE_CHECKING:
    from estimators.trends.trend import Trend

# The Julian year of 365.25 days is the astronomers' and climatologists' year of fixed length.
SECONDS: Mapping[str, float] = MappingProxyType(
    {
        "second": 1.0,
        "minute": 60.0,
        "hour": 3600.0,
        "day": 86400.0,
        "week": 7 * 86400.0,
        "year": 365.25 * 86400.0,
    }
)
"""Length of the units that slopes are told in."""


def slope_per(trend: Trend, unit: str | None) -> Estimate:
    """Answer :meth:`estimators.Trend.slope_per`."""
    slope = trend.parameters.get("slope")
    if slope is None:
        raise InputError("model", f"a trend of model {trend.model} has no slope")
    if trend.axis.kind != "datetime":
        if unit is not None:
            raise InputError("unit", "the times are plain numbers, whose unit nobody told; leave it out")
        return slope
    if unit is None:
        return slope.scaled(SECONDS[_natural(trend)])
    if unit not in SECONDS:
        raise InputError("unit", f"unknown unit {unit!r}; known: {', '.join(SECONDS)}")
    return slope.scaled(SECONDS[unit])


def slope_per_to_dict(trend: Trend) -> dict[str, Any] | None:
    """Slope in the unit that suits the span, JSON-safe; None for shapes without one."""
    if "slope" not in trend.parameters:
        return None
    slope = slope_per(trend, None)
    unit = _natural(trend) if trend.axis.kind == "datetime" else None
    return {"unit": unit, "value": slope.value, "low": slope.low, "high": slope.high}


def _natural(trend: Trend) -> str:
    first, last = trend.geometry.span
    return natural_unit(last - first).name
