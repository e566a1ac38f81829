"""From pseudoranges as measured, with satellite states, to corrected epochs: :func:`correct_ranges`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike as AnyArray

from estimators.arrays import ArrayLike, BoolArray, FloatArray, InputError, IntArray, as_vector
from estimators.gnss.calendar import TimeArray
from estimators.gnss.carriers import first_carrier_hz
from estimators.gnss.corrections.ionosphere_free import ionosphere_free
from estimators.gnss.corrections.klobuchar import Klobuchar
from estimators.gnss.corrections.measured import CorrectionSettings, Measured, Weights, correct_measured
from estimators.gnss.observations import as_epoch
from estimators.gnss.observed_epochs import LeftOut, LeftOutReason, ObservedEpochs
from estimators.gnss.snapshot.linearise import SPEED_OF_LIGHT
from estimators.gnss.weighting import EPHEMERIS_M

__all__ = ["LeftOut", "ObservedEpochs", "correct_ranges"]

_LARGEST_CLOCK_S = 0.1
"""Satellite clocks are kept within a millisecond of their system's; a tenth of a second is another unit."""
_CARRIERS_HZ = (1e9, 3e9)


def correct_ranges(
    satellites_m: ArrayLike,
    pseudoranges_m: ArrayLike,
    *,
    time_gps: AnyArray,
    offsets: AnyArray | None = None,
    satellite_clock_s: ArrayLike | None = None,
    group_delay_s: ArrayLike | None = None,
    system: str | Sequence[str] | None = None,
    satellite: Sequence[str] | None = None,
    rotated: bool = False,
    klobuchar: Klobuchar | None = None,
    troposphere: bool = True,
    frequency_hz: ArrayLike | None = None,
    second_m: ArrayLike | None = None,
    second_hz: ArrayLike | None = None,
    cn0_dbhz: ArrayLike | None = None,
    range_rate_mps: ArrayLike | None = None,
    velocities_mps: ArrayLike | None = None,
    clock_drift: ArrayLike | None = None,
    accuracy_m: ArrayLike | None = None,
    sigma_m: ArrayLike | float | None = None,
    weights: Weights = "elevation",
    mask_deg: float = 10.0,
) -> ObservedEpochs:
    """Correct pseudoranges for satellite clock, group delay, Earth rotation, ionosphere and troposphere.

    Parameters
    ----------
    satellites_m : array_like, shape (rows, 3)
        Satellite positions when they transmitted, Earth-centred and Earth-fixed, in metres.
    pseudoranges_m : array_like, shape (rows,)
        As measured; NaN where missing.
    time_gps : array_like of datetime64, shape (epochs,) or ()
        Reception, in GPS time.
    offsets : array_like of int, shape (epochs + 1,), optional
        Epoch k is rows ``offsets[k]:offsets[k + 1]``. Default: all rows are one epoch.
    satellite_clock_s : array_like, shape (rows,), optional
        How far the satellite clock is ahead, relativity included. Default 0.
    group_delay_s : array_like, shape (rows,), optional
        Of the signal measured: TGD, BGD. Default 0.
    system, satellite : sequence of str, shape (rows,), optional
        As for :func:`estimators.locate`.
    rotated : bool
        Whether satellite positions are in the frame of the time of reception.
    klobuchar : Klobuchar, optional
        Ionosphere; default: not corrected.
    troposphere : bool
        Whether to correct by Saastamoinen's model in a standard atmosphere.
    frequency_hz : array_like, shape (rows,), optional
        Carrier. Default: the first of the system.
    second_m, second_hz : array_like, shape (rows,), optional
        Pseudorange on another carrier, and the carrier: both codes are combined without ionosphere, and rows
        without a second code are left out. Satellite clocks of GPS need no group delay then.
    cn0_dbhz : array_like, shape (rows,), optional
        Signal strength.
    range_rate_mps : array_like, shape (rows,), optional
        By Doppler, as measured: positive where the range grows.
    velocities_mps : array_like, shape (rows, 3), optional
        Of the satellites, Earth-fixed.
    clock_drift : array_like, shape (rows,), optional
        Of the satellite clocks, seconds per second.
    accuracy_m : array_like, shape (rows,), optional
        URA: accuracy of orbit and clock as the satellite states it. Default 2 m.
    sigma_m : array_like, shape (rows,), or float, optional
        Noise; default by ``weights``.
    weights : {"elevation", "strength"}
        Noise by elevation, after RTKLIB's model, or by signal strength.
    mask_deg : float
        Satellites below are left out.

    Returns
    -------
    ObservedEpochs

    Raises
    ------
    InputError
        If the input cannot be epochs: shapes, units, satellites that come twice in an epoch.

    Examples
    --------
    >>> from estimators.geodesy.ellipsoid import to_cartesian
    >>> here = to_cartesian(np.array([52.5, 13.4, 80.0]))
    >>> sky = [[60, 10], [20, -30], [48, 40], [75, 100], [30, 60], [52, -10]]
    >>> satellites = to_cartesian(np.array([[lat, lon, 20.2e6] for lat, lon in sky]))
    >>> ranges = np.linalg.norm(satellites - here, axis=1) + 2.3
    >>> observed = correct_ranges(satellites, ranges, time_gps=np.datetime64("2024-05-01"), rotated=True)
    >>> observed.troposphere_m.round(1).tolist()
    [2.4, 4.6, 2.6, 3.7, 3.8, 2.5]
    """
    settings = CorrectionSettings(klobuchar, second_m is not None, troposphere, weights, mask_deg)
    ranges = as_vector(pseudoranges_m, "pseudoranges_m")
    n = ranges.size
    times, bounds = _times(time_gps), _offsets(offsets, n)
    if times.size != bounds.size - 1:
        raise InputError("time_gps", f"expected one per epoch, {bounds.size - 1}, got {times.size}")
    positions = _rows_of_three(satellites_m, "satellites_m", n)
    names, letters = _checked(positions, ranges, sigma_m, system, satellite, bounds)
    carrier = _carriers(frequency_hz, "frequency_hz", n)
    if carrier is None:
        carrier = np.array([first_carrier_hz(letter) for letter in letters])
    clock_s = _column(satellite_clock_s, "satellite_clock_s", n, 0.0)
    delay_s = _column(group_delay_s, "group_delay_s", n, 0.0)
    for field, values in (("satellite_clock_s", clock_s), ("group_delay_s", delay_s)):
        if np.any(np.abs(values) > _LARGEST_CLOCK_S):
            raise InputError(
                field, "is more than a tenth of a second; send seconds, not metres or nanoseconds"
            )
    missing = ~(np.isfinite(ranges) & np.isfinite(positions).all(axis=1) & np.isfinite(clock_s + delay_s))
    one_code = np.zeros(n, dtype=np.bool_)
    gain = np.ones(n)
    if second_m is not None:
        if second_hz is None:
            raise InputError("second_hz", "is needed to combine two codes; send the carrier of the second")
        other = _carriers(second_hz, "second_hz", n)
        ranges, gain = ionosphere_free(
            ranges, _column(second_m, "second_m", n, 0.0), carrier, np.asarray(other)
        )
        one_code = ~missing & ~np.isfinite(ranges)
    drift = _column(clock_drift, "clock_drift", n, 0.0)
    sigma = None
    if sigma_m is not None:
        sigma = (
            np.full(n, sigma_m, dtype=np.float64) if np.ndim(sigma_m) == 0 else as_vector(sigma_m, "sigma_m")
        )
        missing = missing | ~np.isfinite(sigma)
    kept = ~(missing | one_code)
    rows = np.flatnonzero(kept)
    velocities = (
        np.full((n, 3), np.nan)
        if velocities_mps is None
        else _rows_of_three(velocities_mps, "velocities_mps", n)
    )
    measured = Measured(
        satellites_m=np.ascontiguousarray(positions[rows]),
        velocities_mps=velocities[rows],
        rotated=rotated,
        ranges_m=ranges[rows],
        satellite_clock_m=SPEED_OF_LIGHT * (clock_s - delay_s)[rows],
        carrier_hz=carrier[rows],
        noise_gain=gain[rows],
        accuracy_m=_column(accuracy_m, "accuracy_m", n, EPHEMERIS_M)[rows],
        cn0_dbhz=_column(cn0_dbhz, "cn0_dbhz", n, np.nan)[rows],
        range_rate_mps=(_column(range_rate_mps, "range_rate_mps", n, np.nan) + SPEED_OF_LIGHT * drift)[rows],
        system=tuple(letters[i] for i in rows),
        satellite=tuple(names[i] for i in rows),
        offsets=np.searchsorted(rows, bounds).astype(np.int64),
        time_gps=times,
        source_row=rows.astype(np.int64),
        sigma_m=None if sigma is None else sigma[rows],
        left_out=_left_out(missing, one_code, bounds, names),
    )
    return correct_measured(measured, settings)


