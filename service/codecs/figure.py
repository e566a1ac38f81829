"""Pictures out: SVG and PNG, drawn by :mod:`estimators.adapters.plotting`."""

from __future__ import annotations

from typing import Literal

from estimators import Trend
from service.codecs.columns import Columns
from service.schemas.options import AnswerQuery


def write_svg(trend: Trend, _columns: Columns, query: AnswerQuery) -> bytes:
    """Picture as SVG; the same answer gives the same bytes."""
    return _draw(trend, query, "svg")


def write_png(trend: Trend, _columns: Columns, query: AnswerQuery) -> bytes:
    """Picture as PNG."""
    return _draw(trend, query, "png")


def _draw(trend: Trend, query: AnswerQuery, file_format: Literal["svg", "png"]) -> bytes:
    # Matplotlib takes longer to import than the whole service; who asks for no picture does not wait for it.
    from estimators.adapters.plotting import render, trend_figure  # noqa: PLC0415

    figure = trend_figure(
        trend, width_px=query.width_px, height_px=query.height_px, theme=query.theme, title=query.title
    )
    return render(figure, file_format)
