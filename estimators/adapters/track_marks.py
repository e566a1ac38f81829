"""How the fixes of a track are marked: a shape and a colour for each reason, paler where less sure.

Shapes differ as well as colours, so that reasons are told apart with every kind of colour vision and in
print; the colours are those of Okabe and Ito (2008), their purple darkened on white.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from estimators.adapters.figure_sheet import PALETTES, Palette, mixed
from estimators.adapters.figure_strokes import CERTAINTIES, MAX_MARKERS, entry
from estimators.adapters.thinning import one_per_cell
from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.trajectories.reasons import FixReason

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

    from estimators.adapters.track_sheet import TrackSheet

_PURPLE = MappingProxyType({PALETTES["light"].paper: "#a94f8a", PALETTES["dark"].paper: "#e08fc0"})


@dataclass(frozen=True, slots=True)
class Mark:
    """Look of the fixes of a reason.

    Attributes
    ----------
    title : str
        In the legend.
    marker : str
        As matplotlib calls it.
    colour : str
        Attribute of the palette, or ``purple``.
    hollow : bool
        Whether only its outline is drawn.
    faulty : bool
        Whether the fix is one that the track does not follow.
    """

    title: str
    marker: str
    colour: str
    hollow: bool = False
    faulty: bool = True

    def in_colours(self, palette: Palette) -> str:
        """Colour in a theme."""
        return _PURPLE[palette.paper] if self.colour == "purple" else str(getattr(palette, self.colour))


#: In the order of drawing, the later ones over the earlier.
MARKS: Mapping[FixReason, Mark] = MappingProxyType(
    {
        FixReason.ok: Mark("good", "o", "inlier", faulty=False),
        FixReason.duplicate: Mark("duplicate", "o", "quiet", hollow=True, faulty=False),
        FixReason.gap_edge: Mark("beside a gap", "o", "inlier", hollow=True, faulty=False),
        FixReason.invalid: Mark("invalid", "|", "quiet"),
        FixReason.out_of_order: Mark("clock off", "+", "ink"),
        FixReason.stale: Mark("stale", "D", "other"),
        FixReason.burst: Mark("burst", "s", "purple"),
        FixReason.spike: Mark("spike", "X", "outlier"),
    }
)


def rows_by_reason(sheet: TrackSheet) -> dict[FixReason, IntArray]:
    """Rows of each reason that occurs, in the order of drawing."""
    rows = {reason: np.flatnonzero(sheet.codes == reason) for reason in MARKS}
    return {reason: found for reason, found in rows.items() if found.size}


def faulty_rows(sheet: TrackSheet) -> BoolArray:
    """Whether a row is one that the track does not follow, shape (m,)."""
    codes = [reason for reason, mark in MARKS.items() if mark.faulty]
    return np.isin(sheet.codes, codes)


def draw_fixes(
    axes: Axes,
    sheet: TrackSheet,
    x: FloatArray,
    y: FloatArray,
    visible: BoolArray,
    cells: tuple[int, int],
) -> None:
    """Draw the visible fixes, reason by reason.

    Parameters
    ----------
    axes : Axes
    sheet : TrackSheet
    x, y : ndarray of float64, shape (m,)
        Where; a row of the sheet each.
    visible : ndarray of bool, shape (m,)
    cells : tuple of int
        Pixels across and up of the axes: of very many fixes, one in each is drawn.
    """
    for layer, (reason, rows) in enumerate(rows_by_reason(sheet).items()):
        mark, seen = MARKS[reason], rows[visible[rows]]
        if seen.size:
            zorder = (2.5 if mark.faulty else 2.0) + 0.01 * layer
            _draw_mark(axes, sheet, mark, seen, (x, y), cells, zorder)


def _draw_mark(
    axes: Axes,
    sheet: TrackSheet,
    mark: Mark,
    rows: IntArray,
    at: tuple[FloatArray, FloatArray],
    cells: tuple[int, int],
    zorder: float,
) -> None:
    x, y = at
    look = _look(mark, rows.size, sheet)
    dense = rows.size > MAX_MARKERS
    if dense:
        cell_px = 4 if mark.faulty else 1
        columns, rows_up = (max(count // cell_px, 1) for count in cells)
        rows = rows[one_per_cell(x[rows], y[rows], columns, rows_up)]
    upper = np.inf
    certainty = _certainty(sheet, mark, rows)
    for least, strength in CERTAINTIES:
        here = rows[(certainty >= least) & (certainty < upper)]
        upper = least
        if not here.size:
            continue
        face = mixed(mark.in_colours(sheet.palette), sheet.palette.paper, strength)
        colours = {} if mark.hollow else {"markerfacecolor": face}
        axes.plot(
            x[here], y[here], linestyle="none", rasterized=dense, zorder=zorder, **{**look, **colours}
        )  # fmt: skip


def _certainty(sheet: TrackSheet, mark: Mark, rows: IntArray) -> FloatArray:
    """Probability of the labels of good fixes; faults are drawn in full, so that none is overlooked."""
    if mark.faulty or mark.hollow:
        return np.ones(rows.size)
    return np.nan_to_num(sheet.probability[rows], nan=1.0)


def _look(mark: Mark, count: int, sheet: TrackSheet) -> dict[str, Any]:
    """Size that leaves single fixes apart: larger for few, a dot for very many."""
    colour = mark.in_colours(sheet.palette)
    size = 4.4 if count <= 80 else 3.4 if count <= 500 else 2.4 if count <= MAX_MARKERS else 1.6
    if mark.faulty:
        size += 1.6 if count <= 500 else 0.8
    size *= 0.85 if sheet.small else 1.0
    outline = 1.1 if mark.marker in "+|" else 0.8 if mark.hollow else 0.3
    edge = colour if mark.hollow or mark.marker in "+|" or not mark.faulty else sheet.palette.paper
    return {
        "marker": mark.marker,
        "markersize": size,
        "markerfacecolor": "none" if mark.hollow else colour,
        "markeredgecolor": edge,
        "markeredgewidth": 0.0 if count > MAX_MARKERS and not mark.hollow else outline,
    }


def mark_entries(sheet: TrackSheet) -> list[Artist]:
    """Entries of the legend: each reason that occurs, and how often."""
    found = rows_by_reason(sheet)
    entries: list[Artist] = []
    for reason, rows in sorted(found.items()):
        look = {**_look(MARKS[reason], 1, sheet), "markersize": 5.0}
        entries.append(entry(f"{MARKS[reason].title} ({rows.size:,})", **look))
    good = sheet.probability[found.get(FixReason.ok, np.empty(0, dtype=np.int64))]
    if bool(np.any(good < CERTAINTIES[0][0])):
        colour = MARKS[FixReason.ok].in_colours(sheet.palette)
        pale = mixed(colour, sheet.palette.paper, CERTAINTIES[-1][1])
        look = {"markerfacecolor": pale, "markeredgecolor": colour, "markeredgewidth": 0.5}
        entries.append(entry("paler: less sure", marker="o", markersize=5.0, **look))
    return entries
