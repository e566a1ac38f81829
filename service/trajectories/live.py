"""The next rows of a live track, cleaned by the library; what is kept between calls goes to the caller."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from estimators import InputError, LiveRows, LiveTrack, TrackOptions, clean_live
from estimators.adapters.tracks.recording import Offsets
from estimators.trajectories.live.answer import joined
from service.codecs.columns import TimeForm, Times
from service.errors import invalid_value
from service.schemas.live_tracks import LiveArguments
from service.trajectories.cleaned import WIRE_NAMES
from service.trajectories.live_state import LiveState, refused_state, write_state

#: Rows that are cleaned between two looks at whether somebody still waits: a second or less. What settled
#: rows say does not depend on how they are cut.
PIECE_ROWS = 256

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class LiveFixes:
    """Rows of a call, and the track that they go on with.

    Attributes
    ----------
    state : LiveState
        Its ``form`` is that of these rows' times too, if one of them has a time.
    time, lat, lon : ndarray, shape (n,)
    offsets : ndarray of int16, shape (n,)
        Minutes east of UTC in which each time was written.
    measured : dict of str to ndarray, shape (n,)
        Other columns by their names in :func:`estimators.clean_live`.
    """

    state: LiveState
    time: Times
    lat: Floats
    lon: Floats
    offsets: Offsets
    measured: dict[str, Floats]


@dataclass(frozen=True, slots=True)
class LiveCleaned:
    """An answer before it is written.

    Attributes
    ----------
    answer : LiveTrack
        Its state is that of the wire.
    form : TimeForm or None
        Of its times; None before the first row with one.
    settled_offsets, provisional_offsets : ndarray of int16
        Minutes east of UTC in which the time of each row was written.
    """

    answer: LiveTrack
    form: TimeForm | None
    settled_offsets: Offsets
    provisional_offsets: Offsets


def clean_more(fixes: LiveFixes, arguments: LiveArguments, check: Callable[[], object]) -> LiveCleaned:
    """Clean the next rows of a track.

    Parameters
    ----------
    fixes : LiveFixes
    arguments : LiveArguments
    check : callable
        Called between pieces; it may raise to end the work.

    Raises
    ------
    Problem
        422 if the state is none of ours, or an argument is not that with which the track began.
    """
    track, pieces, n = fixes.state.track, [], fixes.time.size
    options = None
    if arguments.sigma_m is not None or arguments.max_speed_mps is not None:
        options = TrackOptions(sigma_m=arguments.sigma_m, max_speed_mps=arguments.max_speed_mps)
    for first in range(0, max(n, 1), PIECE_ROWS):
        check()
        part = slice(first, first + PIECE_ROWS)
        try:
            found = clean_live(
                fixes.time[part],
                fixes.lat[part],
                fixes.lon[part],
                **{name: column[part] for name, column in fixes.measured.items()},
                state=track,
                lag=arguments.lag,
                finish=arguments.finish and first + PIECE_ROWS >= n,
                options=options,
            )
        except InputError as error:
            raise invalid_value(WIRE_NAMES.get(error.field, error.field), error.message) from error
        pieces.append(found.settled)
        track = found.state
    form = fixes.state.form
    settled = joined([_timed(rows, form) for rows in pieces])
    waiting = _timed(found.provisional, form)
    # Every row that waited before, and every row of this call, is settled now or waits.
    numbers = np.sort(np.concatenate([settled.row, waiting.row]))
    offsets = np.concatenate([fixes.state.waiting, fixes.offsets])
    if numbers.size != offsets.size:
        raise refused_state("is damaged")
    settled_offsets = offsets[np.searchsorted(numbers, settled.row)]
    waiting_offsets = offsets[np.searchsorted(numbers, waiting.row)]
    state = write_state(LiveState(track, form, waiting_offsets[np.argsort(waiting.row)]))
    return LiveCleaned(
        LiveTrack(settled, waiting, found.noise, state), form, settled_offsets, waiting_offsets
    )


def _timed(rows: LiveRows, form: TimeForm | None) -> LiveRows:
    """Rows with times of the track's kind; those before its first time have none of any kind."""
    of_moments = form is not None and form.kind != "number"
    if (rows.time.dtype.kind == "M") is of_moments:
        return rows
    if not np.isnan(rows.time).all():
        raise refused_state("is damaged")
    missing = np.full(len(rows), "NaT", dtype="datetime64[ns]") if of_moments else np.full(len(rows), np.nan)
    return replace(rows, time=missing)
