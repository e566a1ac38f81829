"""Time to threshold: when a trend reaches a value, how sure that is, and how likely by a horizon.

The interval holds the times at which the confidence band of the trend first touches the value and at which
the whole band is beyond it (of a line Fieller's; :mod:`estimators.trends.questions.passage`). It may reach
back to the end of the data ("may be there already") and have no end ("may never get there").
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from scipy.special import ndtr, stdtr

from estimators.arrays import LARGEST_TIME, LARGEST_VALUE, InputError
from estimators.inference.intervals import student_quantile
from estimators.time_axis import TimeAxis
from estimators.trends.curve import Curve
from estimators.trends.questions.passage import first_passage, last_passage

if TYPE_CHECKING:
    from estimators.trends.trend import Trend

Status = Literal["crosses", "never", "already", "uncertain"]
Direction = Literal["up", "down"]
MOST_VALUES = 100
"""Values that can be asked for together with a fit."""

_EARLIEST, _LATEST = np.datetime64("1678-01-01", "ns"), np.datetime64("2261-12-31T23:59:59", "ns")
_LONGEST = 9.2e9
"""Seconds that 64 bits of nanoseconds hold."""


@dataclass(frozen=True, slots=True)
class Crossing:
    """When a trend reaches a value, seen from the last time of the data.

    Attributes
    ----------
    value : float
        To be reached.
    direction : {"up", "down"}
        Whether beyond it is above or below.
    status : {"crosses", "never", "already", "uncertain"}
        ``crosses`` and ``never``: with confidence, later or not at all. ``already``: at the last time the
        trend is beyond, with confidence. ``uncertain``: the data do not tell these apart. Without an
        uncertainty the trend alone decides.
    time : float or numpy.datetime64 or None
        When the fitted trend gets there, in the caller's form; in the past where it is there already. None
        if it does not, or not before times end (the year 2261, or 1e30).
    low, high : float or numpy.datetime64 or None
        Confidence limits from the last time on. ``low`` equal to the last time: it may be there already.
        ``high`` None: it may never get there. Both None: it does not, or is there.
    level : float
        Confidence level of the status and of the interval.
    horizon : float or numpy.datetime64 or None
    probability : float or None
        That the trend is beyond the value at the horizon.
    reading_probability : float or None
        That a new inlier of mean weight is, if it is read at the horizon.
    """

    value: float
    direction: Direction
    status: Status
    time: float | np.datetime64 | None
    low: float | np.datetime64 | None
    high: float | np.datetime64 | None
    level: float
    horizon: float | np.datetime64 | None = None
    probability: float | None = None
    reading_probability: float | None = None


def time_to(
    trend: Trend, value: float, horizon: Any, direction: Direction | None, level: float | None
) -> Crossing:
    """Answer :meth:`estimators.Trend.time_to`."""
    value = check_value("value", value)
    wanted = trend.uncertainty.level if level is None else level
    if isinstance(wanted, bool) or not isinstance(wanted, Real) or not 0 < wanted < 1:
        raise InputError("level", "must be a number between 0 and 1, both excluded")
    if direction not in ("up", "down", None):
        raise InputError("direction", "must be 'up', 'down' or None")
    asked, at = (None, None) if horizon is None else _read_horizon(trend, horizon)
    curve, start, dof = trend.geometry, trend.geometry.span[1], trend.uncertainty.dof
    limit = _last_internal(trend.axis)
    sign = {"up": 1.0, "down": -1.0}[direction] if direction else _direction(trend, value, limit)
    now = sign * (float(curve.value(np.array([start]))[0]) - value)
    time = first_passage(curve, value, 0.0, sign, start, limit)
    low = high = None
    status: Status = "already" if now >= 0.0 else "crosses" if time is not None else "never"
    if dof is not None:
        quantile = student_quantile(float(wanted), dof)
        low = first_passage(curve, value, quantile, sign, start, limit)
        high = first_passage(curve, value, -quantile, sign, start, limit)
        if high == start:
            status, low, high = "already", None, None
        elif low is None:
            status = "never"
        elif now >= 0.0 or high is None:
            status = "uncertain"
    if now >= 0.0:
        time = last_passage(curve, value, sign)
    chances = (None, None) if at is None else _chances(curve, at, value, sign, dof)
    return Crossing(
        value=value,
        direction="up" if sign > 0 else "down",
        status=status,
        time=_moment(trend.axis, time),
        low=_moment(trend.axis, low),
        high=_moment(trend.axis, high),
        level=float(wanted),
        horizon=asked,
        probability=chances[0],
        reading_probability=chances[1],
    )


def check_values(values: Any) -> tuple[float, ...]:
    """Values to reach: one or several.

    Raises
    ------
    InputError
        If there are too many or one is no finite number.
    """
    listed = [values] if isinstance(values, Real) else list(np.atleast_1d(np.asarray(values, dtype=object)))
    if len(listed) > MOST_VALUES:
        raise InputError("reach", f"at most {MOST_VALUES} values can be asked for at a time")
    return tuple(check_value("reach", value) for value in listed)


def check_value(field: str, value: Any) -> float:
    """Value to reach: a finite number, not beyond what values may be.

    Raises
    ------
    InputError
    """
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        raise InputError(field, "must be a number")
    if not abs(float(value)) <= LARGEST_VALUE:
        raise InputError(field, f"must be finite and lie within ±{LARGEST_VALUE:g}")
    return float(value)


def _read_horizon(trend: Trend, horizon: Any) -> tuple[float | np.datetime64, float]:
    try:
        column, internal = trend.axis.read(horizon)
    except InputError as error:
        raise InputError("horizon", error.message) from error
    if internal.size != 1 or not math.isfinite(internal[0]):
        raise InputError("horizon", "must be one time, of the same kind as the series")
    if internal[0] < trend.geometry.span[1]:
        raise InputError("horizon", "must not lie before the last time of the data")
    moment = column[0]
    return (moment if isinstance(moment, np.datetime64) else float(moment)), float(internal[0])


def _direction(trend: Trend, value: float, limit: float) -> float:
    """Way in which the value is passed: the way to it, unless the trend has surely come from there."""
    curve = trend.geometry
    first, last = curve.span
    at_first, at_last = curve.value(np.array([first, last])).tolist()
    change = math.copysign(1.0, at_last - at_first)
    if value == at_last:
        return change
    towards = math.copysign(1.0, value - at_last)
    if first_passage(curve, value, 0.0, towards, last, limit) is not None or at_last == at_first:
        return towards
    p_value = trend.p_value
    return change if p_value is None or p_value < 1.0 - trend.uncertainty.level else towards


def _last_internal(axis: TimeAxis) -> float:
    """Last time that the caller's form can say."""
    if isinstance(axis.origin, np.datetime64):
        return min(float(axis.to_internal(np.array([_LATEST]))[0]), _LONGEST)
    return LARGEST_TIME - float(axis.origin)


