"""An exponential in words."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from estimators.result import Estimate
from estimators.trends.presentation.units import (
    SECOND,
    TimeUnit,
    moment_text,
    natural_unit,
    p_value_text,
    rounded,
    significant,
    slope_unit,
)
from estimators.trends.presentation.words import EstimateLine, estimate_line

if TYPE_CHECKING:
    from estimators.trends.trend import RunnerUp, Trend


class ExponentialWords:
    """Wording of exponential growth and decay."""

    def equation(self, trend: Trend, time_name: str, value_name: str) -> str:
        """Equation in the unit of time that suits the span."""
        unit = slope_unit(trend)
        rate = trend.parameters["rate"].scaled(unit.seconds)
        level = trend.parameters["level"]
        since = moment_text(trend.origin)
        if trend.axis.kind == "datetime":
            exponent = f"{rounded(rate.value, rate.stderr)} · ({unit.name}s since {since})"
        elif float(trend.origin) == 0.0:
            exponent = f"{rounded(rate.value, rate.stderr)} · {time_name}"
        else:
            exponent = f"{rounded(rate.value, rate.stderr)} · ({time_name} - {since})"
        return f"{value_name} = {rounded(level.value, level.stderr)} · exp({exponent})"

    def estimates(self, trend: Trend, time_name: str) -> Iterable[EstimateLine]:
        """Rate, growth, doubling or halving time, level, and the mean over the median."""
        unit = slope_unit(trend)
        rate = trend.parameters["rate"]
        yield estimate_line(f"rate{unit.per}", rate.scaled(unit.seconds), p_value_text(trend.p_value))
        for name, estimate in (trend.derived or {}).items():
            yield _derived_line(name, estimate, trend, unit)
        where = moment_text(trend.origin)
        at_origin = where if trend.axis.kind == "datetime" else f"{time_name} = {where}"
        yield estimate_line(f"level at {at_origin}", trend.parameters["level"])

    def rival(self, trend: Trend, other: RunnerUp) -> str:
        """Rate and level of another exponential."""
        unit = slope_unit(trend)
        rate = significant(other.parameters["rate"] * unit.seconds)
        level = significant(other.parameters["level"])
        return f"rate {rate}{unit.per}, level {level} at {moment_text(trend.origin)}"


def _derived_line(name: str, estimate: Estimate, trend: Trend, unit: TimeUnit) -> EstimateLine:
    if name == "mean_factor":
        return estimate_line("mean over median", estimate)
    if name.startswith("growth_percent"):
        return estimate_line(f"growth{unit.per}, %", estimate)
    title = name.replace("_", " ")
    if trend.axis.kind != "datetime":
        return _open_line(title, estimate)
    length = natural_unit(estimate.value) if estimate.value >= 2.0 else SECOND
    return _open_line(f"{title}, {length.name}s", estimate.scaled(1.0 / length.seconds))


def _open_line(title: str, estimate: Estimate) -> EstimateLine:
    """Line of an estimate whose interval may have no upper limit."""
    if estimate.low is None or estimate.high is not None:
        return estimate_line(title, estimate)
    return EstimateLine(
        name=title,
        value=rounded(estimate.value, estimate.stderr),
        stderr=rounded(estimate.stderr or 0.0, estimate.stderr),
        interval=f"[{rounded(estimate.low, estimate.low)}, no limit)",
        p_value="",
    )
