"""``plumbline clean`` into files of rows: cleaned and written piece by piece, however long the track is."""

from __future__ import annotations

from itertools import chain

from estimators import InputError, NoFit, TrackOptions
from estimators.adapters.tracks.cleaning import clean_recording
from estimators.adapters.tracks.streaming import STREAMS, row_order, stream_track
from service.cli.making import Made
from service.errors import invalid_value
from service.schemas.trajectories import TrackArguments
from service.trajectories.cleaned import WIRE_NAMES, no_track
from service.trajectories.recorded import Recorded


def is_of_rows(form: str, *, points: bool) -> bool:
    """Whether a format is written row by row; of GeoJSON that is so of points, not of lines."""
    return form in STREAMS and (form != "geojson" or points)


def clean_rows(recorded: Recorded, arguments: TrackArguments, form: str) -> Made:
    """Clean a recording as far as it takes to know which devices have a track; the rest follows in writing.

    Parameters
    ----------
    recorded : Recorded
    arguments : TrackArguments
    form : str
        For which :func:`is_of_rows`.

    Raises
    ------
    Problem
        If the library refuses a value, or the one track that was sent cannot be cleaned.
    OSError
        If the answer has to wait in a temporary file and that cannot be written.
    """
    recording = recorded.recording
    options = TrackOptions(sigma_m=arguments.sigma_m, max_speed_mps=arguments.max_speed_mps)
    cleaned = clean_recording(recording, method=arguments.method, level=arguments.level, options=options)
    pairs = cleaned.arranged(row_order(recording, form))
    try:
        first = next(pairs)
    except InputError as error:
        raise invalid_value(WIRE_NAMES.get(error.field, error.field), error.message) from error
    # Facts of one track that there is come with its last row, those of several before the first.
    known = list(cleaned.facts.items())
    refused = [(device, told) for device, told in known if isinstance(told, NoFit)]
    if refused and not recorded.is_many:
        raise no_track(refused[0][1])
    pieces = stream_track(
        recording, chain([first], pairs), form, epoch=recorded.form.unit, method=arguments.method
    )
    return Made(pieces, refused, has_track=len(refused) < max(len(known), 1))
