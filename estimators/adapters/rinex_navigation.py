"""Navigation files of RINEX 2 and 3 (RINEX 3.05, tables A5 to A16; RINEX 2.11, tables A3 and A10).

Records are read by position; one that is incomplete, impossible or of a message that is not used is passed
over, and only a file without any usable record is refused.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from estimators.adapters.rinex_text import MOST_BYTES, Source, read_text
from estimators.arrays import InputError
from estimators.gnss.calendar import BEIDOU_BEHIND_S, GPS_EPOCH, WEEK_NS, WEEK_S, utc_to_gps
from estimators.gnss.carriers import CARRIERS_HZ
from estimators.gnss.corrections.klobuchar import Klobuchar
from estimators.gnss.orbits.broadcast import Navigation
from estimators.gnss.orbits.ephemerides import Ephemeris, stack_ephemerides
from estimators.gnss.orbits.kepler import COLUMNS

FIELD = "navigation"
_WIDTH = 19
_MOST_RECORDS = 1_000_000
_GM = {"G": 3.9860050e14, "J": 3.9860050e14, "E": 3.986004418e14, "C": 3.986004418e14}
"""IS-GPS-200, table 20-IV; Galileo OS SIS ICD, 5.1.1; BeiDou ICD, 3.2."""
_EARTH_TURN = {"G": 7.2921151467e-5, "J": 7.2921151467e-5, "E": 7.2921151467e-5, "C": 7.2921150e-5}
_BEIDOU_GEOSTATIONARY = {*range(1, 6), *range(59, 64)}
"""Satellite numbers of geostationary satellites (BeiDou ICD, B1I 3.0, table 4-1)."""
_ROOT_OF_AXIS = (4500.0, 7000.0)
_LARGEST_ECCENTRICITY = 0.5
_GLONASS_RADIUS_M = (24e6, 27e6)
_CLOCK_LIMITS = np.array([0.1, 1e-6, 1e-9])
_ORBIT_LIMITS = np.array(
    [
        *(1e4, 1e-6, 10.0, 0.01, _LARGEST_ECCENTRICITY, 0.01, _ROOT_OF_AXIS[1], WEEK_S),
        *(0.01, 10.0, 0.01, 10.0, 1e4, 10.0, 1e-6, 1e-6),
    ]
)
"""Magnitudes that the fields of messages cannot reach, in the order of the file from crs on (IS-GPS-200,
tables 20-I and 20-III; those of the others are alike)."""
_GLONASS_LIMITS = np.array([1e4, 1e4, 1e4, 1e-3, 1e-3, 1e-3, _CLOCK_LIMITS[0], _CLOCK_LIMITS[1]])
_LARGEST_DELAY_S = 1e-6
_GALILEO_INAV, _GALILEO_FNAV_CLOCK, _GALILEO_INAV_CLOCK = 0b101, 1 << 8, 1 << 9
_GALILEO_E1_E5B_HEALTH = 0b111000111
_URA_BOUNDS_M = np.array([2.4, 3.4, 4.85, 6.85, 9.65, 13.65, 24.0, 48.0, 96.0, 192.0, 384.0])
"""A file gives the nominal value of an interval; its upper bound counts (IS-GPS-200, 20.3.3.3.1.3)."""
_WORST_ACCURACY_M = 300.0
"""From here on a satellite is not to be used, like one that does not state its accuracy."""
_GLONASS_ACCURACY_M = 5.0
"""GLONASS messages in files rarely state it; RTKLIB's value."""
_QZSS_HEALTH = 0xFE
"""All but the bit of the L6 signal (IS-QZSS-PNT, table 4.1.2-5)."""


def read_navigation(navigation: Source | Sequence[Source], most_bytes: int = MOST_BYTES) -> Navigation:
    """Read broadcast ephemerides and ionosphere from RINEX navigation files.

    Parameters
    ----------
    navigation : bytes, Path or sequence of these
        RINEX 2 or 3, plain or gzip. Several files are taken together.
    most_bytes : int
        Unpacked size of all files together above which they are refused.

    Raises
    ------
    InputError
        If a file is no navigation file, or has no usable ephemeris.
    """
    files = [navigation] if isinstance(navigation, (bytes, Path)) else list(navigation)
    if not files:
        raise InputError(FIELD, "expected at least one navigation file")
    ephemerides: list[Ephemeris] = []
    models: dict[str, Klobuchar] = {}
    room = most_bytes
    for file in files:
        text = read_text(file, FIELD, room)
        room -= len(text)
        lines = text.split("\n")
        version, system = _version(lines[0])
        end = _header_end(lines)
        for letter, model in _ionosphere(lines[:end]).items():
            models.setdefault(letter, model)
        ephemerides.extend(_records(lines[end + 1 :], version, system))
        if len(ephemerides) > _MOST_RECORDS:
            raise InputError(
                FIELD, f"has more than {_MOST_RECORDS} ephemerides; send those of the days observed"
            )
    if not ephemerides:
        raise InputError(
            FIELD, "has no usable ephemeris of GPS, GLONASS, Galileo, BeiDou or QZSS; is the file complete?"
        )
    chosen = next((models[letter] for letter in "GJC" if letter in models), None)
    return Navigation(stack_ephemerides(ephemerides, COLUMNS), chosen)


