"""The state of a live track on the wire: the library's, and how its times were written.

The library keeps moments; answers repeat times in the form and the zone in which each came. So a state
carries the form of the track's times and the zones of the rows that are not settled yet, in front of the
library's own state, and a digest against damage over all of it. It is text without blanks that needs no
escape in JSON, and holds no secret.
"""

from __future__ import annotations

import base64
import hashlib
from dataclasses import dataclass, field

import numpy as np

from estimators.adapters.tracks.recording import Offsets
from estimators.trajectories.live.stream import LAGS
from estimators.trajectories.live.token import LONGEST_TOKEN
from service.codecs.columns import UNIT_NANOSECONDS, TimeForm
from service.errors import Problem, invalid_value

LONGEST_STATE = LONGEST_TOKEN
_NAME, _VERSION = "plumbline", "1"
_SEAL_BYTES = 12
_DAY_MINUTES = 24 * 60
_FORMS: dict[str, TimeForm | None] = {
    "none": None,
    "number": TimeForm("number"),
    "iso": TimeForm("iso"),
    **{unit: TimeForm("epoch", unit) for unit in UNIT_NANOSECONDS},
}


@dataclass(frozen=True, slots=True)
class LiveState:
    """What a call needs of those before it.

    Attributes
    ----------
    track : str or None
        State of the library; None begins a track.
    form : TimeForm or None
        Of all times so far; None before the first.
    waiting : ndarray of int16
        Minutes east of UTC of the rows that are not settled, in the order in which they were sent.
    """

    track: str | None = None
    form: TimeForm | None = None
    waiting: Offsets = field(default_factory=lambda: np.zeros(0, dtype=np.int16))


def write_state(state: LiveState) -> str:
    """Write a state that begins with a track's.

    Examples
    --------
    >>> write_state(LiveState("abc", TimeForm("iso"), np.array([120, 120], dtype=np.int16)))
    'plumbline.1.iso.eAB4AA==.h2DwRyO5d60UEtRv.abc'
    """
    form = next(name for name, known in _FORMS.items() if known == state.form)
    # Where all are UTC nothing is written: tracks without zones have short states.
    zones = _text(state.waiting.astype("<i2").tobytes()) if state.waiting.any() else str(state.waiting.size)
    return ".".join([_NAME, _VERSION, form, zones, _seal(form, zones, state.track or ""), state.track or ""])


def read_state(text: str) -> LiveState:
    """Read a state; what its track holds is the library's to check.

    Raises
    ------
    Problem
        422 if it is too long, damaged, of another version or none of ours. It is not repeated.
    """
    if len(text) > LONGEST_STATE:
        raise refused_state(f"is longer than {LONGEST_STATE} characters, and none of ours")
    parts = text.split(".")
    if len(parts) < 2 or parts[0] != _NAME:
        raise refused_state("is none that this service gave back")
    if parts[1] != _VERSION:
        raise refused_state(f"is of another version than {_VERSION}, which this service writes")
    if len(parts) != 6 or parts[4] != _seal(parts[2], parts[3], parts[5]):
        raise refused_state("is damaged")
    form, waiting = parts[2], _zones(parts[3])
    if form not in _FORMS or waiting is None or waiting.size > LAGS[1]:
        raise refused_state("is damaged")
    return LiveState(parts[5], _FORMS[form], waiting)


def refused_state(why: str) -> Problem:
    """Problem of a state."""
    return invalid_value(
        "state", f"{why}; send back the state of the last answer, or none to begin a new track"
    )


def _zones(text: str) -> Offsets | None:
    """Minutes east of UTC; None where the text is none of ours."""
    if text.isascii() and text.isdigit() and len(text) <= 3:
        return np.zeros(int(text), dtype=np.int16)
    try:
        minutes = np.frombuffer(base64.b64decode(text, altchars=b"-_", validate=True), dtype="<i2")
    except ValueError:
        return None
    return minutes.astype(np.int16) if (np.abs(minutes.astype(np.int64)) < _DAY_MINUTES).all() else None


def _seal(*parts: str) -> str:
    return _text(hashlib.blake2b(".".join(parts).encode(), digest_size=_SEAL_BYTES).digest())


def _text(content: bytes) -> str:
    return base64.urlsafe_b64encode(content).decode("ascii")
