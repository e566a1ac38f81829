"""Observation files of RINEX 2 and 3 as columns, read by ``sidereon`` (extra ``[rinex]``).

The codes, Dopplers and signal strengths of every satellite and epoch; which of several codes on a band counts
is decided here, in the order of :data:`CODES`, and times become GPS time.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import sidereon

from estimators.adapters.rinex_text import MOST_BYTES, Source, read_text
from estimators.arrays import FloatArray, InputError, IntArray
from estimators.gnss.calendar import BEIDOU_BEHIND_S, TimeArray, utc_to_gps
from estimators.gnss.orbits.broadcast import Observations

FIELD = "observations"

CODES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "G": {"1": "CPYWMSLX", "2": "PYWCMDSLX"},
        "R": {"1": "CP", "2": "CP"},
        "E": {"1": "CABXZ", "7": "IQX", "5": "IQX"},
        "C": {"2": "IQX", "7": "IQX", "6": "IQXA"},
        "J": {"1": "CSLX", "2": "SLX"},
    }
)
"""Bands by system, the first for single-frequency positions; per band the tracking codes of RINEX 3 in order
of preference. Broadcast clocks and group delays hold for these signals."""

_SYSTEMS: Mapping[str, Any] = MappingProxyType(
    {
        "G": sidereon.GnssSystem.GPS,
        "R": sidereon.GnssSystem.GLONASS,
        "E": sidereon.GnssSystem.GALILEO,
        "C": sidereon.GnssSystem.BEIDOU,
        "J": sidereon.GnssSystem.QZSS,
    }
)
_OLD_BEIDOU = 3.02
"""The version in which BeiDou's B1 may be band 1; elsewhere it is 2 (RINEX 3.05, codes of BDS, notes)."""
_FAILURE = 2
"""Epoch flags from here on are events, not observations (RINEX 3.05, table A3)."""
_VALUE = 16
"""Characters that one value takes, unpacked."""
_HEADER = 200_000
"""Characters among which the header lies."""
_YEARS = (1980, 2100)
_EPOCHS_PER_CHECK = 256


def read_observations(
    source: Source,
    systems: str,
    bands: int,
    most_bytes: int = MOST_BYTES,
    check: Callable[[], object] | None = None,
) -> Observations:
    """Read an observation file.

    Parameters
    ----------
    source : bytes or Path
        RINEX 2 or 3; plain, gzip or Hatanaka-compressed.
    systems : str
        Letters to read.
    bands : int
        1 for the first band of every system, 2 or more for others too.
    most_bytes : int
        Unpacked size above which the file is refused.
    check : callable, optional
        Called now and then while a file is read; what it raises ends the reading.

    Raises
    ------
    InputError
        If it is no observation file, is damaged, or has no epoch.
    """
    product = _parsed(_unpacked(read_text(source, FIELD, most_bytes), most_bytes))
    header = product.header
    entries = [(_SYSTEMS[letter], _wanted(product, letter, bands)) for letter in systems]
    if not any(codes for _, codes in entries):
        raise InputError(FIELD, f"has no code of the systems asked for, {', '.join(systems)}")
    wanted = sidereon.ObservationFilter([(system, codes) for system, codes in entries if codes])
    times: list[np.datetime64] = []
    satellites: list[str] = []
    signals: list[str] = []
    values: list[FloatArray] = []
    sizes: list[int] = []
    for k in range(product.epoch_count):
        if check is not None and k % _EPOCHS_PER_CHECK == 0:
            check()
        record = product.epoch(k)
        if record.flag >= _FAILURE or record.epoch is None:
            continue
        times.append(_instant(record.epoch))
        series = product.observation_values(k, wanted)
        satellites += series.satellites
        signals += _renumbered(series) if float(header.version) == _OLD_BEIDOU else series.codes
        values.append(np.asarray(series.values, dtype=np.float64))
        sizes.append(len(series))
    if not times:
        raise InputError(FIELD, "has no epoch of observations; is the file complete?")
    time = _gps_time(np.array(times), header.time_of_first_obs)
    epochs = np.repeat(np.arange(len(times)), sizes)
    rising = np.diff(time) > np.timedelta64(0, "ns")
    if not rising.all():
        raise InputError(
            FIELD,
            f"goes back in time or repeats itself after epoch {int(np.argmin(rising))}; sort it by time",
        )
    return _columns(time, epochs, satellites, signals, np.concatenate(values), _channels(header))


def _unpacked(text: str, most_bytes: int) -> str:
    """Undo the compression of Hatanaka."""
    label = text[60 : text.find("\n")].strip()
    if not label.startswith("CRINEX VERS"):
        return text
    types = max((_declared_types(line) for line in text[:_HEADER].split("\n")), default=1)
    if text.count("\n") * types * _VALUE > most_bytes:
        raise InputError(FIELD, f"may unpack to more than {most_bytes} bytes; split it by time")
    try:
        return str(sidereon.decode_crinex(text))
    except sidereon.SidereonError as error:
        raise InputError(FIELD, f"cannot be unpacked by Hatanaka's method: {_first_line(error)}") from error


def _declared_types(line: str) -> int:
    """How many values a satellite has, by a line of the header; 1 on other lines."""
    label = line[60:].strip()
    count = (
        line[:6] if label == "# / TYPES OF OBSERV" else line[3:6] if label == "SYS / # / OBS TYPES" else ""
    )
    return int(count) if count.strip().isdecimal() else 1


