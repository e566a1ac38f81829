"""What a picture of a trend shows, decided before any of it is drawn: colours, frame, points, time axis."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from matplotlib import dates
from matplotlib.colors import to_hex, to_rgb

from estimators.adapters.figure_curves import drawn_rows, fine_times
from estimators.arrays import BoolArray, FloatArray, IntArray, Reason
from estimators.time_axis import TimeAxis
from estimators.trends.presentation.units import moment_text

if TYPE_CHECKING:
    from estimators.trends.prediction import Prediction
    from estimators.trends.trend import Trend

# matplotlib's module of dates has no types.
mdates: Any = dates

# Outliers may enlarge the frame by this share of the trend's height on either side: it keeps 45 %.
ROOM_FOR_OUTLIERS = 0.6
ROOM_FOR_BANDS = 0.35

_CURVES = ("value", "confidence_low", "confidence_high", "prediction_low", "prediction_high")


@dataclass(frozen=True, slots=True)
class Palette:
    """Colours of a theme."""

    paper: str
    ink: str
    quiet: str
    grid: str
    inlier: str
    outlier: str
    band: str
    other: str


PALETTES: dict[str, Palette] = {
    "light": Palette("#ffffff", "#1b1f24", "#57606a", "#e6e9ed", "#0072b2", "#d55e00", "#56b4e9", "#007a5a"),
    "dark": Palette("#12161c", "#f0f3f6", "#9aa4b0", "#262d37", "#56b4e9", "#e69f00", "#56b4e9", "#2fc79b"),
}


def mixed(color: str, paper: str, strength: float) -> str:
    """Colour of so much strength over paper, without being transparent."""
    over, under = np.array(to_rgb(color)), np.array(to_rgb(paper))
    red, green, blue = (strength * over + (1.0 - strength) * under).tolist()
    return to_hex((red, green, blue))


class Paper(Protocol):
    """What headings and legends have to know of a picture."""

    @property
    def palette(self) -> Palette:
        """Colours of its theme."""

    @property
    def width_px(self) -> int:
        """Width in CSS pixels."""

    @property
    def small(self) -> bool:
        """Whether text and markers must be smaller."""


@dataclass(frozen=True, slots=True)
class Clock:
    """Internal time to what matplotlib draws: days for points in time, numbers otherwise.

    Attributes
    ----------
    axis : TimeAxis
    dates : bool
        Whether what is drawn are days, for a date axis.
    shift : float
        Added to internal times that are drawn as numbers.
    """

    axis: TimeAxis
    dates: bool
    shift: float

    @classmethod
    def of(cls, trend: Trend) -> Clock:
        """Choose the scale on which neighbouring times of this series can be told apart."""
        return cls.over(trend.axis, *trend.geometry.span)

    @classmethod
    def over(cls, axis: TimeAxis, first: float, last: float) -> Clock:
        """Choose the scale for internal times of this span."""
        if axis.kind == "datetime":
            # Days as floats resolve microseconds: shorter series are drawn in seconds since their origin.
            return cls(axis, last - first >= 1.0, 0.0)
        origin = float(axis.origin)
        return cls(axis, False, origin if abs(origin) < 1e6 * (last - first) else 0.0)

    def draw(self, internal: FloatArray) -> FloatArray:
        """Place internal times on matplotlib's axis."""
        if self.dates:
            return np.asarray(mdates.date2num(self.axis.origin) + internal / 86400.0, dtype=np.float64)
        return internal + self.shift

    @property
    def label(self) -> str | None:
        """Name of the axis where its numbers are not the caller's times."""
        if self.dates or (self.axis.kind == "number" and self.shift == float(self.axis.origin)):
            return None
        unit = "seconds since " if self.axis.kind == "datetime" else "since "
        return unit + moment_text(self.axis.origin)


