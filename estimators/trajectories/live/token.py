"""The state of a live track as text: a fixed layout of numbers, and a digest against damage.

Nothing in it is executed or allocated by what it says before it has been checked: its size is bounded, the
number of fixes follows from its length, and every number has to lie in its range.
"""

from __future__ import annotations

import base64
import binascii
import hashlib
import itertools
import math
import struct
from dataclasses import replace
from typing import Final

import numpy as np

from estimators.arrays import LARGEST_TIME, InputError
from estimators.trajectories.columns import HEIGHT_M
from estimators.trajectories.live.stream import LAGS, MOST_HELD, Fix, Settings, Stream, TimeKind
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.parameters import Rates, TrackParameters
from estimators.trajectories.rows import LONGEST_S

LONGEST_TOKEN = 32_768
_MAGIC: Final = b"plmb-live"
_VERSION = 1
_DIGEST = 16
_KINDS: tuple[TimeKind, ...] = ("none", "number", "datetime")
_HEAD = struct.Struct("<9sB BHHH QQ dd d dddddd")
_COLUMNS = [("place", "<f8", 2), ("short", "<f4", 2), ("good", "u1")]
_ROWS = {
    "number": np.dtype([("row", "<u8"), ("stamp", "<f8"), *_COLUMNS]),
    "datetime": np.dtype([("row", "<u8"), ("stamp", "<i8"), *_COLUMNS]),
}
_OPEN = 2
"""What stands in place of a flag for a fix that is not settled."""
_RATES = ("spike", "entry", "level")
_MOST_ROWS = 2**62
"""Rows of a stream."""


def encode(stream: Stream) -> str:
    """Write a state.

    Parameters
    ----------
    stream : Stream
    """
    settings, parameters = stream.settings, stream.parameters
    head = _HEAD.pack(
        _MAGIC,
        _VERSION,
        _KINDS.index(stream.kind),
        settings.lag,
        stream.late,
        stream.settled,
        stream.received,
        stream.taken,
        math.nan if settings.sigma_m is None else settings.sigma_m,
        math.nan if settings.max_speed_mps is None else settings.max_speed_mps,
        stream.typical_accuracy,
        parameters.sigma,
        parameters.colour_m,
        parameters.manoeuvre,
        *(getattr(parameters.rates, name) for name in _RATES),
    )
    rows = np.zeros(len(stream.held), dtype=_ROWS["datetime" if stream.kind == "datetime" else "number"])
    if stream.held:
        columns = list(zip(*stream.held, strict=True))
        rows["row"], rows["stamp"] = columns[0], columns[1]
        rows["place"], rows["short"] = np.transpose(columns[2:4]), np.transpose(columns[4:6])
        rows["good"] = [*stream.good, *[_OPEN] * stream.open]
    content = head + rows.tobytes()
    return base64.urlsafe_b64encode(content + _digest(content)).decode("ascii")


def decode(state: str | bytes) -> Stream:
    """Read a state.

    Parameters
    ----------
    state : str or bytes

    Raises
    ------
    InputError
        If it is none of ours, of another version, damaged or not consistent.
    """
    content = _content(state)
    if len(content) < _HEAD.size or not content.startswith(_MAGIC):
        raise _refused("is not one that clean_live gave back")
    head = _HEAD.unpack_from(content)
    if head[1] != _VERSION:
        raise _refused(f"is of version {head[1]}, this is version {_VERSION}")
    _, _, kind, lag, late, settled, received, taken, sigma_m, max_speed, typical, *numbers = head
    if kind >= len(_KINDS) or not LAGS[0] <= lag <= LAGS[1]:
        raise _inconsistent()
    layout = _ROWS["datetime" if _KINDS[kind] == "datetime" else "number"]
    length = len(content) - _HEAD.size
    if length % layout.itemsize or length > MOST_HELD * layout.itemsize:
        raise _inconsistent()
    rows = np.frombuffer(content, dtype=layout, offset=_HEAD.size)
    if not _are_sound(rows, settled, lag, received) or (rows.size and kind == 0):
        raise _inconsistent()
    if not taken <= received <= _MOST_ROWS or not (math.isnan(typical) or 0.0 < typical < math.inf):
        raise _inconsistent()
    held = [
        Fix(int(row["row"]), row["stamp"].item(), *row["place"].tolist(), *row["short"].tolist())
        for row in rows
    ]
    good = (rows["good"][:settled] == 1).tolist()
    stream = Stream(
        _settings(lag, sigma_m, max_speed),
        _KINDS[kind],
        received,
        taken,
        late,
        held,
        settled,
        good,
        _parameters(numbers),
        typical,
    )
    if held and stream.seconds_between(held[0], held[-1]) > LONGEST_S:
        raise _inconsistent()
    return stream


def _content(state: str | bytes) -> bytes:
    """Bytes of a state without its digest."""
    if not isinstance(state, (str, bytes)):
        raise _refused("must be text, as clean_live gave it back")
    if len(state) > LONGEST_TOKEN:
        raise _refused(f"is longer than {LONGEST_TOKEN} characters, and none of ours")
    try:
        text = state.encode("ascii") if isinstance(state, str) else state
        content = base64.b64decode(text, altchars=b"-_", validate=True)
    except (UnicodeEncodeError, binascii.Error) as error:
        raise _refused("is not base64, as clean_live gave it back") from error
    content, digest = content[:-_DIGEST], content[-_DIGEST:]
    if digest != _digest(content):
        raise _refused("is damaged")
    return content


def _digest(content: bytes) -> bytes:
    return hashlib.blake2b(content, digest_size=_DIGEST).digest()


def _are_sound(rows: np.ndarray, settled: int, lag: int, received: int) -> bool:
    """Whether the fixes held are some that a track of ours can hold."""
    if settled > rows.size or rows.size - settled > lag:
        return False
    stamps = rows["stamp"].tolist()
    places, shorts = rows["place"], rows["short"]
    return bool(
        (rows["row"] < received).all()
        and np.isfinite(rows["stamp"]).all()
        and all(earlier <= later for earlier, later in itertools.pairwise(stamps))
        and all(abs(stamp) <= LARGEST_TIME for stamp in stamps)
        and not (np.abs(places[:, 0]) > 90.0).any()
        and not (np.abs(places[:, 1]) > 360.0).any()
        and not (np.abs(shorts) > HEIGHT_M).any()
        and (rows["good"][:settled] < _OPEN).all()
        and (rows["good"][settled:] == _OPEN).all()
    )


def _settings(lag: int, sigma_m: float, max_speed: float) -> Settings:
    try:
        options = TrackOptions(
            None if math.isnan(sigma_m) else sigma_m, None if math.isnan(max_speed) else max_speed
        )
    except InputError as error:
        raise _inconsistent() from error
    return Settings(lag, options.sigma_m, options.max_speed_mps)


def _parameters(numbers: list[float]) -> TrackParameters:
    """Noise, motion and rates, if they can be such."""
    noise, rates = numbers[:3], numbers[3:]
    if not (all(1e-12 < number < 1e12 for number in noise) and all(0.0 < rate <= 0.5 for rate in rates)):
        raise _inconsistent()
    changed = replace(Rates(), **dict(zip(_RATES, rates, strict=True)))
    return TrackParameters(noise[0], noise[1], noise[2], changed)


def _refused(why: str) -> InputError:
    return InputError("state", f"{why}; send back the last answer's state, or none to begin a new track")


def _inconsistent() -> InputError:
    return _refused("holds numbers that no track of ours has")
