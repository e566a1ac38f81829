"""What a picture of a track shows, decided before any of it is drawn: a plane, an order, what is good.

Everything is in metres about the middle of the track, on a plane that knows neither poles nor the
antimeridian; of very many fixes or vertices only those are taken that can be told apart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from estimators.adapters.figure_sheet import Clock, Palette
from estimators.arrays import BoolArray, CodeArray, FloatArray, IntArray
from estimators.geodesy.ellipsoid import SEMI_MAJOR_M, to_cartesian, to_geodetic
from estimators.geodesy.plane import Plane
from estimators.time_axis import TimeAxis, as_times

if TYPE_CHECKING:
    from estimators.trajectories.track import Track

# Steps this many times as long as the usual one are not walked in a straight line.
_GAP_STEPS = 10.0
# Times this many times as large as their span, as seconds since 1970 are, make ticks that cannot be read.
_LONG_NUMBERS = 1_000.0


@dataclass(frozen=True, slots=True)
class TrackSheet:
    """What is drawn of a track: a row per input row that has a time and so a place, in order of time.

    Attributes
    ----------
    palette : Palette
    width_px, height_px : int
    clock : Clock
    t : ndarray of float64, shape (m,)
        Seconds or units since the first time, ascending.
    track_m, fix_m : ndarray of float64, shape (m, 2)
        East and north of the smoothed places and of the fixes; NaN where there is no fix.
    covariance_m2 : ndarray of float64, shape (m, 2, 2)
        Of the smoothed places.
    residual_m, probability, speed_mps, speed_sigma_mps : ndarray of float64, shape (m,)
    codes : ndarray of uint8, shape (m,)
        Reasons.
    after_gap : ndarray of bool, shape (m,)
        Whether the step that leads to the row is far longer than usual.
    level : float
    middle_deg : tuple of float
        Latitude and longitude of the origin of the plane.
    """

    palette: Palette
    width_px: int
    height_px: int
    clock: Clock
    t: FloatArray
    track_m: FloatArray
    fix_m: FloatArray
    covariance_m2: FloatArray
    residual_m: FloatArray
    probability: FloatArray
    speed_mps: FloatArray
    speed_sigma_mps: FloatArray
    codes: CodeArray
    after_gap: BoolArray
    level: float
    middle_deg: tuple[float, float]

    @classmethod
    def of(cls, track: Track, palette: Palette, width_px: int, height_px: int) -> TrackSheet:
        """Decide what a picture of this size shows."""
        internal, axis, _ = as_times(track.time)
        rows = np.flatnonzero(np.isfinite(internal) & np.isfinite(track.lat_deg))
        rows = rows[np.argsort(internal[rows], kind="stable")]
        t = internal[rows]
        middle = _middle(track.lat_deg[rows], track.lon_deg[rows])
        plane = Plane(*middle)
        fixes = np.full((rows.size, 2), np.nan)
        placed = np.isfinite(track.input_lat_deg[rows])
        there = rows[placed]
        fixes[placed] = plane.project(track.input_lat_deg[there], track.input_lon_deg[there])
        return cls(
            palette=palette,
            width_px=width_px,
            height_px=height_px,
            clock=_clock(axis, float(t[0]), float(t[-1])),
            t=t,
            track_m=plane.project(track.lat_deg[rows], track.lon_deg[rows]),
            fix_m=fixes,
            covariance_m2=track.covariance_enu_m2[rows, :2, :2],
            residual_m=track.points.residual_m[rows],
            probability=track.points.probability[rows],
            speed_mps=track.speed_mps[rows],
            speed_sigma_mps=track.speed_sigma_mps[rows],
            codes=track.points.reason_codes[rows],
            after_gap=_after_gap(t),
            level=track.level,
            middle_deg=middle,
        )

    @property
    def small(self) -> bool:
        """Whether text and markers must be smaller."""
        return self.width_px < 560 or self.height_px < 320

    @property
    def placed(self) -> BoolArray:
        """Whether the row has a fix that can be drawn."""
        return np.isfinite(self.fix_m[:, 0])

    @property
    def reach(self) -> float:
        """Half axis, in standard deviations, of the ellipse that holds the place at the level."""
        return math.sqrt(-2.0 * math.log1p(-self.level))

    @property
    def radius_m(self) -> FloatArray:
        """Radius of the region of each smoothed place, of the same area as its ellipse, shape (m,)."""
        return np.asarray(self.reach * np.maximum(np.linalg.det(self.covariance_m2), 0.0) ** 0.25)


def _clock(axis: TimeAxis, first: float, last: float) -> Clock:
    """Scale of the times; numbers that are nearly the same are counted from the first one."""
    clock = Clock.over(axis, first, last)
    if abs(clock.shift) > _LONG_NUMBERS * (last - first):
        return Clock(axis, False, 0.0)
    return clock


def _middle(lat_deg: FloatArray, lon_deg: FloatArray) -> tuple[float, float]:
    """Latitude and longitude of the mean of places, whatever pole or meridian lies among them."""
    places = to_cartesian(np.column_stack([lat_deg, lon_deg, np.zeros(lat_deg.size)]))
    mean = places.mean(axis=0)
    length = float(np.linalg.norm(mean))
    # Places all about the Earth have no middle.
    if length < 1e-3 * SEMI_MAJOR_M:
        return float(lat_deg[0]), float(lon_deg[0])
    middle = to_geodetic(mean * (SEMI_MAJOR_M / length))
    return float(middle[0]), float(middle[1])


def _after_gap(t: FloatArray) -> BoolArray:
    steps = np.diff(t, prepend=t[0])
    walked = steps[steps > 0.0]
    usual = float(np.median(walked)) if walked.size else 0.0
    return steps > _GAP_STEPS * usual


def vertices(x_px: FloatArray, y_px: FloatArray, cell_px: float, most: int) -> IntArray:
    """Choose the rows of a long line at which it enters another cell of a grid.

    Parameters
    ----------
    x_px, y_px : ndarray of float64, shape (m,)
        The line, in pixels.
    cell_px : float
        Size of the cells; it is doubled until few enough rows are left.
    most : int
        Rows to be left at most.

    Returns
    -------
    ndarray of int64
        Ascending; the first and the last row are among them.

    Examples
    --------
    >>> vertices(np.array([0.0, 0.1, 0.2, 1.2, 1.3]), np.zeros(5), 1.0, 100)
    array([0, 3, 4])
    """
    last = x_px.size - 1
    while True:
        column, row = np.floor(x_px / cell_px), np.floor(y_px / cell_px)
        enters = (np.diff(column) != 0.0) | (np.diff(row) != 0.0)
        kept = np.unique(np.concatenate([[0], np.flatnonzero(enters) + 1, [last]]))
        if kept.size <= max(most, 2):
            return kept
        cell_px *= 2.0


def broken_before(after_gap: BoolArray, rows: IntArray) -> BoolArray:
    """Whether a gap lies between each of some rows and the one chosen before it; False for the first.

    Parameters
    ----------
    after_gap : ndarray of bool, shape (m,)
    rows : ndarray of int64, shape (k,)
        Ascending.

    Examples
    --------
    >>> broken_before(np.array([False, False, True, False]), np.array([0, 1, 3]))
    array([False, False,  True])
    """
    gaps = np.cumsum(after_gap)[rows]
    return np.diff(gaps, prepend=gaps[:1]) > 0
