"""The parts of the error plot of a track: how far fixes are off, how sure the track is, and its speed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator
from scipy.special import ndtri

from estimators.adapters.figure_curves import CROWDED, lowest_and_highest
from estimators.adapters.figure_strokes import dress_clock, entry, text_size
from estimators.adapters.track_marks import draw_fixes
from estimators.adapters.track_sheet import TrackSheet, broken_before
from estimators.adapters.track_view import metres_text, round_length
from estimators.arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

# The scale is linear as far as most good fixes and the region reach, and logarithmic from there on.
_LINEAR_QUANTILE = 0.95
_LINEAR_DECADES = 1.2
_LEAST_M = 0.01
_ROOM = 1.6


def draw_errors(axes: Axes, sheet: TrackSheet, cells: tuple[int, int]) -> list[Artist]:
    """Distance of every fix from the smoothed track over the radius of its region."""
    x, radius = sheet.clock.draw(sheet.t), sheet.radius_m
    _scale(axes, sheet)
    at, high = _broken(sheet, _rows(sheet, radius, cells[0]), x, radius)
    band = axes.fill_between(
        at, 0.0, high, color=sheet.palette.band, alpha=0.45, linewidth=0, zorder=1,
        label=f"{100 * sheet.level:g} % radius of the track",
    )  # fmt: skip
    known = np.isfinite(sheet.residual_m)
    # What has no place is marked at the foot.
    y = np.where(known, sheet.residual_m, 0.0)
    draw_fixes(axes, sheet, x, y, np.ones(x.size, dtype=np.bool_), cells)
    return [band]


def draw_speed(axes: Axes, sheet: TrackSheet, columns: int) -> list[Artist]:
    """Speed of the smoothed track with its interval; broken at gaps."""
    x = sheet.clock.draw(sheet.t)
    rows = _rows(sheet, sheet.speed_mps, columns)
    reach = float(ndtri(0.5 * (1.0 + sheet.level)))
    at, speed, sigma = _broken(sheet, rows, x, sheet.speed_mps, sheet.speed_sigma_mps)
    axes.fill_between(
        at, np.maximum(speed - reach * sigma, 0.0), speed + reach * sigma,
        color=sheet.palette.band, alpha=0.45, linewidth=0, zorder=1,
    )  # fmt: skip
    axes.plot(at, speed, color=sheet.palette.ink, linewidth=1.2, zorder=3)
    # The interval may be far wider than the speeds; these are what is to be seen.
    top = float(np.nanmax(np.append(sheet.speed_mps, 1.0)))
    axes.set_ylim(0.0, 1.25 * top)
    return [entry("speed", linestyle="-", color=sheet.palette.ink, linewidth=1.2)]


def dress(axes: Axes, sheet: TrackSheet, name: str) -> None:
    """Grid, ticks and the name of the values."""
    palette, size = sheet.palette, text_size(sheet)
    axes.set_facecolor(palette.paper)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
    axes.spines["bottom"].set_color(palette.quiet)
    axes.grid(axis="y", color=palette.grid, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(axis="both", which="both", colors=palette.quiet, labelsize=size, length=0)
    axes.set_ylabel(name, color=palette.quiet, fontsize=size, loc="top")


def dress_time(axes: Axes, sheet: TrackSheet) -> None:
    """Ticks of time, and what they count where they are no dates."""
    x = sheet.clock.draw(sheet.t[[0, -1]])
    margin = 0.02 * float(x[1] - x[0]) or 1.0
    axes.set_xlim(float(x[0]) - margin, float(x[1]) + margin)
    axes.tick_params(axis="x", length=3)
    dress_clock(axes, sheet.clock, sheet)
    name = sheet.clock.label or ("UTC" if sheet.clock.dates else "time")
    axes.set_xlabel(name, color=sheet.palette.quiet, fontsize=text_size(sheet), loc="right")


def _scale(axes: Axes, sheet: TrackSheet) -> None:
    """Metres from 0 on; logarithmic beyond the good fixes where others are farther off than these."""
    residual = sheet.residual_m[np.isfinite(sheet.residual_m)]
    usual = np.concatenate([residual[residual <= np.median(residual)] * 2.0 if residual.size else residual,
                            sheet.radius_m])  # fmt: skip
    linear = 2.0 * round_length(max(float(np.quantile(usual, _LINEAR_QUANTILE)), _LEAST_M))
    top = max(float(residual.max(initial=0.0)), float(sheet.radius_m.max()), 0.5 * linear)
    ticks = [0.0, 0.5 * linear, linear]
    if top > 2.0 * linear:
        axes.set_yscale("symlog", linthresh=linear, linscale=_LINEAR_DECADES)
        first, last = math.floor(math.log10(linear)) + 1, math.ceil(math.log10(top))
        ticks += [10.0**power for power in range(first, last + 1) if 10.0**power >= 2.5 * linear]
    elif top > 1.3 * linear:
        ticks += [1.5 * linear, 2.0 * linear]
    high = _ROOM * top if top > 2.0 * linear else 1.15 * top
    axes.set_ylim(0.0, high)
    axes.yaxis.set_major_locator(FixedLocator([tick for tick in ticks if tick <= high]))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _place: metres_text(value)))


def _rows(sheet: TrackSheet, values: FloatArray, columns: int) -> IntArray:
    """Rows of a curve that a picture needs: of very many, the extremes of every column of pixels."""
    if sheet.t.size <= CROWDED * columns:
        return np.arange(sheet.t.size)
    ends: Any = [0, sheet.t.size - 1]
    return np.union1d(ends, lowest_and_highest(sheet.t, values, columns))


def _broken(sheet: TrackSheet, rows: IntArray, *columns: FloatArray) -> list[FloatArray]:
    """Columns at rows, with NaN between the two sides of a gap."""
    breaks = np.flatnonzero(broken_before(sheet.after_gap, rows))
    return [np.insert(column[rows], breaks, np.nan) for column in columns]
