"""Pictures of tracks, SVG and PNG, drawn by :mod:`estimators.adapters.track_plots`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from estimators import NoFit
from service.schemas.trajectories import TrackAnswerQuery
from service.trajectories.cleaned import CleanedTracks, no_track

if TYPE_CHECKING:
    from estimators.adapters.plotting import FigureFormat


def write_svg(cleaned: CleanedTracks, query: TrackAnswerQuery) -> Iterator[bytes]:
    """Picture as SVG; the same answer gives the same bytes."""
    yield _draw(cleaned, query, "svg")


def write_png(cleaned: CleanedTracks, query: TrackAnswerQuery) -> Iterator[bytes]:
    """Picture as PNG."""
    yield _draw(cleaned, query, "png")


def _draw(cleaned: CleanedTracks, query: TrackAnswerQuery, file_format: FigureFormat) -> bytes:
    # Matplotlib takes longer to import than the whole service; who asks for no picture does not wait for it.
    from estimators.adapters.plotting import render  # noqa: PLC0415

    (only,) = cleaned.tracks
    if isinstance(only.answer, NoFit):
        raise no_track(only.answer)
    figure = only.answer.plot(
        query.figure,
        width_px=query.width_px,
        height_px=query.height_px,
        theme=query.theme,
        title=query.title,
    )
    return render(figure, file_format)
