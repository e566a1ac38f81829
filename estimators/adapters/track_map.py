"""The parts of a map of a track, drawn on matplotlib axes whose size in pixels is settled."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import patheffects
from matplotlib.collections import LineCollection, PolyCollection

from estimators.adapters.figure_sheet import mixed
from estimators.adapters.figure_strokes import entry, text_size
from estimators.adapters.thinning import one_per_cell
from estimators.adapters.track_marks import MARKS, faulty_rows, rows_by_reason
from estimators.adapters.track_sheet import TrackSheet, broken_before, vertices
from estimators.adapters.track_view import View, metres_text, round_length
from estimators.arrays import BoolArray, FloatArray, IntArray

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

# A longer line is an image inside an SVG, and is cut where matplotlib draws slowly.
_MOST_VERTICES, _HEAVY, _PIECE = 100_000, 20_000, 10_000
_VERTEX_PX = 0.5
# Regions of the track: how many, how far apart at least, and from which radius on they are seen.
_MOST_REGIONS, _REGION_PX, _SEEN_PX = 5_000, 1.5, 1.5
_CORNERS = 24
# From how many faults on no line leads from each to where the track was.
_MOST_LEADS = 60
_DOTS = (0, (1, 2.2))
_LINE_PT = 1.5
_BAR_SHARE = 0.28


def frame_of(sheet: TrackSheet, size_px: FloatArray) -> View:
    """Choose the part of the plane that a map of this size shows."""
    faulty = faulty_rows(sheet)
    good = sheet.fix_m[sheet.placed & ~faulty]
    return View.over(np.concatenate([sheet.track_m, good]), sheet.fix_m[sheet.placed & faulty], size_px)


def draw_track(axes: Axes, sheet: TrackSheet, view: View) -> list[Artist]:
    """Smoothed track over its region; dots across gaps, where nobody knows the way."""
    ink = sheet.palette.ink
    entries: list[Artist] = [entry("cleaned track", linestyle="-", color=ink, linewidth=_LINE_PT)]
    at_px = view.in_pixels(sheet.track_m)
    gaps = np.flatnonzero(sheet.after_gap)
    kept = np.union1d(
        vertices(at_px[:, 0], at_px[:, 1], _VERTEX_PX, _MOST_VERTICES), np.concatenate([gaps - 1, gaps])
    )
    _draw_walked(axes, sheet, kept)
    far = gaps[np.linalg.norm(at_px[gaps] - at_px[gaps - 1], axis=1) > 3.0]
    if far.size:
        ways = np.stack([sheet.track_m[far - 1], sheet.track_m[far]], axis=1)
        heavy = far.size > _HEAVY
        axes.add_collection(
            LineCollection(
                list(ways), colors=ink, linewidths=1.0, linestyles=[_DOTS], zorder=3, rasterized=heavy
            ),
            autolim=False,
        )
        entries.append(entry("across a gap", linestyle=_DOTS, color=ink, linewidth=1.0))
    entries += _draw_region(axes, sheet, view)
    return entries


def _draw_walked(axes: Axes, sheet: TrackSheet, kept: IntArray) -> None:
    """Line through the kept vertices, broken at gaps."""
    heavy = kept.size > _HEAVY
    for start in range(0, kept.size, _PIECE):
        rows = kept[start : start + _PIECE + 1]
        breaks = np.flatnonzero(broken_before(sheet.after_gap, rows))
        line = np.insert(sheet.track_m[rows], breaks, np.nan, axis=0)
        axes.plot(
            *line.T, color=sheet.palette.ink, linewidth=_LINE_PT, zorder=3, rasterized=heavy,
            solid_joinstyle="round", solid_capstyle="round",
        )  # fmt: skip


def _draw_region(axes: Axes, sheet: TrackSheet, view: View) -> list[Artist]:
    """Union of the ellipses of all places, where wider than the line; opaque, so that no overlap is seen."""
    radius_px = sheet.radius_m * view.metre_px
    if not bool(np.any(radius_px > _SEEN_PX)):
        return []
    at_px = view.in_pixels(sheet.track_m)
    rows = vertices(at_px[:, 0], at_px[:, 1], _REGION_PX, _MOST_REGIONS)
    color = mixed(sheet.palette.band, sheet.palette.paper, 0.38)
    ellipses = _ellipses(sheet, rows)
    # Not across a gap: the way there need not lie between the two regions.
    joined = np.flatnonzero(~broken_before(sheet.after_gap, rows)[1:])
    bands = _bands(sheet, rows[joined], rows[joined + 1])
    for shapes in (ellipses, bands):
        axes.add_collection(
            PolyCollection(
                list(shapes), facecolors=color, edgecolors=color, linewidths=0.4, zorder=1,
                rasterized=rows.size > 1000,
            ),
            autolim=False,
        )  # fmt: skip
    look = {"marker": "s", "markersize": 8.0, "color": color, "markeredgewidth": 0.0}
    return [entry(f"{100 * sheet.level:g} % region", **look)]


def _ellipses(sheet: TrackSheet, rows: IntArray) -> FloatArray:
    """Outlines of the regions of rows, shape (k, corners, 2)."""
    variance, axes = np.linalg.eigh(sheet.covariance_m2[rows])
    root = axes * np.sqrt(np.maximum(variance, 0.0))[:, None, :]
    angle = np.linspace(0.0, 2.0 * np.pi, _CORNERS, endpoint=False)
    circle = sheet.reach * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.asarray(sheet.track_m[rows][:, None, :] + np.einsum("kij,cj->kci", root, circle))


def _bands(sheet: TrackSheet, first: IntArray, last: IntArray) -> FloatArray:
    """Outlines of what the region sweeps between rows: quadrilaterals that touch both ellipses.

    A line of normal n touches the ellipse of covariance C at C n / sqrt(n' C n) from its middle.
    """
    way = sheet.track_m[last] - sheet.track_m[first]
    length = np.linalg.norm(way, axis=1)
    first, last, way = first[length > 0.0], last[length > 0.0], way[length > 0.0]
    normal = np.column_stack([-way[:, 1], way[:, 0]]) / length[length > 0.0][:, None]
    corners = []
    for rows in (first, last):
        spread = np.einsum("kij,kj->ki", sheet.covariance_m2[rows], normal)
        width = np.sqrt(np.maximum(np.sum(spread * normal, axis=1), np.finfo(float).tiny))
        touch = sheet.reach * spread / width[:, None]
        corners += [sheet.track_m[rows] + touch, sheet.track_m[rows] - touch]
    return np.stack([corners[0], corners[2], corners[3], corners[1]], axis=1)


def draw_leads(axes: Axes, sheet: TrackSheet, visible: BoolArray) -> None:
    """Fine lines from faults to where the track was at their time, unless these are too many to follow."""
    for reason, those in rows_by_reason(sheet).items():
        rows = those[visible[those]]
        if MARKS[reason].faulty and 0 < rows.size <= _MOST_LEADS:
            ways = np.stack([sheet.fix_m[rows], sheet.track_m[rows]], axis=1)
            color = mixed(MARKS[reason].in_colours(sheet.palette), sheet.palette.paper, 0.5)
            axes.add_collection(
                LineCollection(list(ways), colors=color, linewidths=0.6, zorder=1.5), autolim=False
            )


def draw_rim(axes: Axes, sheet: TrackSheet, view: View, beyond: BoolArray) -> list[Artist]:
    """Triangles at the rim where fixes lie beyond it, how many there are and how far they are off."""
    total = int(np.count_nonzero(beyond))
    if not total:
        return []
    cells = np.maximum(view.size_px // 8, 1).astype(np.int64)
    for reason, those in rows_by_reason(sheet).items():
        rows = those[beyond[those]]
        if not rows.size:
            continue
        rim = view.to_rim(sheet.track_m[rows], sheet.fix_m[rows])
        rim = rim[one_per_cell(rim[:, 0], rim[:, 1], int(cells[0]), int(cells[1]))]
        share = (rim - view.low_m) * view.metre_px / view.size_px
        sides = np.column_stack([share[:, 0], 1.0 - share[:, 0], share[:, 1], 1.0 - share[:, 1]])
        nearest = np.argmin(sides * np.repeat(view.size_px, 2), axis=1)
        for side, marker in enumerate("<>v^"):
            here = rim[nearest == side]
            axes.plot(
                *here.T, linestyle="none", marker=marker, markersize=5.0, markeredgewidth=0.0,
                color=MARKS[reason].in_colours(sheet.palette), zorder=4,
            )  # fmt: skip
    farthest = float(np.max(sheet.residual_m[beyond]))
    look = {"marker": ">", "markersize": 5.0, "markeredgewidth": 0.0, "color": sheet.palette.outlier}
    return [entry(f"beyond the map ({total:,}, to {metres_text(farthest)})", **look)]


def draw_ends(axes: Axes, sheet: TrackSheet) -> list[Artist]:
    """Where the track starts and where it ends."""
    palette = sheet.palette
    size = 6.5 if sheet.small else 8.0
    start = {"marker": "o", "markerfacecolor": palette.paper, "markeredgecolor": palette.ink}
    end = {"marker": "s", "markerfacecolor": palette.ink, "markeredgecolor": palette.paper}
    entries: list[Artist] = []
    # The start is the larger one: it is seen around the end where both are one place.
    for name, row, look, scale in (("start", 0, start, 1.25), ("end", -1, end, 0.85)):
        style: dict[str, Any] = {**look, "markersize": scale * size, "markeredgewidth": 1.3}
        axes.plot(*sheet.track_m[row, :, None], linestyle="none", zorder=5, **style)
        entries.append(entry(name, **{**style, "markersize": 6.5 * scale}))
    return entries


def draw_scale(axes: Axes, sheet: TrackSheet, view: View) -> None:
    """Bar of a round length and an arrow to the north, in the emptiest corner."""
    palette, size = sheet.palette, text_size(sheet)
    length = round_length(_BAR_SHARE * float(view.size_px[0]) / view.metre_px)
    width, height = length * view.metre_px, 3.6 * size
    pad = 14.0
    box = np.array([width + 30.0, height + 4.0])
    at_px = view.in_pixels(np.concatenate([sheet.track_m, sheet.fix_m[sheet.placed]]))
    free = np.maximum(view.size_px - box - 2.0 * pad, 0.0)
    corners = [np.array([x, y]) for y in (0.0, free[1]) for x in (0.0, free[0])]
    crowd = [
        int(np.count_nonzero(np.all((at_px >= low) & (at_px <= low + box + 2.0 * pad), axis=1)))
        for low in corners
    ]
    left, low = corners[int(np.argmin(crowd))] + pad

    def at(x: float, y: float) -> tuple[float, float]:
        place = view.low_m + np.array([x, y]) / view.metre_px
        return float(place[0]), float(place[1])

    halo = [patheffects.withStroke(linewidth=3.0, foreground=palette.paper)]
    ends = [at(left, low + 5), at(left, low), at(left + width, low), at(left + width, low + 5)]
    axes.plot(
        *zip(*ends, strict=True), color=palette.ink, linewidth=1.4, zorder=6, path_effects=halo,
        solid_joinstyle="miter",
    )  # fmt: skip
    # No halo about letters: it would turn the text of an SVG into outlines.
    paper = {"facecolor": palette.paper, "edgecolor": "none", "alpha": 0.7, "pad": 0.5}
    look: dict[str, Any] = {"color": palette.ink, "fontsize": size, "zorder": 6, "bbox": paper}
    axes.text(*at(left + 0.5 * width, low + 6), metres_text(length), ha="center", va="bottom", **look)
    x = left + width + 18.0
    axes.annotate(
        "", at(x, low + height), at(x, low - 3),
        arrowprops={"arrowstyle": "-|>", "color": palette.ink, "linewidth": 1.2, "shrinkA": 0, "shrinkB": 0},
        zorder=6,
    )  # fmt: skip
    axes.text(*at(x, low + height), "N", ha="center", va="bottom", **look)
