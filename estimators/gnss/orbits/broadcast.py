"""Observed codes and broadcast messages put together: satellite states, group delays, then corrections."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from estimators.arrays import BoolArray, FloatArray, InputError, IntArray
from estimators.gnss.calendar import GPS_EPOCH, TimeArray, gps_nanoseconds
from estimators.gnss.carriers import carrier_hz, first_carrier_hz
from estimators.gnss.corrections.ionosphere_free import ionosphere_free
from estimators.gnss.corrections.klobuchar import Klobuchar
from estimators.gnss.corrections.measured import CorrectionSettings, Measured, Weights, correct_measured
from estimators.gnss.observed_epochs import LeftOut, LeftOutReason, ObservedEpochs
from estimators.gnss.orbits.ephemerides import NONE, UNHEALTHY, Ephemerides
from estimators.gnss.orbits.states import satellite_states
from estimators.gnss.snapshot.linearise import SPEED_OF_LIGHT
from estimators.gnss.systems import system_letter

Ionosphere = Literal["auto", "broadcast", "dual", "none"]
IONOSPHERES: tuple[Ionosphere, ...] = ("auto", "broadcast", "dual", "none")
Names = np.ndarray[Any, np.dtype[np.str_]]


@dataclass(frozen=True, slots=True)
class Navigation:
    """What navigation messages say.

    Attributes
    ----------
    ephemerides : Ephemerides
    klobuchar : Klobuchar or None
        Ionosphere of GPS, else QZSS, else BeiDou.
    """

    ephemerides: Ephemerides
    klobuchar: Klobuchar | None


@dataclass(frozen=True, slots=True)
class Observations:
    """Codes as received: one row per epoch and satellite, NaN where a value is missing.

    Attributes
    ----------
    time_gps : ndarray of datetime64[ns], shape (epochs,)
        Rising.
    epoch : ndarray of int64, shape (rows,)
        Not falling.
    satellite : ndarray of str, shape (rows,)
        Names as RINEX has them: ``G05``.
    codes_m : mapping of str to ndarray of float64, shape (rows,)
        By band.
    range_rate_mps : ndarray of float64, shape (rows,), or None
        How fast ranges grow; None leaves it to ``doppler_hz``.
    doppler_hz : ndarray of float64, shape (rows,), or None
        On the first band of each system; positive where a range shrinks.
    cn0_dbhz : ndarray of float64, shape (rows,)
    channels : mapping of str to int
        Of GLONASS satellites, where the observer says so.
    bands : mapping of str to sequence of str
        By system letter: the band of single-frequency positions, then others in order of preference.
    """

    time_gps: TimeArray
    epoch: IntArray
    satellite: Names
    codes_m: Mapping[str, FloatArray]
    range_rate_mps: FloatArray | None
    doppler_hz: FloatArray | None
    cn0_dbhz: FloatArray
    channels: Mapping[str, int]
    bands: Mapping[str, Sequence[str]]


def read_letters(systems: Sequence[str] | str | None, known: str) -> str:
    """Letters of the systems asked for, in the order of ``known``.

    Parameters
    ----------
    systems : sequence of str, optional
        Letters or names; default all known.
    known : str
        Letters that can be read.

    Raises
    ------
    InputError
        If there is no such system, or it cannot be read.

    Examples
    --------
    >>> read_letters(["galileo", "G"], "GREC")
    'GE'
    """
    if systems is None:
        return known
    given = [systems] if isinstance(systems, str) else list(systems)
    letters = {system_letter(name, "systems") for name in given}
    if not letters or not letters <= set(known):
        raise InputError("systems", f"must name some of: {', '.join(known)}")
    return "".join(letter for letter in known if letter in letters)


def check_ionosphere(ionosphere: str) -> None:
    """Refuse what is no way to remove the ionosphere.

    Raises
    ------
    InputError
    """
    if ionosphere not in IONOSPHERES:
        raise InputError("ionosphere", f"must be one of: {', '.join(IONOSPHERES)}")


def correct_observations(
    observed: Observations,
    navigation: Navigation,
    *,
    ionosphere: Ionosphere,
    weights: Weights,
    mask_deg: float,
) -> ObservedEpochs:
    """Find where the satellites were, and correct what was observed.

    Parameters
    ----------
    observed : Observations
    navigation : Navigation
    ionosphere : {"auto", "broadcast", "dual", "none"}
        See :func:`estimators.adapters.rinex.read_rinex`.
    weights : {"elevation", "strength"}
    mask_deg : float

    Raises
    ------
    InputError
        If the messages serve none of the observations, or lack the ionosphere asked for.
    """
    check_ionosphere(ionosphere)
    model = navigation.klobuchar if ionosphere in {"auto", "broadcast"} else None
    if ionosphere == "broadcast" and model is None:
        raise InputError(
            "navigation",
            "has no ionosphere coefficients in its header; ask for ionosphere none, or dual with two codes",
        )
    settings = CorrectionSettings(model, ionosphere == "dual", True, weights, mask_deg)
    ephemerides = navigation.ephemerides
    names, satellite = np.unique(observed.satellite, return_inverse=True)
    names_text = tuple(str(name) for name in names)
    which = ephemerides.choose(names_text, satellite, gps_nanoseconds(observed.time_gps)[observed.epoch])
    _check_coverage(which, observed, ephemerides)
    first = _first_band(observed)
    carriers = np.array([_carrier(name, observed, ephemerides) for name in names_text], dtype=np.float64)
    ranges, gain = first, np.ones(first.size)
    delay = _delay(observed, ephemerides, which, 0)
    if ionosphere == "dual":
        ranges, gain = _combined(observed, ephemerides, which, carriers[satellite])
        delay = np.zeros(first.size)
    lost = np.select(
        [~np.isfinite(first), which == NONE, which == UNHEALTHY, ~np.isfinite(ranges + delay)],
        [1, 2, 3, 4],
        0,
    )
    rows = np.flatnonzero(lost == 0)
    states = satellite_states(
        ephemerides, which[rows], gps_nanoseconds(observed.time_gps)[observed.epoch[rows]], first[rows]
    )
    carrier = carriers[satellite[rows]]
    if observed.range_rate_mps is not None:
        rate = observed.range_rate_mps[rows]
    elif observed.doppler_hz is not None:
        rate = -observed.doppler_hz[rows] * SPEED_OF_LIGHT / carrier
    else:
        rate = np.full(rows.size, np.nan)
    text = observed.satellite[rows].tolist()
    measured = Measured(
        satellites_m=states.position_m,
        velocities_mps=states.velocity_mps,
        rotated=False,
        ranges_m=ranges[rows],
        satellite_clock_m=SPEED_OF_LIGHT * (states.clock_s - delay[rows]),
        carrier_hz=carrier,
        noise_gain=gain[rows],
        accuracy_m=ephemerides.accuracy_m[which[rows]],
        cn0_dbhz=observed.cn0_dbhz[rows],
        range_rate_mps=rate + SPEED_OF_LIGHT * states.drift,
        system=tuple(name[0] for name in text),
        satellite=tuple(text),
        offsets=np.searchsorted(observed.epoch[rows], np.arange(observed.time_gps.size + 1)).astype(np.int64),
        time_gps=observed.time_gps,
        source_row=rows.astype(np.int64),
        sigma_m=None,
        left_out=_left_out(observed, lost),
    )
    return correct_measured(measured, settings)


def _own_rows(observed: Observations) -> dict[str, BoolArray]:
    letter = observed.satellite.astype("U1")
    return {system: letter == system for system in observed.bands}


def _first_band(observed: Observations) -> FloatArray:
    out = np.full(observed.satellite.size, np.nan)
    for system, own in _own_rows(observed).items():
        out[own] = observed.codes_m[observed.bands[system][0]][own]
    return out


def _delay(observed: Observations, ephemerides: Ephemerides, which: IntArray, place: int) -> FloatArray:
    """Group delay of a band in seconds; NaN where not broadcast or without ephemeris."""
    out = np.full(observed.satellite.size, np.nan)
    for system, own in _own_rows(observed).items():
        rows = np.flatnonzero(own & (which >= 0))
        if place < len(observed.bands[system]):
            out[rows] = ephemerides.delays_s[which[rows], int(observed.bands[system][place])]
    return out


def _combined(
    observed: Observations, ephemerides: Ephemerides, which: IntArray, carrier: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Combine codes without ionosphere, with the best second band that has a code and a group delay."""
    n = observed.satellite.size
    first = _first_band(observed) - SPEED_OF_LIGHT * _delay(observed, ephemerides, which, 0)
    ranges, gain = np.full(n, np.nan), np.ones(n)
    for place in range(1, max(len(bands) for bands in observed.bands.values())):
        delay = _delay(observed, ephemerides, which, place)
        for system, own in _own_rows(observed).items():
            if place >= len(observed.bands[system]):
                continue
            band = observed.bands[system][place]
            rows = np.flatnonzero(own & ~np.isfinite(ranges))
            channels = {**observed.channels, **ephemerides.channels}
            other = np.array(
                [carrier_hz(system, band, channels.get(name)) for name in observed.satellite[rows].tolist()]
            )
            second = observed.codes_m[band][rows] - SPEED_OF_LIGHT * delay[rows]
            ranges[rows], gain[rows] = ionosphere_free(first[rows], second, carrier[rows], other)
    return ranges, gain


