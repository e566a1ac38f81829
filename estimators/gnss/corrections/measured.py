"""From measured ranges and satellite states, checked and column-wise, to :class:`ObservedEpochs`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from estimators.arrays import BoolArray, FloatArray, InputError, IntArray
from estimators.gnss.calendar import WEEK_NS, TimeArray, gps_nanoseconds, gps_to_utc
from estimators.gnss.carriers import L1_HZ
from estimators.gnss.corrections.atmosphere import fill_atmosphere
from estimators.gnss.corrections.klobuchar import Klobuchar
from estimators.gnss.corrections.places import fill_places
from estimators.gnss.observed_epochs import LeftOut, LeftOutReason, ObservedEpochs
from estimators.gnss.snapshot.epochs import MOST_CLOCKS, MOST_SATELLITES
from estimators.gnss.snapshot.linearise import EARTH_RATE, SPEED_OF_LIGHT
from estimators.gnss.systems import SYSTEMS
from estimators.gnss.table import EpochTable
from estimators.gnss.weighting import elevation_sigma, strength_sigma

Weights = Literal["elevation", "strength"]
WEIGHTS: tuple[Weights, ...] = ("elevation", "strength")

_IONOSPHERE_ERROR = 0.5
"""Standard deviation of the broadcast ionosphere, of itself (METHODS_GNSS, "Model": RTKLIB's)."""
_NO_IONOSPHERE_M = 5.0
"""Standard deviation where nothing removes the ionosphere: RTKLIB's."""
_TROPOSPHERE_M = 0.3
"""Standard deviation of the standard atmosphere towards the zenith: RTKLIB's, over sin el + 0.1."""
_LOWEST_SINE = 0.1


@dataclass(frozen=True, slots=True)
class Measured:
    """Ranges as measured and satellite states, a row per observation, epochs one after the other.

    Attributes
    ----------
    satellites_m, velocities_mps : ndarray of float64, shape (rows, 3)
        At transmission.
    rotated : bool
        Whether they are in the frame of the time of reception.
    ranges_m : ndarray of float64, shape (rows,)
    satellite_clock_m : ndarray of float64, shape (rows,)
        To be added: satellite clock, less the group delay.
    carrier_hz : ndarray of float64, shape (rows,)
    noise_gain : ndarray of float64, shape (rows,)
        Noise in units of that of one code.
    accuracy_m : ndarray of float64, shape (rows,), or float
        Of satellite orbits and clocks.
    cn0_dbhz, range_rate_mps : ndarray of float64, shape (rows,)
    system, satellite : tuple of str
    offsets : ndarray of int64, shape (epochs + 1,)
    time_gps : ndarray of datetime64[ns], shape (epochs,)
    source_row : ndarray of int64, shape (rows,)
    sigma_m : ndarray of float64, shape (rows,), or None
    left_out : LeftOut
        What was lost before.
    """

    satellites_m: FloatArray
    velocities_mps: FloatArray
    rotated: bool
    ranges_m: FloatArray
    satellite_clock_m: FloatArray
    carrier_hz: FloatArray
    noise_gain: FloatArray
    accuracy_m: FloatArray | float
    cn0_dbhz: FloatArray
    range_rate_mps: FloatArray
    system: tuple[str, ...]
    satellite: tuple[str, ...]
    offsets: IntArray
    time_gps: TimeArray
    source_row: IntArray
    sigma_m: FloatArray | None
    left_out: LeftOut


@dataclass(frozen=True, slots=True)
class CorrectionSettings:
    """What to remove, and how to weigh what is left.

    Attributes
    ----------
    klobuchar : Klobuchar or None
        None leaves the ionosphere.
    dual : bool
        Whether the ranges are combinations without ionosphere already.
    troposphere : bool
    weights : str
        ``elevation`` or ``strength``.
    mask_deg : float

    Raises
    ------
    InputError
    """

    klobuchar: Klobuchar | None
    dual: bool = False
    troposphere: bool = True
    weights: Weights = "elevation"
    mask_deg: float = 10.0

    def __post_init__(self) -> None:
        if self.weights not in WEIGHTS:
            raise InputError("weights", f"must be one of: {', '.join(WEIGHTS)}")
        if not (math.isfinite(self.mask_deg) and -90.0 <= self.mask_deg < 90.0):
            raise InputError("mask_deg", "must lie between -90 and 90 degrees")


def correct_measured(measured: Measured, settings: CorrectionSettings) -> ObservedEpochs:
    """Remove satellite clocks and atmosphere, turn the satellites to the time of reception, and weigh.

    Parameters
    ----------
    measured : Measured
    settings : CorrectionSettings

    Raises
    ------
    InputError
        If an epoch has more satellites or systems than the solver takes.
    """
    letters, clock = _clocks(measured.system, measured.offsets)
    ranges = measured.ranges_m + measured.satellite_clock_m
    seconds = np.asarray(gps_nanoseconds(measured.time_gps) % WEEK_NS * 1e-9, dtype=np.float64)
    model = settings.klobuchar
    coefficients = np.zeros(8) if model is None else model.coefficients()
    gain: FloatArray = np.zeros(ranges.size) if model is None else (L1_HZ / measured.carrier_hz) ** 2
    epochs = measured.offsets.size - 1
    places, solved = np.full((epochs, 3), np.nan), np.zeros(epochs, dtype=np.bool_)
    fill_places(
        measured.satellites_m,
        ranges,
        clock,
        measured.offsets,
        np.array([len(present) for present in letters], dtype=np.int64),
        measured.rotated,
        seconds,
        coefficients,
        gain,
        settings.troposphere,
        math.radians(settings.mask_deg),
        places,
        solved,
    )
    azimuth, elevation = np.full(ranges.size, np.nan), np.full(ranges.size, np.nan)
    ionosphere, troposphere = np.zeros(ranges.size), np.zeros(ranges.size)
    if solved.any():
        places = _borrowed(places, solved)
        fill_atmosphere(
            measured.satellites_m,
            measured.offsets,
            measured.rotated,
            places,
            seconds,
            coefficients,
            gain,
            settings.troposphere,
            azimuth,
            elevation,
            ionosphere,
            troposphere,
        )
    elevation_deg = np.degrees(elevation)
    table = EpochTable(
        satellites_m=_turned(measured, places, measured.satellites_m),
        pseudoranges_m=ranges - ionosphere - troposphere,
        sigma_m=_sigma(measured, settings, elevation, ionosphere),
        clock=clock,
        offsets=measured.offsets,
        letters=letters,
        names=measured.satellite,
        rotated=True,
    )
    kept = ~(elevation_deg < settings.mask_deg)
    return ObservedEpochs(
        table=table.without(~kept),
        time_gps=measured.time_gps,
        time_utc=gps_to_utc(measured.time_gps),
        elevation_deg=elevation_deg[kept],
        azimuth_deg=np.degrees(azimuth[kept]) % 360.0,
        cn0_dbhz=measured.cn0_dbhz[kept],
        raw_m=measured.ranges_m[kept],
        range_rate_mps=measured.range_rate_mps[kept],
        velocities_mps=_turned(measured, places, measured.velocities_mps)[kept],
        satellite_clock_m=measured.satellite_clock_m[kept],
        ionosphere_m=ionosphere[kept],
        troposphere_m=troposphere[kept],
        source_row=measured.source_row[kept],
        left_out=_with_masked(measured, ~kept),
        ionosphere="dual" if settings.dual else "none" if model is None else "klobuchar",
    )


def _clocks(system: tuple[str, ...], offsets: IntArray) -> tuple[tuple[tuple[str, ...], ...], IntArray]:
    letters, clock = [], np.empty(len(system), dtype=np.int64)
    for e in range(offsets.size - 1):
        a, b = int(offsets[e]), int(offsets[e + 1])
        if b - a > MOST_SATELLITES:
            raise InputError(
                "pseudoranges_m", f"at most {MOST_SATELLITES} satellites make an epoch, got {b - a}"
            )
        here = set(system[a:b])
        present = tuple(letter for letter in SYSTEMS if letter in here)
        if len(present) > MOST_CLOCKS:
            raise InputError("system", f"at most {MOST_CLOCKS} systems make an epoch")
        place = {letter: j for j, letter in enumerate(present)}
        clock[a:b] = [place[letter] for letter in system[a:b]]
        letters.append(present)
    return tuple(letters), clock


def _borrowed(places: FloatArray, solved: BoolArray) -> FloatArray:
    """Epochs without a position take that of the nearest one in order that has one, the earlier of two."""
    known = np.flatnonzero(solved)
    epochs = np.arange(solved.size)
    after = np.clip(np.searchsorted(known, epochs), 0, known.size - 1)
    before = np.maximum(after - 1, 0)
    nearer = np.abs(known[before] - epochs) <= np.abs(known[after] - epochs)
    return np.ascontiguousarray(places[known[np.where(nearer, before, after)]])


def _turned(measured: Measured, places: FloatArray, vectors: FloatArray) -> FloatArray:
    """Turn vectors by the Earth's rotation on the signal's way, to the frame of reception."""
    if measured.rotated:
        return vectors
    place = np.repeat(places, np.diff(measured.offsets), axis=0)
    way = np.linalg.norm(measured.satellites_m - place, axis=1)
    # Without any position in the input: the range itself, wrong by the receiver clock alone.
    way = np.where(np.isfinite(way), way, measured.ranges_m + measured.satellite_clock_m)
    angle = EARTH_RATE * way / SPEED_OF_LIGHT
    sine, cosine = np.sin(angle), np.cos(angle)
    x, y, z = vectors.T
    return np.column_stack([cosine * x + sine * y, cosine * y - sine * x, z])


def _sigma(
    measured: Measured, settings: CorrectionSettings, elevation: FloatArray, ionosphere: FloatArray
) -> FloatArray:
    if measured.sigma_m is not None:
        return measured.sigma_m
    radians = np.nan_to_num(elevation, nan=math.radians(settings.mask_deg))
    degrees = np.degrees(radians)
    if settings.weights == "strength":
        known = np.isfinite(measured.cn0_dbhz)
        strength = strength_sigma(np.where(known, measured.cn0_dbhz, 0.0), degrees)
        by_elevation = elevation_sigma(degrees, measured.system, measured.accuracy_m)
        return np.where(known, strength, by_elevation) * measured.noise_gain
    sine = np.maximum(np.sin(radians), _LOWEST_SINE)
    left = _IONOSPHERE_ERROR * ionosphere
    if settings.klobuchar is None and not settings.dual:
        left = _NO_IONOSPHERE_M / sine * _LOWEST_SINE + _NO_IONOSPHERE_M
    code = elevation_sigma(degrees, measured.system, 0.0) * measured.noise_gain
    squares = code**2 + np.square(measured.accuracy_m) + left**2
    if settings.troposphere:
        squares = squares + (_TROPOSPHERE_M / (sine + 0.1)) ** 2
    return np.sqrt(squares)


def _with_masked(measured: Measured, masked: BoolArray) -> LeftOut:
    rows = np.flatnonzero(masked)
    before = measured.left_out
    epoch = np.searchsorted(measured.offsets, rows, side="right") - 1
    all_epochs = np.concatenate([before.epoch, epoch]).astype(np.int64)
    source = np.concatenate([before.source_row, measured.source_row[rows]]).astype(np.int64)
    names = (*before.satellite, *(measured.satellite[i] for i in rows))
    masked_all: list[LeftOutReason] = ["masked"] * rows.size
    reasons: list[LeftOutReason] = [*before.reason, *masked_all]
    order = np.lexsort((source, all_epochs))
    return LeftOut(
        all_epochs[order],
        tuple(names[i] for i in order),
        tuple(reasons[i] for i in order),
        source[order],
    )