def _version(first: str) -> tuple[int, str]:
    """Major version and, of version 2, the system letter."""
    label = first[60:].strip()
    if label.startswith("CRINEX"):
        raise InputError(FIELD, "is a compressed observation file; send it as observations")
    if label != "RINEX VERSION / TYPE":
        raise InputError(FIELD, "does not begin with 'RINEX VERSION / TYPE'; send a RINEX navigation file")
    kind = first[20:21].upper()
    if kind == "O":
        raise InputError(FIELD, "is an observation file; send the navigation file here")
    try:
        major = int(float(first[:9]))
    except (ValueError, OverflowError):
        major = 0
    if major not in {2, 3}:
        raise InputError(FIELD, f"has RINEX version {first[:9].strip()!r}; send version 2 or 3")
    if kind not in "NG" or (major == 3 and kind != "N"):
        raise InputError(FIELD, f"is a RINEX file of type {kind!r}; send a navigation file")
    return major, "R" if kind == "G" else "G"


def _header_end(lines: list[str]) -> int:
    for i, line in enumerate(lines):
        if line[60:].strip() == "END OF HEADER":
            return i
    raise InputError(FIELD, "has no END OF HEADER; the file is incomplete")


def _ionosphere(header: list[str]) -> dict[str, Klobuchar]:
    rows: dict[str, list[float]] = {}
    for line in header:
        label = line[60:].strip()
        if label == "IONOSPHERIC CORR":
            rows[line[:4].strip()] = [_number(line[5 + 12 * k : 17 + 12 * k]) for k in range(4)]
        elif label in {"ION ALPHA", "ION BETA"}:
            rows["GPSA" if label == "ION ALPHA" else "GPSB"] = [
                _number(line[2 + 12 * k : 14 + 12 * k]) for k in range(4)
            ]
    found = {}
    for letter, name in (("G", "GPS"), ("J", "QZS"), ("C", "BDS")):
        alpha, beta = rows.get(f"{name}A"), rows.get(f"{name}B")
        # A header without numbers, or with zeros, says that the receiver had not heard them yet.
        if alpha and beta and np.all(np.abs([*alpha, *beta]) < 1e8) and any(alpha):
            found[letter] = Klobuchar(
                (alpha[0], alpha[1], alpha[2], alpha[3]), (beta[0], beta[1], beta[2], beta[3])
            )
    return found


def _records(lines: list[str], version: int, system: str) -> Iterator[Ephemeris]:
    begins = re.compile(r"[A-Z][ \d]\d " if version == 3 else r"[ \d]\d [ \d]\d")
    starts = [i for i, line in enumerate(lines) if begins.match(line)]
    for a, b in itertools.pairwise([*starts, len(lines)]):
        record = _record(lines[a:b], version, system)
        if record is not None:
            yield record


def _record(block: list[str], version: int, system: str) -> Ephemeris | None:
    first = block[0]
    indent = 4 if version == 3 else 3
    letter = first[0] if version == 3 else system
    number = first[1:3] if version == 3 else first[:2]
    if letter not in "GRECJ" or not number.strip().isdecimal():
        return None
    epoch = _epoch(first[4:23] if version == 3 else first[3:22], version)
    values = [_number(first[indent + 19 * k : indent + 19 * (k + 1)]) for k in (1, 2, 3)]
    for line in block[1:8]:
        values += [_number(line[indent + _WIDTH * k : indent + _WIDTH * (k + 1)]) for k in range(4)]
    name = f"{letter}{int(number):02d}"
    if epoch is None:
        return None
    return _glonass(name, epoch, values) if letter == "R" else _kepler(name, epoch, values)


def _number(text: str) -> float:
    """Read a number of Fortran; a blank, as in spare fields, is 0."""
    stripped = text.strip()
    if not stripped:
        return 0.0
    try:
        return float(stripped.replace("D", "E").replace("d", "e"))
    except ValueError:
        return math.nan


def _epoch(text: str, version: int) -> np.datetime64 | None:
    parts = text.split()
    if len(parts) != 6:
        return None
    try:
        year, month, day, hour, minute = (int(part) for part in parts[:5])
        seconds = float(parts[5])
    except ValueError:
        return None
    if version == 2:
        year += 1900 if year >= 80 else 2000
    if not (1980 <= year < 2100 and 0 <= hour < 24 and 0 <= minute < 60 and 0.0 <= seconds < 61.0):
        return None
    try:
        date = np.datetime64(f"{year:04d}-{month:02d}-{day:02d}", "ns")
    except ValueError:
        return None
    return date + np.timedelta64(round((hour * 3600 + minute * 60 + seconds) * 1e9), "ns")


