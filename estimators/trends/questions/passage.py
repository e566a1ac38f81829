"""When a curve, or the edge of its band, first gets to a value: in closed form for a line, else by search.

The times at which a line with uncertain level and slope may be at a value solve a quadratic equation
(Fieller 1954, "Some problems in interval estimation"): an interval, a ray, everything, or nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from estimators.arrays import FloatArray
from estimators.trends.curve import Curve, LineGeometry

_FARTHEST_SPANS = 1000.0
"""A curve that is no line is followed for so many spans of its data."""

_FINE, _COARSE = 4096, 2048
"""Times looked at in the first two spans, where a season may turn, and beyond them."""


def first_passage(
    curve: Curve, value: float, quantile: float, direction: float, start: float, limit: float
) -> float | None:
    """First time from ``start`` at which the edge of the confidence band is at or beyond a value.

    Parameters
    ----------
    curve : Curve
    value : float
    quantile : float
        Standard errors from the trend to the edge in the direction of the passage; 0 is the trend itself,
        negative the edge that lags behind.
    direction : {1.0, -1.0}
        Whether beyond is above or below.
    start, limit : float
        Times, since ``axis.origin``, between which to look.

    Returns
    -------
    float or None
        None if the edge does not get there.
    """

    def ahead(at: FloatArray) -> FloatArray:
        return direction * (_edge(curve, at, direction * quantile) - value)

    if float(ahead(np.array([start]))[0]) >= 0.0:
        return start
    if isinstance(curve, LineGeometry):
        found = _on_a_line(curve, value, quantile, direction, start)
    else:
        span = curve.span[1] - curve.span[0]
        found = _on_a_grid(ahead, start, span, min(limit, start + _FARTHEST_SPANS * span))
    return found if found is not None and found <= limit else None


def last_passage(curve: Curve, value: float, direction: float) -> float | None:
    """Last time up to the end of the data at which a curve that is beyond a value got there.

    For a line this may lie before the data; other curves are not followed back beyond them.
    """
    first, last = curve.span
    if isinstance(curve, LineGeometry):
        return None if curve.slope == 0.0 else curve.center + (value - curve.level) / curve.slope

    def ahead_at(ago: FloatArray) -> FloatArray:
        return -direction * (curve.value(last - ago) - value)

    ago = _on_a_grid(ahead_at, 0.0, 0.5 * (last - first), last - first)
    return None if ago is None else last - ago


def _edge(curve: Curve, at: FloatArray, quantile: float) -> FloatArray:
    """Trend plus so many standard errors, with a sign."""
    if quantile == 0.0:
        return curve.value(at)
    bands = curve.bands(at, abs(quantile))
    return bands.confidence_high if quantile > 0.0 else bands.confidence_low


def _on_a_line(
    line: LineGeometry, value: float, quantile: float, direction: float, start: float
) -> float | None:
    """Solve b u - d + q sqrt(l^2 + k^2 u^2) = 0 for u after the start, where the left side is negative.

    u is the time since the center. Squared, it is (b^2 - q^2 k^2) u^2 - 2 b d u + d^2 - q^2 l^2 = 0; of the
    roots those are meant at which b u - d has the sign of -q.
    """
    # In units of the span and of the largest of the values squares neither overflow nor underflow.
    time = line.span[1] - line.span[0]
    size = max(abs(value - line.level), abs(line.slope) * time, line.level_stderr, line.slope_stderr * time)
    if not (math.isfinite(size) or quantile == 0.0):
        return None
    if quantile == 0.0:
        size = max(abs(value - line.level), abs(line.slope) * time)
    b, d = direction * line.slope * time / size, direction * (value - line.level) / size
    if quantile == 0.0:
        return line.center + time * d / b if b > 0.0 else None
    level, slope = quantile * line.level_stderr / size, quantile * line.slope_stderr * time / size
    square = (b - slope) * (b + slope)
    discriminant = (b * level) ** 2 + (slope * d) ** 2 - (slope * level) ** 2
    if discriminant < 0.0:
        return None
    sum_part = b * d + math.copysign(math.sqrt(discriminant), b * d)
    roots = []
    if square != 0.0:
        roots.append(sum_part / square)
    if sum_part != 0.0:
        roots.append((d - level) * (d + level) / sum_part)
    from_start = (start - line.center) / time
    ahead = [root for root in roots if root > from_start and (b * root - d) * quantile <= 0.0]
    return line.center + time * min(ahead) if ahead else None


def _on_a_grid(
    ahead: Callable[[FloatArray], FloatArray], start: float, span: float, limit: float
) -> float | None:
    """First change of sign after the start, refined; passages shorter than the grid are overlooked."""
    # Imported here: few need it, and it takes a tenth of the start of a program.
    from scipy.optimize import brentq  # noqa: PLC0415

    near = np.linspace(0.0, 2.0, _FINE)
    far = np.geomspace(2.0, _FARTHEST_SPANS, _COARSE)[1:]
    at = start + span * np.concatenate((near, far))
    at = np.append(at[at < limit], limit)
    with np.errstate(over="ignore", invalid="ignore"):
        beyond = np.flatnonzero(ahead(at) >= 0.0)
        if not beyond.size:
            return None
        first = int(beyond[0])
        if first == 0:
            return float(at[0])

        def bounded(moment: float) -> float:
            return float(np.clip(ahead(np.array([moment])), -1e300, 1e300)[0])

        return float(brentq(bounded, at[first - 1], at[first], xtol=1e-12 * span, rtol=1e-14))