def _moment(axis: TimeAxis, internal: float | None) -> float | np.datetime64 | None:
    """Time in the caller's form; None where it cannot say it."""
    if internal is None or not abs(internal) <= 2.0 * LARGEST_TIME:
        return None
    if isinstance(axis.origin, np.datetime64):
        earliest = max(float(axis.to_internal(np.array([_EARLIEST]))[0]), -_LONGEST)
        if not earliest <= internal <= _last_internal(axis):
            return None
        moment: np.datetime64 = axis.from_internal(np.array([internal]))[0]
        return moment
    moment_number = float(axis.from_internal(np.array([internal]))[0])
    return moment_number if abs(moment_number) <= LARGEST_TIME else None


def _chances(
    curve: Curve, at: float, value: float, sign: float, dof: float | None
) -> tuple[float | None, float | None]:
    """Probabilities that the trend, and a new reading, are beyond the value."""
    if dof is None:
        return None, None
    ahead = sign * (float(curve.value(np.array([at]))[0]) - value)
    shares = []
    for band in ("confidence", "prediction"):
        away = math.copysign(_standard_errors(curve, at, value, band), ahead)
        shares.append(float(ndtr(away) if math.isinf(dof) else stdtr(dof, away)))
    return shares[0], shares[1]


def _standard_errors(curve: Curve, at: float, value: float, band: str) -> float:
    """How many standard errors the edge of a band needs to reach a value."""
    where = np.array([at])
    trend = float(curve.value(where)[0])
    side = "high" if value > trend else "low"

    def short(quantile: float) -> float:
        with np.errstate(over="ignore", invalid="ignore"):
            edge = float(getattr(curve.bands(where, quantile), f"{band}_{side}")[0])
        return abs(value - trend) - abs(edge - trend)

    if value == trend:
        return 0.0
    one = abs(value - trend) - short(1.0)
    if not one > 0.0:
        return math.inf
    likely = abs(value - trend) / one
    # Exact where bands are linear in the quantile, as those of a line are.
    if abs(short(likely)) <= 1e-9 * abs(value - trend):
        return likely
    highest = 2.0
    while short(highest) > 0.0:
        highest *= 2.0
        if highest > 1e6:
            return math.inf
    # Imported here: few need it, and it takes a tenth of the start of a program.
    from scipy.optimize import brentq  # noqa: PLC0415

    return float(brentq(short, 0.0, highest))