def _glonass(name: str, epoch: np.datetime64, v: list[float]) -> Ephemeris | None:
    if len(v) < 15 or not np.isfinite(v[:15]).all():
        return None
    bias, gamma = v[0], v[1]
    position, velocity, acceleration = ([1e3 * v[3 + k + 4 * axis] for axis in range(3)] for k in range(3))
    health, channel = v[6], round(v[10])
    if np.any(np.abs([*velocity, *acceleration, bias, gamma]) > _GLONASS_LIMITS):
        return None
    if not _GLONASS_RADIUS_M[0] < math.hypot(*position) < _GLONASS_RADIUS_M[1]:
        return None
    toe = int((utc_to_gps(np.array([epoch]))[0] - GPS_EPOCH).astype(np.int64))
    delays = {1: 0.0, 2: v[16] if len(v) > 16 and abs(v[16]) < _LARGEST_DELAY_S else 0.0}
    elements = (*position, *velocity, *acceleration, bias, gamma)
    return Ephemeris(name, toe, toe, elements, health == 0.0, _GLONASS_ACCURACY_M, delays, channel)


def _kepler(name: str, epoch: np.datetime64, v: list[float]) -> Ephemeris | None:
    if len(v) < 29 or not np.isfinite(v[:29]).all():
        return None
    letter = name[0]
    af0, af1, af2, _, crs, delta_n, m0, cuc, e, cus, sqrt_a, toe, cic, omega0, cis, i0, crc, omega = v[:18]
    omega_dot, i_dot, sources = v[18], v[19], int(v[20])
    possible = (
        np.all(np.abs(v[:3]) <= _CLOCK_LIMITS)
        and np.all(np.abs(v[4:20]) <= _ORBIT_LIMITS)
        and np.all(np.abs(v[25 : 27 if letter in "EC" else 26]) <= _LARGEST_DELAY_S)
    )
    if not (possible and e >= 0.0 and sqrt_a > _ROOT_OF_AXIS[0] and toe >= 0.0):
        return None
    if letter == "E" and not _is_inav(sources):
        return None
    toc = int((epoch - GPS_EPOCH).astype(np.int64))
    # The orbit's week: that which brings its time nearest to the clock's; week numbers in files roll over.
    behind = (round(toe * 1e9) - toc % WEEK_NS + WEEK_NS // 2) % WEEK_NS - WEEK_NS // 2
    shift = BEIDOU_BEHIND_S * 1_000_000_000 if letter == "C" else 0
    still = 1.0 if letter == "C" and int(name[1:]) in _BEIDOU_GEOSTATIONARY else 0.0
    elements = (
        *(sqrt_a, e, m0, delta_n, omega0, i0, omega, omega_dot, i_dot),
        *(cuc, cus, crc, crs, cic, cis, toe, af0, af1, af2),
        *(_GM[letter], _EARTH_TURN[letter], still),
    )
    health, accuracy = int(v[24]), v[23]
    if letter != "E" and accuracy >= 0.0:
        place = int(np.searchsorted(_URA_BOUNDS_M, accuracy))
        accuracy = float(_URA_BOUNDS_M[min(place, _URA_BOUNDS_M.size - 1)])
    mask = {"E": _GALILEO_E1_E5B_HEALTH, "J": _QZSS_HEALTH}.get(letter, -1)
    return Ephemeris(
        name,
        toc + behind + shift,
        toc + shift,
        elements,
        health & mask == 0 and 0.0 <= accuracy < _WORST_ACCURACY_M,
        accuracy,
        _delays(letter, v[25], v[26]),
    )


def _is_inav(sources: int) -> bool:
    """Whether a message of Galileo is I/NAV, whose clock serves E1 with E5b; files that do not say are."""
    if sources & 0b111 == 0:
        return True
    clock_is_other = sources & _GALILEO_FNAV_CLOCK and not sources & _GALILEO_INAV_CLOCK
    return bool(sources & _GALILEO_INAV) and not clock_is_other


def _delays(letter: str, first: float, second: float) -> dict[int, float]:
    """Group delay by band, against the clock of the message.

    GPS and QZSS: TGD, scaled to L2 by the squared ratio of carriers (IS-GPS-200, 20.3.3.3.3.2). Galileo: BGD
    of E1 with E5b; E5a from that of E1 with E5a (OS SIS ICD, 5.1.5). BeiDou: TGD1 and TGD2 against B3I.
    """
    if letter == "C":
        return {2: first, 7: second, 6: 0.0}
    ratio = {band: (CARRIERS_HZ[letter]["1"] / hertz) ** 2 for band, hertz in CARRIERS_HZ[letter].items()}
    if letter == "E":
        return {1: second, 7: ratio["7"] * second, 5: second + (ratio["5"] - 1.0) * first}
    return {1: first, 2: ratio["2"] * first}