def _carrier(name: str, observed: Observations, ephemerides: Ephemerides) -> float:
    system = name[0]
    channel = ephemerides.channels.get(name, observed.channels.get(name))
    found = carrier_hz(system, observed.bands[system][0], channel)
    return found if np.isfinite(found) else first_carrier_hz(system)


def _check_coverage(which: IntArray, observed: Observations, ephemerides: Ephemerides) -> None:
    if np.any(which != NONE):
        return
    if which.size == 0:
        raise InputError("observations", "has no range of the systems asked for")
    start, stop = (str(observed.time_gps[k])[:16] for k in (0, -1))
    early, late = (
        str(GPS_EPOCH + np.timedelta64(int(edge(ephemerides.toe_ns)), "ns"))[:16] for edge in (np.min, np.max)
    )
    systems = "".join(sorted(set(observed.satellite.astype("U1").tolist())))
    raise InputError(
        "navigation",
        f"serves none of the observations, which are of {start} to {stop} (GPS time) and of systems "
        f"{systems}; its ephemerides are of {early} to {late} and of systems {ephemerides.systems}; "
        "send the navigation file of that day",
    )


def _left_out(observed: Observations, lost: IntArray) -> LeftOut:
    rows = np.flatnonzero(lost)
    words: tuple[LeftOutReason, ...] = ("missing", "no_ephemeris", "unhealthy", "one_code")
    return LeftOut(
        observed.epoch[rows],
        tuple(observed.satellite[rows].tolist()),
        tuple(words[code - 1] for code in lost[rows].tolist()),
        rows.astype(np.int64),
    )
