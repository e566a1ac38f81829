"""Times of fixes in JSON: moments, the form that they came in, and the zone of each."""

from __future__ import annotations

import msgspec
import numpy as np

from estimators.adapters.tracks.moments import parse_moments
from estimators.adapters.tracks.recording import Offsets
from estimators.adapters.tracks.times import unit_of
from service.codecs.columns import TimeForm, Times
from service.codecs.json import decode_column, read_times
from service.errors import invalid_value
from service.schemas.fields import TimeUnit

_TEXTS = msgspec.json.Decoder(list[str | None])

#: What a track so far has, by the kind of its times.
_WORDS = {"iso": "ISO 8601 times", "number": "plain numbers", "epoch": "numbers since 1970"}


def read_clock(raw: msgspec.Raw, unit: TimeUnit | None) -> tuple[Times, TimeForm, Offsets | None]:
    """Read times, the form they came in, and minutes east of UTC where they were written with a zone.

    Parameters
    ----------
    raw : Raw
    unit : {"s", "ms", "us", "ns"} or None
        Of numbers since 1970; None: units finer than the second are told by the size of the numbers.

    Raises
    ------
    Problem
        422 if an entry is no time, or times are text and have a unit.
    """
    time, form = read_times(raw, "time", unit)
    if form.kind == "iso":
        return time, form, parse_moments(decode_column(_TEXTS, raw, "time"))[1]
    if form.kind == "number" and (told := unit_of(time.astype(np.float64))) is not None:
        time, form = read_times(raw, "time", told)
    return time, form, None


def read_clock_on(
    raw: msgspec.Raw, unit: TimeUnit | None, known: TimeForm
) -> tuple[Times, TimeForm, Offsets | None]:
    """Read times that go on with a track, in the form that its times have had so far.

    Raises
    ------
    Problem
        As :func:`read_clock`, and if they come in another form.
    """
    if unit is not None and unit != known.unit:
        raise invalid_value("time_unit", _another(known))
    time, form = read_times(raw, "time", None, known)
    if not np.isnan(time).all() and (form.kind == "iso") is not (known.kind == "iso"):
        raise invalid_value("time", _another(known))
    if known.kind == "iso":
        return time, known, parse_moments(decode_column(_TEXTS, raw, "time"))[1]
    return read_times(raw, "time", known.unit)[0], known, None


def _another(known: TimeForm) -> str:
    unit = "" if known.unit is None else f" in {known.unit!r}"
    return f"the track so far has {_WORDS[known.kind]}{unit}; send those, or begin anew without a state"