@dataclass(frozen=True, slots=True)
class Sheet:
    """What is drawn and in which frame.

    Attributes
    ----------
    palette : Palette
    width_px, height_px : int
    clock : Clock
    x, y, certainty : ndarray of float64, shape (m,)
        Place of every row that can be drawn, and the probability of its label.
    inlier, outlier, unused : ndarray of bool, shape (m,)
        Exactly one of them holds; unused are rows of weight 0.
    curves : Prediction
        Trend and bands at internal times, ascending: the span of the data and whatever is predicted.
    cycle_px : float
        Width of a cycle of the shortest season; infinite where there is none.
    low, high : float
        Limits of the values.
    """

    palette: Palette
    width_px: int
    height_px: int
    clock: Clock
    x: FloatArray
    y: FloatArray
    certainty: FloatArray
    inlier: BoolArray
    outlier: BoolArray
    unused: BoolArray
    curves: Prediction
    cycle_px: float
    low: float
    high: float

    @classmethod
    def of(cls, trend: Trend, palette: Palette, width_px: int, height_px: int) -> Sheet:
        """Decide what a picture of this size shows."""
        internal = trend.axis.to_internal(trend.time)
        drawn = np.isfinite(internal) & np.isfinite(trend.values)
        codes = trend.points.reason_codes[drawn]
        inlier = trend.points.inlier[drawn]
        unused = ~inlier & ((codes == Reason.zero_weight) | (codes == Reason.earlier_regime))
        y = trend.values[drawn]
        probability = trend.points.probability[drawn]
        grid = fine_times(trend, width_px)
        clock = Clock.of(trend)
        # On internal times, since the caller's may be too large for floats to tell neighbours apart.
        curves = dataclasses.replace(trend, axis=TimeAxis("number", 0.0)).predict(grid)
        low, high = _frame(curves, y[inlier], y[~inlier])
        pixel = (high - low) / height_px
        rows = drawn_rows(grid, _in_pixels(curves, low, high, pixel), trend.geometry.span, width_px)
        season = min((season.period for season in trend.seasons), default=math.inf)
        return cls(
            palette=palette,
            width_px=width_px,
            height_px=height_px,
            clock=clock,
            x=clock.draw(internal[drawn]),
            y=y,
            certainty=np.nan_to_num(np.where(inlier, probability, 1.0 - probability), nan=1.0),
            inlier=inlier,
            outlier=~inlier & ~unused,
            unused=unused,
            curves=_at_rows(curves, rows),
            cycle_px=width_px * season / float(grid[-1] - grid[0]) if grid[-1] > grid[0] else math.inf,
            low=low,
            high=high,
        )

    @property
    def small(self) -> bool:
        """Whether text and markers must be smaller."""
        return self.width_px < 560 or self.height_px < 320


def _in_pixels(curves: Prediction, low: float, high: float, pixel: float) -> FloatArray:
    """Trend and bands in pixels, shape (5, k), cut off a frame's height beyond the frame."""
    values = np.vstack([getattr(curves, name) for name in _CURVES])
    reach = high - low
    return np.clip(values - low, -reach, 2.0 * reach) / pixel


def _at_rows(curves: Prediction, rows: IntArray) -> Prediction:
    picked = {name: getattr(curves, name)[rows] for name in ("time", *_CURVES)}
    return dataclasses.replace(curves, **picked)


def _frame(curves: Prediction, inliers: FloatArray, others: FloatArray) -> tuple[float, float]:
    """Limits of the values: all inliers and the trend; bands and outliers as far as they do not squash it."""
    core = np.concatenate([inliers, curves.value])
    low, high = float(core.min()), float(core.max())
    height = high - low
    if height <= 1e-9 * max(abs(low), abs(high)):
        height = max(abs(high), 1.0) * 0.1
        low, high = low - height / 2, high + height / 2
    bands = np.concatenate([curves.prediction_low, curves.prediction_high])
    wanted = np.concatenate([bands[np.isfinite(bands)], [low, high]])
    low_band = max(float(wanted.min()), low - ROOM_FOR_BANDS * height)
    high_band = min(float(wanted.max()), high + ROOM_FOR_BANDS * height)
    everything = np.concatenate([others, [low_band, high_band]])
    low = min(low_band, max(float(everything.min()), low - ROOM_FOR_OUTLIERS * height))
    high = max(high_band, min(float(everything.max()), high + ROOM_FOR_OUTLIERS * height))
    margin = 0.04 * max(high - low, height)
    return low - margin, high + margin
