"""Answers about tracks as files that other programs read, by the writers of the library."""

from __future__ import annotations

from collections.abc import Iterator

from estimators.adapters.tracks import write_csv as csv_pieces
from estimators.adapters.tracks import write_geojson as geojson_pieces
from estimators.adapters.tracks import write_gpx as gpx_pieces
from service.codecs.trajectories.rows import cleaned_rows
from service.schemas.trajectories import TrackAnswerQuery
from service.trajectories.cleaned import CleanedTracks


def write_geojson(cleaned: CleanedTracks, query: TrackAnswerQuery) -> Iterator[bytes]:
    """Lines of the tracks, or a point per row (RFC 7946)."""
    points = query.points is True
    return geojson_pieces(cleaned.recorded.as_written(), cleaned_rows(cleaned), points=points)


def write_gpx(cleaned: CleanedTracks, _query: TrackAnswerQuery) -> Iterator[bytes]:
    """GPX 1.1, a track for each device; labels are extensions of its points."""
    return gpx_pieces(cleaned.recorded.recording, cleaned_rows(cleaned))


def write_csv(cleaned: CleanedTracks, _query: TrackAnswerQuery) -> Iterator[bytes]:
    """One line per row in the order they came; empty is null."""
    return csv_pieces(cleaned.recorded.as_written(), cleaned_rows(cleaned))
