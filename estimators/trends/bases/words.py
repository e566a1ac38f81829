"""A trend of columns in words: polynomial, seasons, the caller's own columns."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from estimators.trends.bases.curve import BasisCurve
from estimators.trends.bases.design import Season, polynomial_powers
from estimators.trends.bases.settings import CALENDAR
from estimators.trends.line.words import LineWords
from estimators.trends.presentation.units import (
    SECOND,
    moment_text,
    natural_unit,
    p_value_text,
    rounded,
    significant,
    slope_unit,
)
from estimators.trends.presentation.words import EstimateLine, Words, estimate_line

if TYPE_CHECKING:
    from estimators.trends.trend import RunnerUp, Trend

_RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


class BasisWords:
    """Wording of levels, polynomials and seasons."""

    def equation(self, trend: Trend, time_name: str, value_name: str) -> str:
        """Polynomial about a time that is named, then each season with its amplitude."""
        curve = _curve(trend)
        parts = [_polynomial_text(trend, curve, time_name)]
        for column in curve.design.own:
            estimate = trend.parameters[column.name]
            parts.append(f"{_signed(estimate.value, estimate.stderr)} · {column.name}")
        for index, season in enumerate(curve.design.seasons):
            amplitude = trend.parameters[f"season_{index + 1}_amplitude"]
            swing = rounded(amplitude.value, amplitude.stderr)
            parts.append(f"+ season of {period_text(trend, season)} (±{swing})")
        return f"{value_name} = {' '.join(parts)}{_where(trend, curve, time_name)}"

    def estimates(self, trend: Trend, time_name: str) -> Iterable[EstimateLine]:
        """Slopes in the unit that suits the span, levels, own columns, amplitudes and peaks."""
        unit = slope_unit(trend)
        p_value = p_value_text(trend.p_value)
        where = moment_text(trend.origin)
        at_origin = where if trend.axis.kind == "datetime" else f"{time_name} = {where}"
        labels = {"slope": f"slope{unit.per}", "slope_end": f"slope{unit.per} at the end"}
        for name, estimate in trend.parameters.items():
            if name in labels:
                shown = p_value if name == "slope" else ""
                yield estimate_line(labels[name], estimate.scaled(unit.seconds), shown)
                if name == "slope" and unit.name and unit != SECOND:
                    yield estimate_line("slope per second", estimate)
            elif name.startswith("power_"):
                power = int(name.removeprefix("power_"))
                text = f"power {power}{unit.per}" + ("" if not unit.name else f" to the {power}")
                yield estimate_line(text, estimate.scaled(unit.seconds**power))
            elif name == "intercept":
                yield estimate_line(f"level at {at_origin}", estimate)
            elif not name.startswith("season_"):
                yield estimate_line(name, estimate)
        yield from _season_lines(trend)

    def rival(self, trend: Trend, other: RunnerUp) -> str:
        """Slope and level of another trend."""
        unit = slope_unit(trend)
        parts = []
        if "slope" in other.parameters:
            parts.append(f"slope {significant(other.parameters['slope'] * unit.seconds)}{unit.per}")
        level = other.parameters.get("intercept", other.parameters.get("level"))
        if level is not None:
            parts.append(f"level {significant(level)}")
        return ", ".join(parts)


class StraightWords:
    """Wording of the line, which may have seasons."""

    def equation(self, trend: Trend, time_name: str, value_name: str) -> str:
        """Equation of the line, and each season."""
        return _wording(trend).equation(trend, time_name, value_name)

    def estimates(self, trend: Trend, time_name: str) -> Iterable[EstimateLine]:
        """Lines of the table of parameters."""
        return _wording(trend).estimates(trend, time_name)

    def rival(self, trend: Trend, other: RunnerUp) -> str:
        """Slope and level of another line."""
        return _wording(trend).rival(trend, other)


def _wording(trend: Trend) -> Words:
    return BasisWords() if isinstance(trend.geometry, BasisCurve) else LineWords()


def period_text(trend: Trend, season: Season) -> str:
    """Period in the unit that people use for it.

    Parameters
    ----------
    trend : Trend
    season : Season

    Returns
    -------
    str
        As ``"1 year"`` or ``"12"``.
    """
    if trend.axis.kind != "datetime":
        return significant(season.period, 6)
    for name, seconds in CALENDAR.items():
        if abs(season.period / seconds - 1.0) < 1e-9:
            return f"1 {name}"
    unit = natural_unit(season.period)
    count = significant(season.period / unit.seconds, 5)
    return f"{count} {unit.name}{'' if count == '1' else 's'}"


def _season_lines(trend: Trend) -> Iterable[EstimateLine]:
    for index, season in enumerate(_curve(trend).design.seasons):
        name = period_text(trend, season)
        yield estimate_line(f"amplitude, season of {name}", trend.parameters[f"season_{index + 1}_amplitude"])
        peak = trend.parameters[f"season_{index + 1}_peak"]
        if trend.axis.kind != "datetime":
            yield estimate_line(f"peak, season of {name}", peak)
            continue
        unit = natural_unit(season.period / 2.0)
        line = estimate_line(
            f"peak, {unit.name}s after {moment_text(trend.origin)}", peak.scaled(1.0 / unit.seconds)
        )
        yield line


def _polynomial_text(trend: Trend, curve: BasisCurve, time_name: str) -> str:
    design, unit = curve.design, slope_unit(trend)
    constant = trend.parameters["level" if "level" in trend.parameters else "intercept"]
    if design.degree == 0:
        return rounded(constant.value, constant.stderr)
    if design.degree == 1:
        slope = trend.parameters["slope"].scaled(unit.seconds)
        change = _signed(slope.value, slope.stderr)
        start = rounded(constant.value, constant.stderr)
        if trend.axis.kind == "datetime":
            return f"{start} {change} · ({unit.name}s since {moment_text(trend.origin)})"
        return f"{start} {change} · {time_name}"
    # About the middle of the span, where powers are least entangled.
    powers = polynomial_powers(design.degree)
    scale = unit.seconds / design.frame.half
    coefficients = [
        float(np.sum(curve.theta[: design.degree + 1] * powers[:, k])) * scale**k
        for k in range(design.degree + 1)
    ]
    # The uncertainty of the value in the middle stands for all: each term counts as much at the ends.
    stderr = curve.bands(np.array([design.frame.middle]), 1.0)
    spread = float(stderr.confidence_high[0] - stderr.value[0])
    reach = design.frame.half / unit.seconds
    text = rounded(coefficients[0], spread)
    for k in range(1, design.degree + 1):
        power = "" if k == 1 else str(k).translate(_RAISED)
        text += f" {_signed(coefficients[k], spread / reach**k)} · x{power}"
    return text


def _where(trend: Trend, curve: BasisCurve, time_name: str) -> str:
    """Say what the powers of a polynomial are powers of."""
    if curve.design.degree < 2:
        return ""
    middle = trend.axis.from_internal(np.array([curve.design.frame.middle]))[0]
    if trend.axis.kind == "datetime":
        return f"; x = {slope_unit(trend).name}s since {moment_text(middle)}"
    return f"; x = {time_name} - {middle:.10g}"


def _signed(value: float, stderr: float | None) -> str:
    return f"{'-' if value < 0 else '+'} {rounded(abs(value), stderr)}"


def _curve(trend: Trend) -> BasisCurve:
    curve = trend.geometry
    if not isinstance(curve, BasisCurve):
        raise TypeError("only a trend of columns is put into words here")
    return curve
