r"""Pictures of cleaned tracks: a map, and how far each fix is off over time (extra ``[plot]``).

Good fixes are discs, faults have a shape and a colour for each reason. The map needs no tiles and no network:
it is drawn in metres, north up, and what lies far beyond the track is marked at its rim. The same answer
gives the same bytes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from estimators.adapters import track_errors, track_map
from estimators.adapters.figure_strokes import draw_heading, draw_legend, entry, text_size
from estimators.adapters.plotting import Theme, canvas, palette_of
from estimators.adapters.track_marks import draw_fixes, faulty_rows, mark_entries
from estimators.adapters.track_sheet import TrackSheet
from estimators.adapters.track_view import metres_text
from estimators.arrays import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from estimators.arrays import FloatArray
    from estimators.trajectories.track import Track

TrackPicture = Literal["map", "error"]

_DPI = 96
# Lower pictures have no room for the speed below the errors.
_LEAST_FOR_SPEED_PX = 280
# And still lower ones, none for a legend.
_LEAST_FOR_LEGEND_PX = 200


def plot_track(track: Track, kind: TrackPicture = "map", **style: Any) -> Figure:
    """Draw a track in one of the ways there are.

    Parameters
    ----------
    track : Track
    kind : {"map", "error"}
    **style
        ``width_px``, ``height_px``, ``theme`` and ``title`` of :func:`map_figure` or :func:`error_figure`.

    Raises
    ------
    InputError
        If the kind, the size or the theme is unknown.
    """
    figures = {"map": map_figure, "error": error_figure}
    if kind not in figures:
        raise InputError("kind", f"unknown picture {kind!r}; known: {', '.join(figures)}")
    return figures[kind](track, **style)


def map_figure(
    track: Track,
    *,
    width_px: int = 800,
    height_px: int = 600,
    theme: Theme = "light",
    title: str | None = None,
) -> Figure:
    r"""Draw where the track goes, the fixes that lie and the region that holds it.

    Parameters
    ----------
    track : Track
    width_px, height_px : int
        Size in CSS pixels, 200 to 4000 and 150 to 4000 (default 800 x 600).
    theme : {"light", "dark"}
    title : str, optional
        Default: the distance, and how many fixes are off. An empty text leaves it out.

    Returns
    -------
    matplotlib.figure.Figure
        Not registered with pyplot; :func:`estimators.adapters.plotting.render` turns it into bytes.

    Raises
    ------
    InputError
        If the size or the theme cannot be used.

    Examples
    --------
    >>> import numpy as np
    >>> from estimators import clean_trajectory
    >>> from estimators.adapters.plotting import render
    >>> t = np.arange(30.0)
    >>> track = clean_trajectory(t, 48.1 + 9e-5 * t, np.full(30, 11.5))
    >>> render(map_figure(track), "png")[:4]
    b'\x89PNG'
    """
    sheet = TrackSheet.of(track, palette_of(width_px, height_px, theme), width_px, height_px)
    with canvas(width_px, height_px, theme) as (figure, palette):
        axes = figure.add_subplot()
        axes.set_facecolor(palette.paper)
        axes.set_xticks([])
        axes.set_yticks([])
        for spine in axes.spines.values():
            spine.set_color(palette.grid)
        draw_heading(axes, sheet, _map_title(track, sheet) if title is None else title)
        axes.set_xlabel(_place_text(sheet), color=palette.quiet, fontsize=text_size(sheet) - 0.5, loc="right")
        _draw_map(figure, axes, sheet)
    return figure


def _draw_map(figure: Figure, axes: Axes, sheet: TrackSheet) -> None:
    """Settle the size of the axes under the largest legend that may come, then draw what fits into them."""
    placed = sheet.placed
    has_legend = sheet.height_px >= _LEAST_FOR_LEGEND_PX
    supposed = [entry("supposed")] * 5
    legend = draw_legend(figure, [*supposed, *mark_entries(sheet)], sheet) if has_legend else None
    size_px = _settled_size(figure, axes)
    if legend is not None:
        legend.remove()
    view = track_map.frame_of(sheet, size_px)
    axes.set_xlim(view.low_m[0], view.high_m[0])
    axes.set_ylim(view.low_m[1], view.high_m[1])
    visible = placed & view.shows(sheet.fix_m)
    cells = (int(size_px[0]), int(size_px[1]))
    track_map.draw_leads(axes, sheet, visible)
    entries = track_map.draw_track(axes, sheet, view)
    draw_fixes(axes, sheet, sheet.fix_m[:, 0], sheet.fix_m[:, 1], visible, cells)
    rim = track_map.draw_rim(axes, sheet, view, placed & ~visible)
    ends = track_map.draw_ends(axes, sheet)
    track_map.draw_scale(axes, sheet, view)
    if has_legend:
        draw_legend(figure, [*entries, *ends, *mark_entries(sheet), *rim], sheet)


def error_figure(
    track: Track,
    *,
    width_px: int = 800,
    height_px: int = 600,
    theme: Theme = "light",
    title: str | None = None,
) -> Figure:
    """Draw over time how far each fix lies from the smoothed track, how sure this is, and the speed.

    The scale of distances is linear for metres and logarithmic beyond: a fix 3 km off hides no good one.

    Parameters
    ----------
    track : Track
    width_px, height_px, theme
        As in :func:`map_figure`.
    title : str, optional
        Default: how sure the track is, and how far fixes are off. An empty text leaves it out.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        If the size or the theme cannot be used.
    """
    sheet = TrackSheet.of(track, palette_of(width_px, height_px, theme), width_px, height_px)
    with canvas(width_px, height_px, theme) as (figure, _):
        if height_px >= _LEAST_FOR_SPEED_PX:
            upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.6, 1.0])
        else:
            upper = lower = figure.add_subplot()
        cells = (width_px, height_px)
        entries = track_errors.draw_errors(upper, sheet, cells)
        track_errors.dress(upper, sheet, "distance from the track")
        if lower is not upper:
            entries += track_errors.draw_speed(lower, sheet, width_px)
            track_errors.dress(lower, sheet, "speed, m/s")
        track_errors.dress_time(lower, sheet)
        draw_heading(upper, sheet, _error_title(sheet) if title is None else title)
        if height_px >= _LEAST_FOR_LEGEND_PX:
            draw_legend(figure, [*entries, *mark_entries(sheet)], sheet)
    return figure


def _settled_size(figure: Figure, axes: Any) -> FloatArray:
    """Lay the figure out for good and return the size of its axes in pixels."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    place = axes.get_position()
    return np.asarray(np.array([place.width, place.height]) * figure.get_size_inches() * _DPI)


def _map_title(track: Track, sheet: TrackSheet) -> str:
    off = int(np.count_nonzero(faulty_rows(sheet)))
    fixes = f"{off:,} of {sheet.t.size:,} fixes are off" if off else f"none of {sheet.t.size:,} fixes is off"
    return f"{metres_text(track.distance.cleaned.value)} travelled, {fixes}"


def _error_title(sheet: TrackSheet) -> str:
    said = f"Track within {metres_text(float(np.median(sheet.radius_m)))} ({100 * sheet.level:g} %, median)"
    off = sheet.residual_m[faulty_rows(sheet) & np.isfinite(sheet.residual_m)]
    return (
        said if not off.size else f"{said}, {off.size:,} fixes off by up to {metres_text(float(off.max()))}"
    )


def _place_text(sheet: TrackSheet) -> str:
    """Say where on Earth the middle of the track is."""
    lat, lon = sheet.middle_deg
    return f"middle {abs(lat):.4f}° {'N' if lat >= 0 else 'S'}, {abs(lon):.4f}° {'E' if lon >= 0 else 'W'}"
