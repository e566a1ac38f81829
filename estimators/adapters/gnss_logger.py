"""Logs of Android's GnssLogger as corrected epochs: :func:`read_gnss_logger`.

A phone reports when a signal was received by its own clock, and the time that the satellite put on it; the
difference is the pseudorange (Android's ``GnssMeasurement``, ``GnssClock``; ``ProcessGnssMeas.m`` of Google's
gps-measurement-tools). The time of transmission is known up to the part that has been decoded: measurements
count that have their time of week or, of GLONASS, of day.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from estimators.adapters.rinex_navigation import read_navigation
from estimators.adapters.rinex_text import MOST_BYTES, Source, read_text
from estimators.arrays import FloatArray, InputError, IntArray
from estimators.gnss.calendar import BEIDOU_BEHIND_S, GPS_EPOCH, WEEK_NS, gps_to_utc
from estimators.gnss.carriers import first_carrier_hz
from estimators.gnss.corrections.measured import Weights
from estimators.gnss.observed_epochs import ObservedEpochs
from estimators.gnss.orbits.broadcast import (
    Ionosphere,
    Navigation,
    Observations,
    check_ionosphere,
    correct_observations,
    read_letters,
)
from estimators.gnss.snapshot.linearise import SPEED_OF_LIGHT

FIELD = "log"
_SYSTEMS = {1: "G", 3: "R", 4: "J", 5: "C", 6: "E"}
"""Constellations of Android's ``GnssStatus``."""
_FIRST_QZSS = 192
_SLOTS = {"G": 32, "R": 24, "J": 10, "C": 63, "E": 36}
"""Largest satellite numbers; GLONASS satellites from 93 on are told by channel and not by slot."""
_CODE_LOCK, _WEEK_DECODED, _DAY_DECODED = 1 << 0, 1 << 3, 1 << 7
_WEEK_KNOWN, _DAY_KNOWN = 1 << 14, 1 << 15
"""States of ``GnssMeasurement.getState``."""
_BANDS = {"G": "1", "R": "1", "J": "1", "C": "2", "E": "1"}
_BAND_HZ = 10e6
_DAY_NS = 86_400_000_000_000
_MOSCOW_NS = 10_800_000_000_000
_UNSURE_NS = 500.0
"""Uncertainty of the transmission time above which none is used (Google's ``SetDataFilter.m``)."""
_UNSURE_CLOCK_NS = 1e7
_RANGES_M = (1e7, 1e8)
_LATEST_NS = 1 << 62
_LINES_PER_CHECK = 4096
_NEEDED = (
    "TimeNanos",
    "FullBiasNanos",
    "BiasNanos",
    "Svid",
    "State",
    "ReceivedSvTimeNanos",
    "ReceivedSvTimeUncertaintyNanos",
    "Cn0DbHz",
    "PseudorangeRateMetersPerSecond",
    "ConstellationType",
)


@dataclass(frozen=True, slots=True)
class _Signal:
    clock_ns: int
    arrival_ns: int
    name: str
    range_m: float
    cn0_dbhz: float
    rate_mps: float


def read_gnss_logger(
    log: Source,
    navigation: Source | Sequence[Source] | Navigation,
    *,
    systems: Sequence[str] | None = None,
    mask_deg: float = 10.0,
    weights: Weights = "strength",
    ionosphere: Ionosphere = "auto",
    most_bytes: int = MOST_BYTES,
    check: Callable[[], object] | None = None,
) -> ObservedEpochs:
    """Read a phone's raw measurements, and correct them by broadcast messages.

    Parameters
    ----------
    log : bytes or Path
        Text with lines ``Raw,...`` and the header ``# Raw,...`` that names their columns; plain or gzip.
    navigation : bytes, Path, sequence of these, or Navigation
        RINEX 2 or 3 of the same day.
    systems : sequence of str, optional
        Letters or names of GPS, GLONASS, Galileo, BeiDou and QZSS. Default: all of them.
    mask_deg : float
        Satellites below are left out.
    weights : {"strength", "elevation"}
        Noise by signal strength, or by elevation.
    ionosphere : {"auto", "broadcast", "none"}
        As for :func:`estimators.adapters.rinex.read_rinex`; phones' second carriers are not used.
    most_bytes : int
        Unpacked size above which the log, or the navigation files together, are refused.
    check : callable, optional
        Called now and then while a file is read; what it raises ends the reading.

    Returns
    -------
    ObservedEpochs
        An epoch for each reading of the phone's clock; ``source_row`` counts usable measurements.

    Raises
    ------
    InputError
        If the file is no such log, holds no usable measurement, or the navigation file covers none.

    Examples
    --------
    >>> read_gnss_logger(b"hello", b"")
    Traceback (most recent call last):
        ...
    estimators.arrays.InputError: log: has no header '# Raw,...'; send the text file that GnssLogger wrote
    """
    letters = read_letters(systems, "GRECJ")
    check_ionosphere(ionosphere)
    if ionosphere == "dual":
        raise InputError(
            "ionosphere", "must be auto, broadcast or none: one code per satellite is read of a phone"
        )
    signals = sorted(
        _signals(read_text(log, FIELD, most_bytes), letters, check),
        key=lambda signal: (signal.clock_ns, signal.name),
    )
    if not signals:
        raise InputError(
            FIELD, "has no measurement with a decoded time of transmission; was the phone under an open sky?"
        )
    messages = navigation if isinstance(navigation, Navigation) else read_navigation(navigation, most_bytes)
    return correct_observations(
        _observations(signals), messages, ionosphere=ionosphere, weights=weights, mask_deg=mask_deg
    )


