"""Pictures of positions: the sky with the satellites that lie, their residuals, and the Stanford diagram.

Used satellites are discs, excluded ones crosses and untestable ones rings, so that a picture survives without
colour; the colours are those of Okabe and Ito (2008). The same answer gives the same bytes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from estimators.adapters.figure_sheet import Palette
from estimators.adapters.plotting import Theme, canvas
from estimators.arrays import ArrayLike, FloatArray, InputError
from estimators.gnss.fix import Fix, SatelliteStatus

_MARKS: dict[SatelliteStatus, str] = {"used": "o", "excluded": "X", "untestable": "o"}
_TITLES: dict[SatelliteStatus, str] = {
    "used": "used",
    "excluded": "excluded",
    "untestable": "nothing checks it",
}


def sky_figure(
    fix: Fix,
    *,
    width_px: int = 600,
    height_px: int = 600,
    theme: Theme = "light",
    title: str | None = None,
) -> Figure:
    """Draw where the satellites stand: north up, east right, the horizon outside.

    Parameters
    ----------
    fix : Fix
    width_px, height_px : int
        Size in CSS pixels, 200 to 4000 and 150 to 4000.
    theme : {"light", "dark"}
    title : str, optional
        Default: how many satellites are used. An empty text leaves it out.

    Raises
    ------
    InputError
        If the size or the theme cannot be used.
    """
    inner = fix.satellites
    with canvas(width_px, height_px, theme) as (figure, palette):
        axes: Any = figure.add_subplot(projection="polar")
        axes.set_facecolor(palette.paper)
        axes.set_theta_zero_location("N")
        axes.set_theta_direction(-1)
        axes.set_rlim(0, 90)
        axes.set_rgrids([30, 60], ["60°", "30°"], color=palette.quiet, fontsize=9)
        axes.set_thetagrids([0, 90, 180, 270], ["N", "E", "S", "W"], color=palette.ink)
        axes.grid(color=palette.grid)
        axes.spines["polar"].set_color(palette.quiet)
        for status, mark in _MARKS.items():
            rows = [row for row, name in enumerate(inner.status) if name == status]
            if rows:
                azimuth = np.radians(inner.azimuth_deg[rows])
                zenith = 90.0 - inner.elevation_deg[rows]
                colour = _colour(status, palette)
                face = "none" if status == "untestable" else colour
                axes.scatter(
                    azimuth, zenith, s=70, marker=mark, facecolors=face, edgecolors=colour, zorder=3,
                    label=_TITLES[status],
                )  # fmt: skip
                for row, angle, radius in zip(rows, azimuth, zenith, strict=True):
                    axes.annotate(
                        inner.name[row], (angle, radius), xytext=(6, 6), textcoords="offset points",
                        color=palette.ink, fontsize=9,
                    )  # fmt: skip
        _head(axes, figure, _sky_title(fix) if title is None else title, palette)
    return figure


def residual_figure(
    fix: Fix,
    *,
    width_px: int = 800,
    height_px: int = 450,
    theme: Theme = "light",
    title: str | None = None,
) -> Figure:
    """Draw the residual of each satellite with its minimum detectable bias.

    Parameters
    ----------
    fix : Fix
    width_px, height_px, theme, title
        As in :func:`sky_figure`.
    """
    inner = fix.satellites
    rows = [row for row, status in enumerate(inner.status) if status in _MARKS]
    with canvas(width_px, height_px, theme) as (figure, palette):
        axes = _plane(figure, palette)
        # Linear within a few metres and logarithmic beyond: a fault of a kilometre hides no residual.
        axes.set_yscale("symlog", linthresh=10.0)
        places = {row: place for place, row in enumerate(rows)}
        reach = np.array([inner.mdb_m[row] for row in rows])
        known = np.isfinite(reach)
        axes.vlines(
            np.flatnonzero(known), -reach[known], reach[known], color=palette.band, alpha=0.5, linewidth=6,
            label="not detectable",
        )  # fmt: skip
        for status, mark in _MARKS.items():
            mine = [row for row in rows if inner.status[row] == status]
            if mine:
                colour = _colour(status, palette)
                axes.scatter(
                    [places[row] for row in mine], inner.residual_m[mine], s=60, marker=mark,
                    facecolors="none" if status == "untestable" else colour, edgecolors=colour, zorder=3,
                    label=_TITLES[status],
                )  # fmt: skip
        axes.axhline(0.0, color=palette.quiet, linewidth=1)
        axes.set_xticks(
            range(len(rows)), [inner.name[row] for row in rows], rotation=90 if len(rows) > 12 else 0
        )
        axes.set_ylabel("residual, m", color=palette.ink)
        _head(axes, figure, "Residuals of the pseudoranges" if title is None else title, palette)
    return figure


def stanford_figure(
    error_m: ArrayLike,
    protection_m: ArrayLike,
    alert_m: float,
    *,
    width_px: int = 600,
    height_px: int = 600,
    theme: Theme = "light",
    title: str | None = None,
) -> Figure:
    """Draw protection levels against true errors (the Stanford diagram).

    Parameters
    ----------
    error_m, protection_m : array_like, shape (k,)
        Of epochs whose truth is known.
    alert_m : float
        Alert limit.
    width_px, height_px, theme, title
        As in :func:`sky_figure`. The default title gives the share of epochs in which the error exceeds
        the level.

    Raises
    ------
    InputError
        If the columns disagree or hold no finite pair.
    """
    error, level = np.asarray(error_m, dtype=np.float64), np.asarray(protection_m, dtype=np.float64)
    if error.shape != level.shape or error.ndim != 1:
        raise InputError("protection_m", f"expected one level per error, got {level.shape} for {error.shape}")
    known = np.isfinite(error) & np.isfinite(level)
    if not known.any():
        raise InputError("error_m", "holds no finite error with a finite protection level")
    error, level = error[known], level[known]
    missed = int(np.count_nonzero(error > level))
    limit = 1.1 * max(float(np.max(error)), float(np.quantile(level, 0.99)), alert_m)
    with canvas(width_px, height_px, theme) as (figure, palette):
        axes = _plane(figure, palette)
        axes.fill_between([0.0, limit], [0.0, limit], 0.0, color=palette.outlier, alpha=0.12, linewidth=0)
        axes.axhline(alert_m, color=palette.quiet, linewidth=1, linestyle="--")
        axes.scatter(error, np.minimum(level, limit), s=9, color=_by_side(error, level, palette), zorder=3)
        axes.set_xlim(0.0, limit)
        axes.set_ylim(0.0, limit)
        axes.set_xlabel("horizontal error, m", color=palette.ink)
        axes.set_ylabel("protection level, m", color=palette.ink)
        heading = f"{missed} of {error.size} errors exceed their level" if title is None else title
        _head(axes, figure, heading, palette, legend=False)
    return figure


def _by_side(error: FloatArray, level: FloatArray, palette: Palette) -> list[str]:
    return [palette.outlier if wrong else palette.inlier for wrong in error > level]


def _colour(status: SatelliteStatus, palette: Palette) -> str:
    return palette.outlier if status == "excluded" else palette.inlier


def _plane(figure: Figure, palette: Palette) -> Any:
    """Axes with a quiet frame."""
    axes: Any = figure.add_subplot()
    axes.set_facecolor(palette.paper)
    axes.grid(color=palette.grid, linewidth=0.8)
    axes.tick_params(colors=palette.quiet)
    for name, spine in axes.spines.items():
        spine.set_visible(name in ("left", "bottom"))
        spine.set_color(palette.quiet)
    return axes


def _head(axes: Any, figure: Figure, title: str, palette: Palette, *, legend: bool = True) -> None:
    if title:
        axes.set_title(title, color=palette.ink, fontsize=12, pad=12)
    if legend:
        _legend(figure, axes.get_legend_handles_labels(), palette)


def _legend(figure: Figure, entries: tuple[Sequence[Any], Sequence[Any]], palette: Palette) -> None:
    handles, labels = entries
    figure.legend(
        handles, labels, loc="outside lower center", ncols=max(1, len(labels)), frameon=False,
        labelcolor=palette.ink, fontsize=9,
    )  # fmt: skip


def _sky_title(fix: Fix) -> str:
    used = int(fix.satellites.inlier.sum())
    excluded = ", ".join(fix.excluded)
    return f"{used} satellites used" + (f"; excluded: {excluded}" if excluded else "")
