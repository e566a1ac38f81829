"""A line in words."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from estimators.inference.intervals import student_quantile
from estimators.result import Estimate
from estimators.time_axis import TimeAxis
from estimators.trends.curve import LineGeometry
from estimators.trends.presentation.units import (
    SECOND,
    moment_text,
    p_value_text,
    rounded,
    significant,
    slope_unit,
)
from estimators.trends.presentation.words import EstimateLine, estimate_line

if TYPE_CHECKING:
    from estimators.trends.trend import RunnerUp, Trend


class LineWords:
    """Wording of the straight line."""

    def equation(self, trend: Trend, time_name: str, value_name: str) -> str:
        """Equation in the unit of time that suits the span."""
        unit = slope_unit(trend)
        slope = trend.parameters["slope"].scaled(unit.seconds)
        intercept = trend.parameters["intercept"]
        change = f"{'-' if slope.value < 0 else '+'} {rounded(abs(slope.value), slope.stderr)}"
        amid = _level_amid(trend)
        if amid is not None:
            center, level = amid
            at_center = rounded(level.value, level.stderr)
            return f"{value_name} = {at_center} {change} · ({time_name} - {center:.10g})"
        start = f"{value_name} = {rounded(intercept.value, intercept.stderr)} {change}"
        if trend.axis.kind == "datetime":
            return f"{start} · ({unit.name}s since {moment_text(trend.origin)})"
        return f"{start} · {time_name}"

    def estimates(self, trend: Trend, time_name: str) -> Iterable[EstimateLine]:
        """Slope in the unit that suits the span, and the level where it says something."""
        unit = slope_unit(trend)
        slope = trend.parameters["slope"]
        yield estimate_line(f"slope{unit.per}", slope.scaled(unit.seconds), p_value_text(trend.p_value))
        if unit.name and unit != SECOND:
            yield estimate_line("slope per second", slope)
        where = moment_text(trend.origin)
        at_origin = where if trend.axis.kind == "datetime" else f"{time_name} = {where}"
        yield estimate_line(f"level at {at_origin}", trend.parameters["intercept"])
        amid = _level_amid(trend)
        if amid is not None:
            yield estimate_line(f"level at {time_name} = {amid[0]:.10g}", amid[1])

    def rival(self, trend: Trend, other: RunnerUp) -> str:
        """Slope and level of another line."""
        unit = slope_unit(trend)
        slope = significant(other.parameters["slope"] * unit.seconds)
        level = significant(other.parameters["intercept"])
        return f"slope {slope}{unit.per}, level {level} at {moment_text(trend.origin)}"


def _level_amid(trend: Trend) -> tuple[float, Estimate] | None:
    """Level at the center of the data, where the intercept is a far extrapolation and says little."""
    if trend.axis.kind == "datetime":
        return None
    line = trend.geometry
    if not isinstance(line, LineGeometry):
        return None
    first, last = line.span
    at_zero = -float(trend.axis.origin)
    if first - (last - first) <= at_zero <= last + (last - first):
        return None
    origin, internal = float(trend.axis.origin), line.center
    # A round time amid the data reads better than their very center, if floats that large can be round.
    step = 10.0 ** math.floor(math.log10(last - first) - 1)
    if math.ulp(origin) < step:
        internal = round((origin + internal) / step) * step - origin
    there = dataclasses.replace(trend, axis=TimeAxis("number", 0.0)).predict([internal])
    value, low, high = float(there.value[0]), float(there.confidence_low[0]), float(there.confidence_high[0])
    if not math.isfinite(high):
        return origin + internal, Estimate(value, None, None, None)
    stderr = (high - value) / student_quantile(trend.uncertainty.level, trend.uncertainty.dof)
    return origin + internal, Estimate(value, stderr, low, high)