def _observations(signals: list[_Signal]) -> Observations:
    names = np.array([signal.name for signal in signals], dtype="U3")
    clocks = np.array([signal.clock_ns for signal in signals], dtype=np.int64)
    fresh = np.ones(clocks.size, dtype=np.bool_)
    fresh[1:] = (clocks[1:] != clocks[:-1]) | (names[1:] != names[:-1])
    kept = [signal for signal, new in zip(signals, fresh, strict=True) if new]
    _, starts, epoch = np.unique(clocks[fresh], return_index=True, return_inverse=True)
    arrivals: IntArray = np.array([kept[i].arrival_ns for i in starts], dtype=np.int64)
    ranges = np.array([signal.range_m for signal in kept])
    return Observations(
        time_gps=GPS_EPOCH + arrivals.astype("timedelta64[ns]"),
        epoch=epoch.astype(np.int64),
        satellite=names[fresh],
        codes_m=dict.fromkeys(_BANDS.values(), ranges),
        range_rate_mps=np.array([signal.rate_mps for signal in kept]),
        doppler_hz=None,
        cn0_dbhz=_strengths(kept),
        channels={},
        bands=_BANDS,
    )


def _strengths(signals: list[_Signal]) -> FloatArray:
    strengths = np.array([signal.cn0_dbhz for signal in signals])
    return np.where((strengths > 0.0) & (strengths < 80.0), strengths, np.nan)


def _signals(text: str, letters: str, check: Callable[[], object] | None) -> Iterator[_Signal]:
    place: dict[str, int] | None = None
    for number, line in enumerate(text.split("\n")):
        if check is not None and number % _LINES_PER_CHECK == 0:
            check()
        if line.startswith("#"):
            body = line[1:].strip()
            if body.startswith("Raw,"):
                place = {name.strip(): k for k, name in enumerate(body.split(","))}
                missing = [name for name in _NEEDED if name not in place]
                if missing:
                    raise InputError(FIELD, f"lacks the columns {', '.join(missing)} of raw measurements")
        elif line.startswith("Raw,"):
            if place is None:
                break
            signal = _signal(line.split(","), place, letters)
            if signal is not None:
                yield signal
    if place is None:
        raise InputError(FIELD, "has no header '# Raw,...'; send the text file that GnssLogger wrote")


def _signal(cells: list[str], place: dict[str, int], letters: str) -> _Signal | None:
    """One measurement; None where the phone says that it is not to be trusted, or the line is damaged."""

    def whole(name: str) -> int:
        return int(cells[place[name]])

    def real(name: str, default: float = 0.0) -> float:
        cell = cells[place[name]].strip() if name in place else ""
        return float(cell) if cell else default

    try:
        system = _SYSTEMS.get(whole("ConstellationType"))
        if system is None or system not in letters:
            return None
        clock, full_bias, state = whole("TimeNanos"), whole("FullBiasNanos"), whole("State")
        sent, number = whole("ReceivedSvTimeNanos"), whole("Svid")
        fraction = real("TimeOffsetNanos") - real("BiasNanos")
        unsure, unsure_clock = real("ReceivedSvTimeUncertaintyNanos"), real("BiasUncertaintyNanos")
        carrier = real("CarrierFrequencyHz", first_carrier_hz(system))
        strength, rate = real("Cn0DbHz", np.nan), real("PseudorangeRateMetersPerSecond", np.nan)
    except (ValueError, IndexError):
        return None
    number -= _FIRST_QZSS if system == "J" else 0
    arrival = clock - full_bias
    # A comparison with NaN is False, so whatever is not a number is refused here.
    sound = (
        full_bias != 0
        and 0 < arrival < _LATEST_NS
        and 1 <= number <= _SLOTS[system]
        and unsure <= _UNSURE_NS
        and unsure_clock <= _UNSURE_CLOCK_NS
        and abs(carrier - first_carrier_hz(system)) < _BAND_HZ
        and abs(fraction) < _UNSURE_CLOCK_NS
    )
    if not (sound and _is_dated(system, state)):
        return None
    travelled = _travelled_ns(system, arrival, sent)
    metres = (travelled + fraction) * 1e-9 * SPEED_OF_LIGHT
    if not _RANGES_M[0] < metres < _RANGES_M[1]:
        return None
    return _Signal(clock, arrival, f"{system}{number:02d}", metres, strength, rate)


def _is_dated(system: str, state: int) -> bool:
    """Whether the code is locked and the time of transmission is known within the week, or the day."""
    known = _DAY_DECODED | _DAY_KNOWN if system == "R" else _WEEK_DECODED | _WEEK_KNOWN
    return bool(state & _CODE_LOCK) and bool(state & known)


def _travelled_ns(system: str, arrival_ns: int, sent_ns: int) -> int:
    """Time of travel; satellite times begin anew every week, those of GLONASS every day of Moscow."""
    period, here = WEEK_NS, arrival_ns
    if system == "C":
        here -= BEIDOU_BEHIND_S * 1_000_000_000
    elif system == "R":
        utc = gps_to_utc(np.array([GPS_EPOCH + np.timedelta64(arrival_ns, "ns")]))[0]
        here = int((utc - GPS_EPOCH).astype(np.int64)) + _MOSCOW_NS
        period = _DAY_NS
    return (here - sent_ns + period // 2) % period - period // 2
