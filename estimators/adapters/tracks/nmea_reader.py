"""NMEA 0183 logs to a :class:`Recording`: sentences of the same moment become one row.

RMC brings date, speed and course, GGA height, satellites and dilution, GST the error ellipse, VTG speed and
course where RMC has none, ZDA the date, GLL a position. The address of a talker (GP, GN, GL, GA, GB, ...)
does not matter; where several tell the same moment, the first does. Loggers put words before the sentence,
or numbers after it.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Callable
from typing import IO

import numpy as np

from estimators.adapters.tracks.assembly import assemble
from estimators.adapters.tracks.recording import FIELD, Recording
from estimators.arrays import FloatArray, InputError
from estimators.trajectories.ellipse import RADIUS_68

SENTENCE = re.compile(
    r"\$(?P<body>[A-Z]{2}(?P<kind>RMC|GGA|GST|VTG|ZDA|GLL),[^*$\r\n]*)"
    r"(?:\*(?P<sum>[0-9A-Fa-f]{2}))?"
)
_CLOCK = re.compile(r"(\d\d)(\d\d)(\d\d(?:\.\d+)?)", re.ASCII)
_DATE = re.compile(r"(\d\d)(\d\d)(\d\d)", re.ASCII)
_ANGLE = re.compile(r"(\d{1,3})(\d\d(?:\.\d*)?)", re.ASCII)
_DECIMAL = re.compile(r"-?\d{1,15}(?:\.\d{0,15})?", re.ASCII)
_MPS_PER_KNOT = 1852.0 / 3600.0
_MPS_PER_KMH = 1.0 / 3.6
_DAY_NS = 86_400_000_000_000

Epoch = dict[str, float | int]


def read_nmea(stream: IO[bytes]) -> Recording:
    """Read a log of sentences.

    A sentence with a wrong checksum is left out and counted. Without any date, times are seconds of the
    first day.

    Raises
    ------
    InputError
        If no sentence with a time can be read.

    Examples
    --------
    >>> import io
    >>> log = b"$GPGGA,092750.000,5321.6802,N,00630.3372,W,1,8,1.03,61.7,M,55.2,M,,*76"
    >>> read_nmea(io.BytesIO(log)).height_m
    array([61.7])
    """
    epochs: list[Epoch] = []
    damaged = 0
    for line in io.TextIOWrapper(stream, encoding="latin-1"):
        match = SENTENCE.search(line)
        if match is None:
            continue
        if not _is_sound(match["body"], match["sum"]):
            damaged += 1
            continue
        fields = match["body"].split(",")
        _READERS[match["kind"]](fields, epochs)
    if not epochs:
        why = f"; {damaged} sentences have a wrong checksum" if damaged else ""
        raise InputError(FIELD, f"holds no RMC or GGA sentence with a time{why}")
    measured = {
        name: np.array([epoch.get(name, np.nan) for epoch in epochs], dtype=np.float64)
        for name in (
            *("height_m", "accuracy_m", "ellipse_major_m", "ellipse_minor_m", "ellipse_bearing_deg"),
            *("speed_mps", "bearing_deg", "hdop", "satellites"),
        )
    }
    return assemble(
        "nmea",
        time=_times(epochs),
        lat=np.array([epoch.get("lat", np.nan) for epoch in epochs]),
        lon=np.array([epoch.get("lon", np.nan) for epoch in epochs]),
        position_unreadable=np.array(["bad" in epoch for epoch in epochs], dtype=np.bool_),
        measured=measured,
        left_out=damaged,
    )


def _is_sound(body: str, checksum: str | None) -> bool:
    """Whether the exclusive or of all characters is the checksum; sentences need not have one."""
    if checksum is None:
        return True
    # Folded in halves as one integer, which takes a tenth of the time of a loop over characters.
    total, width = int.from_bytes(body.encode("latin-1"), "big"), len(body)
    while width > 1:
        half = (width + 1) // 2
        total = (total >> (8 * half)) ^ (total & ((1 << (8 * half)) - 1))
        width = half
    return total == int(checksum, 16)


def _epoch_at(text: str, epochs: list[Epoch]) -> Epoch | None:
    """Find the row of a moment of the day: the last one, or a new one where the time has changed."""
    match = _CLOCK.fullmatch(text)
    if match is None:
        return None
    nanoseconds = (int(match[1]) * 3600 + int(match[2]) * 60) * 10**9 + round(float(match[3]) * 1e9)
    if nanoseconds > _DAY_NS:
        return None
    if not epochs or epochs[-1]["clock"] != nanoseconds:
        epochs.append({"clock": nanoseconds})
    return epochs[-1]


def _numbers(epoch: Epoch, cells: list[str], wanted: dict[str, tuple[int, float]]) -> None:
    """Fill columns from fields by their place and unit; what is there already stays."""
    for name, (place, unit) in wanted.items():
        if name not in epoch and place < len(cells) and cells[place]:
            text = cells[place]
            if _DECIMAL.fullmatch(text):
                epoch[name] = float(text) * unit


def _position(epoch: Epoch, cells: list[str]) -> None:
    """Latitude, N or S, longitude, E or W, as degrees and minutes in one number."""
    if "lat" in epoch or len(cells) < 4 or not any(cells):
        return
    lat, lon = _degrees(cells[0], cells[1], "NS"), _degrees(cells[2], cells[3], "EW")
    if lat is None or lon is None:
        epoch["bad"] = 1
    else:
        epoch["lat"], epoch["lon"] = lat, lon
        epoch.pop("bad", None)


def _degrees(text: str, side: str, sides: str) -> float | None:
    match = _ANGLE.fullmatch(text)
    if match is None or side not in sides or not side or float(match[2]) >= 60.0:
        return None
    value = int(match[1]) + float(match[2]) / 60.0
    return value if side == sides[0] else -value


def _read_rmc(cells: list[str], epochs: list[Epoch]) -> None:
    epoch = _epoch_at(cells[1], epochs)
    if epoch is None:
        return
    date = _DATE.fullmatch(cells[9]) if len(cells) > 9 else None
    if date is not None:
        # Two digits of a year: the Global Positioning System began in 1980.
        year = int(date[3]) + (1900 if int(date[3]) >= 80 else 2000)
        _set_date(epoch, year, int(date[2]), int(date[1]))
    if len(cells) > 2 and cells[2] == "A":
        _position(epoch, cells[3:7])
        _numbers(epoch, cells, {"speed_mps": (7, _MPS_PER_KNOT), "bearing_deg": (8, 1.0)})


def _read_gga(cells: list[str], epochs: list[Epoch]) -> None:
    epoch = _epoch_at(cells[1], epochs)
    if epoch is None or len(cells) < 7 or cells[6] in {"", "0"}:
        return
    _position(epoch, cells[2:6])
    _numbers(epoch, cells, {"satellites": (7, 1.0), "hdop": (8, 1.0), "height_m": (9, 1.0)})


def _read_gll(cells: list[str], epochs: list[Epoch]) -> None:
    epoch = _epoch_at(cells[5], epochs) if len(cells) > 5 else None
    if epoch is not None and (len(cells) < 7 or cells[6] == "A"):
        _position(epoch, cells[1:5])


def _read_gst(cells: list[str], epochs: list[Epoch]) -> None:
    epoch = _epoch_at(cells[1], epochs)
    if epoch is None:
        return
    places = {"ellipse_major_m": 3, "ellipse_minor_m": 4, "ellipse_bearing_deg": 5}
    _numbers(epoch, cells, {name: (place, 1.0) for name, place in places.items()})
    found: Epoch = {}
    _numbers(found, cells, {"north": (6, 1.0), "east": (7, 1.0)})
    if len(found) == 2 and "accuracy_m" not in epoch:
        epoch["accuracy_m"] = RADIUS_68 * math.sqrt((found["north"] ** 2 + found["east"] ** 2) / 2.0)


def _read_vtg(cells: list[str], epochs: list[Epoch]) -> None:
    """Course and speed have no time of their own: they belong to the moment that is being told."""
    if epochs and (len(cells) < 10 or cells[9] != "N"):
        _numbers(epochs[-1], cells, {"bearing_deg": (1, 1.0)})
        _numbers(epochs[-1], cells, {"speed_mps": (7, _MPS_PER_KMH)})


def _read_zda(cells: list[str], epochs: list[Epoch]) -> None:
    epoch = _epoch_at(cells[1], epochs)
    if epoch is not None and len(cells) > 4 and all(cell.isascii() and cell.isdigit() for cell in cells[2:5]):
        _set_date(epoch, int(cells[4][:4]), int(cells[3][:4]), int(cells[2][:4]))


def _set_date(epoch: Epoch, year: int, month: int, day: int) -> None:
    if not (1980 <= year <= 2200 and 1 <= month <= 12 and 1 <= day <= 31):
        return
    first = np.datetime64(f"{year:04d}-{month:02d}", "M")
    date = first.astype("datetime64[D]") + np.timedelta64(day - 1, "D")
    if date.astype("datetime64[M]") == first:
        epoch.setdefault("day", int(date.astype(np.int64)))


_READERS: dict[str, Callable[[list[str], list[Epoch]], None]] = {
    "RMC": _read_rmc,
    "GGA": _read_gga,
    "GLL": _read_gll,
    "GST": _read_gst,
    "VTG": _read_vtg,
    "ZDA": _read_zda,
}


def _times(epochs: list[Epoch]) -> np.ndarray[tuple[int], np.dtype[np.datetime64]] | FloatArray:
    """Days counted along the log: a clock that goes back by half a day has passed midnight."""
    clocks = np.array([epoch["clock"] for epoch in epochs], dtype=np.int64)
    jump = np.diff(clocks, prepend=clocks[0])
    passed = np.cumsum((jump < -_DAY_NS // 2).astype(np.int64) - (jump > _DAY_NS // 2))
    dated = [row for row, epoch in enumerate(epochs) if "day" in epoch]
    if not dated:
        return np.asarray((passed * _DAY_NS + clocks) / 1e9)
    # Rows between two dates count on from the earlier one, rows before the first count back from it.
    before = np.maximum(np.searchsorted(dated, np.arange(len(epochs)), side="right") - 1, 0)
    anchor = np.array(dated, dtype=np.int64)[before]
    day = np.array([epochs[row]["day"] for row in dated], dtype=np.int64)[before] + passed - passed[anchor]
    return np.asarray(day * _DAY_NS + clocks, dtype="datetime64[ns]")
