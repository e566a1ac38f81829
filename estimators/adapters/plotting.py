"""A trend as a picture, drawn with matplotlib (extra ``[plot]``) and without its global state.

Inliers are discs and outliers crosses, so that the picture survives without colour; the colours are
those of Okabe and Ito (2008), told apart with every kind of colour vision. The same answer gives the
same bytes, also as SVG.
"""

from __future__ import annotations

import io
import threading
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Literal

from matplotlib import style as mpl_style
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from estimators.adapters.figure_sheet import PALETTES, Palette, Sheet
from estimators.adapters.figure_strokes import (
    draw_bands,
    draw_beyond,
    draw_legend,
    draw_lines,
    draw_points,
    dress_axes,
)
from estimators.arrays import InputError
from estimators.trends.presentation.units import PLAIN, rounded, slope_unit
from estimators.trends.presentation.wording import WORDS

if TYPE_CHECKING:
    from estimators.trends.trend import Trend

Theme = Literal["light", "dark"]
FigureFormat = Literal["svg", "png"]

# A CSS pixel is 1/96 inch: an SVG then has the size asked for in a browser, and a PNG to the pixel.
_DPI = 96
# Drawing changes matplotlib's process-wide settings for a moment.
_LOCK = threading.RLock()


def trend_figure(
    trend: Trend,
    *,
    width_px: int = 800,
    height_px: int = 450,
    theme: Theme = "light",
    title: str | None = None,
    time_label: str | None = None,
    value_label: str | None = None,
) -> Figure:
    r"""Draw the series, the trend with its two bands, the outliers and what is predicted.

    Outliers far from the trend do not squash it: they are counted and marked by triangles at the edge.
    A trend that the data hardly refuse is drawn as a dotted line.

    Parameters
    ----------
    trend : Trend
    width_px, height_px : int
        Size in CSS pixels (1/96 inch), 200 to 4000 and 150 to 4000 (default 800 x 450).
    theme : {"light", "dark"}
    title : str, optional
        Default: the slope and its interval. An empty text leaves the title out.
    time_label, value_label : str, optional
        Names of the axes (default: none).

    Returns
    -------
    matplotlib.figure.Figure
        Not registered with pyplot; :func:`render` turns it into bytes.

    Raises
    ------
    InputError
        If the size or the theme cannot be used.

    Examples
    --------
    >>> from estimators import fit_trend
    >>> picture = trend_figure(fit_trend([0, 1, 2, 3, 4], [1.0, 3.1, 4.9, 30.0, 9.0]))
    >>> render(picture, "png")[:4]
    b'\x89PNG'
    """
    sheet = Sheet.of(trend, palette_of(width_px, height_px, theme), width_px, height_px)
    with drawing():
        figure = Figure(
            figsize=(width_px / _DPI, height_px / _DPI),
            dpi=_DPI,
            layout=ConstrainedLayoutEngine(w_pad=0.12, h_pad=0.06),
            facecolor=sheet.palette.paper,
        )
        axes = figure.add_subplot()
        entries = [
            *draw_points(axes, sheet),
            *draw_beyond(axes, sheet),
            *draw_lines(axes, trend, sheet),
            *draw_bands(axes, sheet),
        ]
        heading = _headline(trend) if title is None else title
        dress_axes(axes, sheet, heading, time_label, value_label)
        draw_legend(figure, entries, sheet)
    return figure


def render(figure: Figure, format: FigureFormat) -> bytes:  # noqa: A002
    """Encode a figure; the same figure gives the same bytes.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    format : {"svg", "png"}
        In an SVG, text stays text and more than a few thousand points become an image.

    Returns
    -------
    bytes

    Raises
    ------
    InputError
        If the format is unknown.
    """
    if format not in ("svg", "png"):
        raise InputError("format", f"unknown figure format {format!r}; known: svg, png")
    sink = io.BytesIO()
    with drawing():
        if format == "svg":
            # The resolution is that of the images inside: twice the screen's, for screens that have it.
            figure.savefig(sink, format="svg", dpi=2 * _DPI, metadata={"Date": None, "Creator": None})
        else:
            figure.savefig(sink, format="png", dpi=_DPI, metadata={"Software": None})
    return sink.getvalue()


def palette_of(width_px: int, height_px: int, theme: str) -> Palette:
    """Colours of a theme, for a picture of a size that can be drawn.

    Raises
    ------
    InputError
        If the size or the theme cannot be used.
    """
    if not (200 <= width_px <= 4000 and 150 <= height_px <= 4000):
        raise InputError("size", "width must lie between 200 and 4000 pixels, height between 150 and 4000")
    if theme not in PALETTES:
        raise InputError("theme", f"unknown theme {theme!r}; known: {', '.join(PALETTES)}")
    return PALETTES[theme]


@contextmanager
def canvas(width_px: int, height_px: int, theme: str) -> Iterator[tuple[Figure, Palette]]:
    """Blank figure of a size and the colours to draw it in, for as long as it is drawn.

    Parameters
    ----------
    width_px, height_px : int
        CSS pixels, 200 to 4000 and 150 to 4000.
    theme : str
        Key of the palettes.

    Raises
    ------
    InputError
        If the size or the theme cannot be used.
    """
    palette = palette_of(width_px, height_px, theme)
    with drawing():
        figure = Figure(
            figsize=(width_px / _DPI, height_px / _DPI),
            dpi=_DPI,
            layout=ConstrainedLayoutEngine(w_pad=0.12, h_pad=0.08),
            facecolor=palette.paper,
        )
        yield figure, palette


@contextmanager
def drawing() -> Iterator[None]:
    """Put matplotlib's defaults and ours in force, whatever its user configured, one thread at a time."""
    ours = {"svg.hashsalt": "plumbline", "svg.fonttype": "none", "font.family": "sans-serif"}
    with _LOCK, mpl_style.context(["default", ours]), warnings.catch_warnings():
        # A letter that the font lacks is drawn as a box; in an SVG the reader's fonts have it.
        warnings.filterwarnings("ignore", message="Glyph .* missing from font", category=UserWarning)
        yield


_HEADLINES: Mapping[str, tuple[str, str]] = {
    "line": ("slope", "Slope"),
    "constant": ("level", "Level"),
    "linear": ("slope", "Mean slope"),
    "exponential": ("rate", "Rate"),
}
"""Parameter that a picture of a shape announces, and its word; else its equation."""


def _headline(trend: Trend) -> str:
    """Say in one line what the picture shows."""
    name, word = _HEADLINES.get(trend.model, ("", ""))
    if name not in trend.parameters:
        return WORDS[trend.model].equation(trend, "t", "y")
    slope, unit = trend.parameters[name], PLAIN if name == "level" else slope_unit(trend)
    stderr = None if slope.stderr is None else slope.stderr * unit.seconds
    text = f"{word} {rounded(slope.value * unit.seconds, stderr)}{unit.per}"
    if slope.low is None or slope.high is None:
        return text
    low, high = (rounded(limit * unit.seconds, stderr) for limit in (slope.low, slope.high))
    return f"{text} ({100 * trend.uncertainty.level:g} %: {low} to {high})"