def _checked(
    positions: FloatArray,
    ranges: FloatArray,
    sigma_m: ArrayLike | float | None,
    system: str | Sequence[str] | None,
    satellite: Sequence[str] | None,
    bounds: IntArray,
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Every epoch through the one door of epochs; names and system letters of all rows."""
    n = ranges.size
    for field, column in (("system", system), ("satellite", satellite)):
        if column is not None and not isinstance(column, str) and len(column) != n:
            raise InputError(field, f"expected one per pseudorange, {n}, got {len(column)}")
    sigma = None if sigma_m is None else np.asarray(sigma_m)
    if sigma is not None and sigma.ndim > 0 and sigma.size != n:
        raise InputError("sigma_m", f"expected one per pseudorange, {n}, got {sigma.size}")
    names: list[str] = []
    letters: list[str] = []
    for a, b in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        observed = as_epoch(
            positions[a:b],
            ranges[a:b],
            sigma if sigma is None or sigma.ndim == 0 else sigma[a:b],
            system if system is None or isinstance(system, str) else list(system[a:b]),
            None if satellite is None else list(satellite[a:b]),
            rotated=True,
        )
        names.extend(observed.name)
        letters.extend(observed.system)
    return tuple(names), tuple(letters)


def _times(given: AnyArray) -> TimeArray:
    try:
        times = np.atleast_1d(np.asarray(given, dtype="datetime64[ns]"))
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError("time_gps", "expected dates with times, in GPS time") from error
    if times.ndim != 1 or np.isnat(times).any():
        raise InputError("time_gps", "expected a date with time for every epoch, in GPS time")
    return times


def _offsets(given: AnyArray | None, n: int) -> IntArray:
    if given is None:
        return np.array([0, n], dtype=np.int64)
    bounds = np.asarray(given)
    if bounds.ndim != 1 or bounds.size < 1 or bounds.dtype.kind not in "iu":
        raise InputError("offsets", "expected whole numbers, one more than epochs")
    if bounds[0] != 0 or bounds[-1] != n or np.any(np.diff(bounds.astype(np.int64)) < 0):
        raise InputError("offsets", f"must rise from 0 to the number of pseudoranges, {n}")
    return bounds.astype(np.int64)


def _column(given: ArrayLike | None, field: str, n: int, default: float) -> FloatArray:
    if given is None:
        return np.full(n, default)
    column = as_vector(given, field)
    if column.size != n:
        raise InputError(field, f"expected one per pseudorange, {n}, got {column.size}")
    return column


def _carriers(given: ArrayLike | None, field: str, n: int) -> FloatArray | None:
    if given is None:
        return None
    column = _column(given, field, n, np.nan)
    if not np.all((column > _CARRIERS_HZ[0]) & (column < _CARRIERS_HZ[1])):
        raise InputError(field, "must lie between 1 and 3 GHz, in hertz")
    return column


def _rows_of_three(given: ArrayLike, field: str, n: int) -> FloatArray:
    try:
        rows = np.array(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(field, "expected rows of three numbers: x, y, z") from error
    if n == 0 and rows.size == 0:
        return np.empty((0, 3))
    if rows.ndim != 2 or rows.shape != (n, 3):
        raise InputError(field, f"expected a row of three numbers per pseudorange; got shape {rows.shape}")
    return rows


def _left_out(missing: BoolArray, one_code: BoolArray, bounds: IntArray, names: tuple[str, ...]) -> LeftOut:
    rows = np.flatnonzero(missing | one_code)
    reasons: tuple[LeftOutReason, ...] = tuple("missing" if missing[i] else "one_code" for i in rows)
    epoch = (np.searchsorted(bounds, rows, side="right") - 1).astype(np.int64)
    return LeftOut(epoch, tuple(names[i] for i in rows), reasons, rows.astype(np.int64))
