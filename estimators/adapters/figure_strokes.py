"""How the parts of a trend's picture are drawn on matplotlib axes; each part returns its legend entries."""

from __future__ import annotations

import math
import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from estimators.adapters.figure_sheet import Clock, Paper, Sheet, mdates, mixed
from estimators.adapters.thinning import one_per_cell
from estimators.arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.legend import Legend

    from estimators.trends.trend import RunnerUp, Trend

# More markers than this are thinned, and are an image inside an SVG.
MAX_MARKERS = 3_000
# Labels at least this certain are drawn with so much of their colour, the rest being paper.
CERTAINTIES = ((0.9, 1.0), (0.6, 0.55), (0.0, 0.25))
# A cross is all outline: paler than this, it is no longer seen.
_PALEST_CROSS = 0.45
# Cycles narrower than this many pixels are drawn with a finer line; those that are hardly told apart, pale.
_NARROW_CYCLE_PX, _MERGED_CYCLE_PX = 24.0, 4.0
_PX_TO_PT = 0.75
# Mean width of a bold letter, over its height, with room for the numbers left of the axis.
_LETTER_EM = 0.72
_DASHES = (0, (4, 2.5))
_DOTS = (0, (1, 1.8))


def draw_points(axes: Axes, sheet: Sheet) -> list[Artist]:
    """Inliers as discs, outliers as crosses, the rest as grey dots; paler where the label is less sure."""
    palette = sheet.palette
    visible = (sheet.y >= sheet.low) & (sheet.y <= sheet.high)
    kinds = (
        (sheet.unused, ".", palette.quiet, "not in the fit", 1.8),
        (sheet.inlier, "o", palette.inlier, "inliers", 2.0),
        (sheet.outlier, "x", palette.outlier, "outliers", 3.2),
    )
    entries: list[Artist] = []
    for chosen, marker, color, name, layer in kinds:
        total = int(np.count_nonzero(chosen))
        if total:
            size = _draw_markers(axes, sheet, np.flatnonzero(chosen & visible), marker, color, layer)
            look = {"marker": marker, "color": color, "markersize": max(size + 1, 4.0)}
            entries.append(entry(f"{name} ({total:,})", **look))
    least_of_all = CERTAINTIES[0][0]
    if bool(np.any(sheet.certainty[visible & ~sheet.unused] < least_of_all)):
        pale = {
            "markerfacecolor": mixed(palette.inlier, palette.paper, 0.25),
            "markeredgecolor": palette.inlier,
        }
        entries.append(entry("paler: less sure", marker="o", markersize=5, **pale))
    return entries


def _draw_markers(axes: Axes, sheet: Sheet, rows: IntArray, marker: str, color: str, layer: float) -> float:
    """Draw one kind of point in up to three shades and return the size of its markers."""
    dense = rows.size > MAX_MARKERS
    if dense:
        # Very many crosses are a loose texture behind the trend, which they would hide one per pixel.
        cell_px = 5 if marker == "x" else 1
        layer = 1.9 if marker == "x" else layer
        columns, rows_up = sheet.width_px // cell_px, sheet.height_px // cell_px
        rows = rows[one_per_cell(sheet.x[rows], sheet.y[rows], columns, rows_up)]
    look: dict[str, Any] = _marker(marker, rows.size, sheet.small)
    upper = np.inf
    for least, strength in CERTAINTIES:
        here = rows[(sheet.certainty[rows] >= least) & (sheet.certainty[rows] < upper)]
        upper = least
        if not here.size:
            continue
        seen = max(strength, _PALEST_CROSS) if marker == "x" else strength
        face = mixed(color, sheet.palette.paper, seen)
        outline = face if marker == "x" or dense else color
        axes.plot(
            sheet.x[here],
            sheet.y[here],
            linestyle="none",
            rasterized=dense,
            zorder=layer,
            markerfacecolor=face,
            markeredgecolor=outline,
            **look,
        )
    return float(look["markersize"])


def _marker(marker: str, count: int, small: bool) -> dict[str, Any]:
    """Size that leaves single points apart: larger for few, a dot for very many."""
    size = 5.0 if count <= 80 else 3.6 if count <= 500 else 2.6 if count <= MAX_MARKERS else 1.6
    size *= 0.8 if small else 1.0
    if marker == "x":
        return {"marker": marker, "markersize": size + 0.6, "markeredgewidth": 1.3 if count <= 500 else 0.8}
    return {"marker": marker, "markersize": size, "markeredgewidth": 0.6 if count <= MAX_MARKERS else 0.0}