def _parsed(text: str) -> Any:
    first = text[: text.find("\n")]
    if first[60:].strip() != "RINEX VERSION / TYPE":
        raise InputError(FIELD, "does not begin with 'RINEX VERSION / TYPE'; send a RINEX observation file")
    if first[20:21].upper() != "O":
        raise InputError(FIELD, "is a navigation file or another; send the observation file here")
    if first[:9].strip().split(".")[0] not in {"2", "3"}:
        raise InputError(FIELD, f"has RINEX version {first[:9].strip()!r}; send version 2 or 3")
    try:
        return sidereon.parse_rinex_obs(text)
    except sidereon.SidereonError as error:
        raise InputError(FIELD, f"cannot be read as RINEX: {_first_line(error)}") from error


def _first_line(error: Exception) -> str:
    return str(error).split("\n", 1)[0].removeprefix("parse error: ")[:200]


def _wanted(product: Any, letter: str, bands: int) -> list[str]:
    """Codes of the file for a system, with Doppler and strength of the first band."""
    present = set(product.obs_codes(_SYSTEMS[letter]))
    old = float(product.header.version) == _OLD_BEIDOU
    found = []
    for place, (band, tracking) in enumerate(CODES[letter].items()):
        if place >= bands:
            break
        bands_called = (band, "1") if letter == "C" and place == 0 and old else (band,)
        for signal in (called + code for called in bands_called for code in tracking):
            kinds = "CDS" if place == 0 else "C"
            found += [kind + signal for kind in kinds if kind + signal in present]
        # RINEX 2 knows one Doppler and one strength per band; BeiDou's B1I was band 1 in RINEX 3.02.
        if place == 0:
            found += [kind + band for kind in "DS" if kind + band in present]
    return found


def _renumbered(series: Any) -> list[str]:
    """Codes with BeiDou's B1 in band 2."""
    return [
        f"{code[0]}2{code[2:]}" if name[0] == "C" and code[1:2] == "1" else code
        for name, code in zip(series.satellites, series.codes, strict=True)
    ]


def _instant(time: Any) -> np.datetime64:
    if not _YEARS[0] <= time.year < _YEARS[1]:
        raise InputError(FIELD, f"has an epoch in the year {time.year}")
    day = np.datetime64(f"{time.year:04d}-{time.month:02d}-{time.day:02d}", "ns")
    # RINEX writes seven decimals; what the float holds beyond them is noise.
    ticks = round(time.second * 1e7) + (time.hour * 60 + time.minute) * 600_000_000
    return day + np.timedelta64(100 * ticks, "ns")


def _gps_time(time: TimeArray, first: Any) -> TimeArray:
    scale = "GPST" if first is None else str(first[1]).rsplit(".", maxsplit=1)[-1]
    if scale in {"GPST", "GST", "QZSST"}:
        return time
    if scale == "BDT":
        return np.asarray(time + np.timedelta64(BEIDOU_BEHIND_S, "s"))
    if scale in {"UTC", "GLONASST"}:
        return utc_to_gps(time)
    raise InputError(FIELD, f"is in time system {scale}; GPS, GAL, QZS, BDT and GLO are read")


def _channels(header: Any) -> dict[str, int]:
    return {f"R{slot:02d}": int(channel) for slot, channel in header.glonass_slots}


def _columns(
    time: TimeArray,
    epochs: IntArray,
    satellites: list[str],
    signals: list[str],
    values: FloatArray,
    channels: Mapping[str, int],
) -> Observations:
    names = np.array(satellites, dtype="U3")
    changes = np.ones(names.size, dtype=np.bool_)
    changes[1:] = (names[1:] != names[:-1]) | (epochs[1:] != epochs[:-1])
    row = np.cumsum(changes) - 1
    satellite, epoch = names[changes], epochs[changes]
    kinds, kind = np.unique(np.array(signals, dtype="U3"), return_inverse=True)
    table = {str(name): np.full(satellite.size, np.nan) for name in kinds}
    for place, name in enumerate(kinds):
        here = kind == place
        table[str(name)][row[here]] = values[here]
    letter = satellite.astype("U1")
    codes = {band: np.full(satellite.size, np.nan) for band in "12567"}
    doppler, strength = np.full(satellite.size, np.nan), np.full(satellite.size, np.nan)
    for system, tracked in CODES.items():
        own = letter == system
        for place, (band, tracking) in enumerate(tracked.items()):
            for code in tracking:
                column = table.get(f"C{band}{code}")
                if column is None:
                    continue
                # A range of zero stands for a blank in older files.
                take = own & ~np.isfinite(codes[band]) & np.isfinite(column) & (column != 0.0)
                codes[band][take] = column[take]
                if place == 0:
                    for out, kind_letter in ((doppler, "D"), (strength, "S")):
                        other = table.get(f"{kind_letter}{band}{code}", table.get(f"{kind_letter}{band}"))
                        if other is not None:
                            out[take] = other[take]
    return Observations(
        time_gps=time,
        epoch=epoch,
        satellite=satellite,
        codes_m=codes,
        range_rate_mps=None,
        doppler_hz=doppler,
        cn0_dbhz=strength,
        channels=channels,
        bands={system: tuple(tracked) for system, tracked in CODES.items()},
    )