def draw_beyond(axes: Axes, sheet: Sheet) -> list[Artist]:
    """Triangles at the edge where points lie beyond it, and how many there are."""
    color = sheet.palette.outlier
    total = 0
    for beyond, marker, height in ((sheet.y > sheet.high, "^", 0.985), (sheet.y < sheet.low, "v", 0.015)):
        x = sheet.x[beyond]
        total += x.size
        x = x[one_per_cell(x, np.zeros_like(x), max(sheet.width_px // 8, 1), 1)]
        axes.plot(
            x,
            np.full(x.size, height),
            transform=axes.get_xaxis_transform(),
            linestyle="none",
            marker=marker,
            markersize=4.0,
            markeredgewidth=0,
            color=color,
            zorder=4,
        )
    if not total:
        return []
    return [entry(f"beyond the frame ({total:,})", marker="^", markersize=5, markeredgewidth=0, color=color)]


def draw_lines(axes: Axes, trend: Trend, sheet: Sheet) -> list[Artist]:
    """Trend over the data, dashed beyond them; what was predicted; the runner-up if it is nearly as good."""
    ink, first, last = sheet.palette.ink, *trend.geometry.span
    grid, value = sheet.curves.time, sheet.curves.value
    x = sheet.clock.draw(grid)
    inside = (grid >= first) & (grid <= last)
    width = 1.8 if sheet.cycle_px >= _NARROW_CYCLE_PX else 1.2
    # Strokes side by side are an area, under which the points are still to be seen.
    alpha = 1.0 if sheet.cycle_px >= _MERGED_CYCLE_PX else 0.4
    axes.plot(x[inside], value[inside], color=ink, linewidth=width, alpha=alpha, zorder=3)
    entries: list[Artist] = [entry("trend", linestyle="-", color=ink, linewidth=width)]
    outside = [part for part in (grid <= first, grid >= last) if np.count_nonzero(part) > 1]
    for part in outside:
        look: dict[str, Any] = {"color": ink, "linewidth": min(1.5, width), "linestyle": _DASHES}
        axes.plot(x[part], value[part], alpha=alpha, zorder=3, **look)
    if outside:
        entries.append(entry("extrapolated", linestyle=_DASHES, color=ink, linewidth=min(1.5, width)))
    entries += _draw_predicted(axes, trend, sheet)
    entries += _draw_runner_up(axes, trend, sheet)
    return entries


def _draw_predicted(axes: Axes, trend: Trend, sheet: Sheet) -> list[Artist]:
    if trend.prediction is None:
        return []
    internal = trend.axis.to_internal(trend.prediction.time)
    known = np.isfinite(internal)
    look: dict[str, Any] = {
        "linestyle": "none",
        "marker": "D",
        "markersize": 4.5,
        "markerfacecolor": sheet.palette.paper,
        "markeredgecolor": sheet.palette.ink,
    }
    axes.plot(sheet.clock.draw(internal[known]), trend.prediction.value[known], zorder=3.5, **look)
    return [entry(f"predicted ({np.count_nonzero(known):,})", **look)]


def _draw_runner_up(axes: Axes, trend: Trend, sheet: Sheet) -> list[Artist]:
    other = trend.runner_up
    if other is None or not other.equally_good:
        return []
    value = _other_curve(trend, other, sheet.curves.time)
    if value is None:
        return []
    look: dict[str, Any] = {"color": sheet.palette.other, "linewidth": 1.4, "linestyle": _DOTS}
    axes.plot(sheet.clock.draw(sheet.curves.time), value, zorder=2.8, **look)
    return [entry(f"runner-up ({other.inliers:,})", **look)]


def _other_curve(trend: Trend, other: RunnerUp, internal: FloatArray) -> FloatArray | None:
    """Runner-up at internal times; None for shapes whose parameters do not say it all."""
    # The level holds at the answer's origin: the first time, or 0 for the line of plain numbers.
    origin = (
        0.0 if isinstance(trend.origin, np.datetime64) else float(trend.origin) - float(trend.axis.origin)
    )
    if trend.model == "line":
        return other.parameters["intercept"] + other.parameters["slope"] * (internal - origin)
    if trend.model == "exponential":
        exponent = np.clip(other.parameters["rate"] * (internal - origin), -700.0, 700.0)
        return np.asarray(other.parameters["level"] * np.exp(exponent))
    return None


def draw_bands(axes: Axes, sheet: Sheet) -> list[Artist]:
    """Confidence band of the trend inside the prediction band of new readings, where there are any."""
    curves = sheet.curves
    if not np.isfinite(curves.confidence_low).any():
        return []
    x = sheet.clock.draw(sheet.curves.time)
    level = f"{100 * curves.level:g} %"
    bands = (
        (curves.confidence_low, curves.confidence_high, 0.55, 1.5, f"confidence band, {level}"),
        (curves.prediction_low, curves.prediction_high, 0.16, 1.0, f"prediction band, {level}"),
    )
    color = sheet.palette.band
    return [
        axes.fill_between(x, low, high, color=color, alpha=alpha, linewidth=0, zorder=layer, label=label)
        for low, high, alpha, layer, label in bands
    ]


def dress_axes(
    axes: Axes, sheet: Sheet, heading: str, time_label: str | None, value_label: str | None
) -> None:
    """Limits, grid, ticks and names, with as little ink as possible."""
    palette, size = sheet.palette, text_size(sheet)
    axes.set_facecolor(palette.paper)
    axes.set_ylim(sheet.low, sheet.high)
    x = sheet.clock.draw(sheet.curves.time)
    margin = 0.02 * float(x[-1] - x[0]) or 1.0
    axes.set_xlim(float(x[0]) - margin, float(x[-1]) + margin)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
    axes.spines["bottom"].set_color(palette.quiet)
    axes.grid(axis="y", color=palette.grid, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(axis="both", colors=palette.quiet, labelsize=size, length=0)
    axes.tick_params(axis="x", length=3)
    dress_clock(axes, sheet.clock, sheet)
    axes.yaxis.get_offset_text().set(color=palette.quiet, fontsize=size)
    draw_heading(axes, sheet, heading)
    if name := time_label or sheet.clock.label:
        axes.set_xlabel(name, color=palette.quiet, fontsize=size, loc="right", parse_math=False)
    if value_label:
        axes.set_ylabel(value_label, color=palette.quiet, fontsize=size, loc="top", parse_math=False)


def dress_clock(axes: Axes, clock: Clock, paper: Paper) -> None:
    """Ticks of the axis of times: of the calendar where the times are points in time."""
    if clock.dates:
        locator = mdates.AutoDateLocator(minticks=3, maxticks=5 if paper.small else 8)
        axes.xaxis.set_major_locator(locator)
        axes.xaxis.set_major_formatter(mdates.ConciseDateFormatter(locator))
    axes.xaxis.get_offset_text().set(color=paper.palette.quiet, fontsize=text_size(paper))


def draw_heading(axes: Axes, paper: Paper, heading: str) -> None:
    """Title over the axes, broken where it is too long; an empty one is none."""
    size = text_size(paper) + 1.5
    # A dollar sign in a caller's text is a dollar sign: nothing is set as mathematics.
    if heading:
        axes.set_title(
            _broken(heading, int(paper.width_px * _PX_TO_PT / (_LETTER_EM * size))),
            loc="left", color=paper.palette.ink, fontsize=size, fontweight="bold", parse_math=False,
        )  # fmt: skip


def _broken(heading: str, letters: int) -> str:
    """Break a heading that is too long into lines of about equal length."""
    lines = math.ceil(len(heading) / letters)
    return heading if lines < 2 else textwrap.fill(heading, min(letters, math.ceil(len(heading) / lines) + 2))


def draw_legend(figure: Figure, entries: list[Artist], sheet: Paper) -> Legend:
    """Legend below the axes, where it hides nothing, to be read row by row."""
    columns = 2 if sheet.width_px < 380 else 3 if sheet.width_px < 620 else 4
    # Matplotlib fills a legend column by column, the first columns being the longer ones.
    rows, longer = divmod(len(entries), columns)
    lengths = [rows + (column < longer) for column in range(columns)]
    ordered = [entries[row * columns + column] for column in range(columns) for row in range(lengths[column])]
    return figure.legend(
        handles=ordered,
        loc="outside lower left",
        ncols=columns,
        frameon=False,
        fontsize=text_size(sheet) - 0.5,
        labelcolor=sheet.palette.ink,
        handlelength=1.2 if sheet.small else 1.8,
        handletextpad=0.6,
        columnspacing=1.2,
        labelspacing=0.4,
        borderpad=0.6,
        borderaxespad=0.0,
    )


def text_size(sheet: Paper) -> float:
    """Points of the text of a picture."""
    return 7.5 if sheet.small else 9.0


def entry(label: str, **look: Any) -> Line2D:
    """Entry of a legend."""
    return Line2D([], [], label=label, **{"linestyle": "none", **look})
