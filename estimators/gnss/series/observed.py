"""The one door for a series: epochs checked one by one, put in order of time, and laid out as one table."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from estimators.arrays import ArrayLike, BoolArray, FloatArray, InputError, IntArray, as_vector
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.geodesy.local_frame import azimuth_elevation, enu_axes
from estimators.gnss.observations import Observed, as_epoch
from estimators.gnss.series.epochs import Epoch
from estimators.gnss.snapshot.problem import solve_problem
from estimators.gnss.systems import SYSTEMS
from estimators.gnss.table import EpochTable
from estimators.gnss.weighting import elevation_sigma, strength_sigma
from estimators.time_axis import as_times

MASKED, MISSING = 1, 2
"""Why a row takes no part."""
_LOOKS = 15
"""Epochs from whose least squares the elevations of the whole are seen; a kilometre changes them by .003."""


@dataclass(frozen=True, slots=True)
class Observations:
    """A checked series, in order of time, and the way back to the caller's epochs and rows.

    Attributes
    ----------
    table : EpochTable
        The usable rows.
    seconds : ndarray of float64, shape (epochs,)
        Since the first epoch, in order.
    system : ndarray of int64, shape (rows,)
        Index into ``letters``.
    letters : tuple of str
        Systems of the series.
    range_rate_mps, velocity_mps : ndarray, shape (rows,) and (rows, 3)
        NaN where unknown.
    previous : ndarray of int64, shape (rows,)
        Row of the same satellite in the epoch before; -1 where there is none.
    order : ndarray of int64, shape (epochs,)
        The caller's epoch of each.
    source : ndarray of int64, shape (rows,)
        The caller's row of each.
    time : ndarray, shape (epochs,)
        The caller's, in the caller's order.
    offsets : ndarray of int64, shape (epochs + 1,)
        Of the caller's rows.
    left_out : ndarray of int64, one entry per row of the caller
        0, ``MASKED`` or ``MISSING``.
    name, row_system : tuple of str
        Of the caller's rows.
    """

    table: EpochTable
    seconds: FloatArray
    system: IntArray
    letters: tuple[str, ...]
    range_rate_mps: FloatArray
    velocity_mps: FloatArray
    previous: IntArray
    order: IntArray
    source: IntArray
    time: npt.NDArray[Any]
    offsets: IntArray
    left_out: IntArray
    name: tuple[str, ...]
    row_system: tuple[str, ...]

    def __len__(self) -> int:
        return self.seconds.size

    def pick(self, epochs: IntArray) -> EpochTable:
        """Take some of the epochs as a table."""
        table = self.table
        rows = np.concatenate(
            [np.arange(table.offsets[k], table.offsets[k + 1]) for k in epochs] or [np.zeros(0, np.int64)]
        ).astype(np.int64)
        return EpochTable(
            satellites_m=np.ascontiguousarray(table.satellites_m[rows]),
            pseudoranges_m=table.pseudoranges_m[rows],
            sigma_m=table.sigma_m[rows],
            clock=table.clock[rows],
            offsets=np.concatenate([[0], np.cumsum(np.diff(table.offsets)[epochs])]).astype(np.int64),
            letters=tuple(table.letters[k] for k in epochs),
            names=tuple(table.names[row] for row in rows),
            rotated=table.rotated,
        )


def observe(epochs: Iterable[Epoch], rotated: bool, mask_deg: float | None) -> Observations:
    """Check a series.

    Parameters
    ----------
    epochs : iterable of Epoch
    rotated : bool
        Whether satellite positions are in the frame of the time of reception.
    mask_deg : float or None
        Satellites below take no part.

    Raises
    ------
    InputError
        As :func:`estimators.gnss.observations.as_epoch`, with the number of the epoch; also if there are no
        epochs, or times that are missing or of mixed kinds.
    """
    given = list(epochs)
    if not given:
        raise InputError("epochs", "there are none; send at least one")
    time, seconds = _times(given)
    order = np.argsort(seconds, kind="stable").astype(np.int64)
    observed: list[Observed] = [_checked(given[k], int(k), rotated) for k in order]
    table = _joined([one.table for one in observed], rotated)
    sizes = np.array([np.shape(epoch.pseudoranges_m)[0] for epoch in given], dtype=np.int64)
    offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    source = np.concatenate([one.rows + offsets[k] for one, k in zip(observed, order, strict=True)])
    left_out = np.full(int(offsets[-1]), MISSING, dtype=np.int64)
    left_out[source] = 0
    elevation = None
    plain = np.concatenate(
        [np.full(one.rows.size, given[k].sigma_m is None) for one, k in zip(observed, order, strict=True)]
    ).astype(np.bool_)
    if plain.any() or mask_deg is not None:
        elevation = _elevations(table)
    strength = np.concatenate(
        [_extra(given[k].cn0_dbhz, one, "cn0_dbhz", int(k)) for one, k in zip(observed, order, strict=True)]
    )
    letter_of = [table.letters[e][c] for e, c in zip(_epoch_of(table), table.clock, strict=True)]
    if elevation is not None and plain.any():
        sigma = _weighted(table.sigma_m, plain, elevation, strength, tuple(letter_of))
        table = dataclasses.replace(table, sigma_m=sigma)
    rate = np.concatenate(
        [
            _extra(given[k].range_rate_mps, one, "range_rate_mps", int(k))
            for one, k in zip(observed, order, strict=True)
        ]
    )
    velocity = np.concatenate(
        [_velocities(given[k], one, int(k)) for one, k in zip(observed, order, strict=True)]
    )
    kept = np.ones(source.size, dtype=np.bool_)
    if elevation is not None and mask_deg is not None:
        kept = ~(elevation < mask_deg)
        left_out[source[~kept]] = MASKED
        table = table.without(~kept)
    letters = tuple(letter for letter in SYSTEMS if letter in set(letter_of))
    name, row_system = _caller_rows(observed, order, offsets)
    return Observations(
        table=table,
        seconds=np.ascontiguousarray(seconds[order] - seconds[order[0]]),
        system=np.array(
            [letters.index(letter) for letter, stays in zip(letter_of, kept, strict=True) if stays],
            dtype=np.int64,
        ),
        letters=letters,
        range_rate_mps=np.ascontiguousarray(rate[kept]),
        velocity_mps=np.ascontiguousarray(velocity[kept]),
        previous=_previous(table, [given[int(k)].satellite is not None for k in order]),
        order=order,
        source=source[kept],
        time=time,
        offsets=offsets,
        left_out=left_out,
        name=name,
        row_system=row_system,
    )


def _times(given: list[Epoch]) -> tuple[npt.NDArray[Any], FloatArray]:
    try:
        seconds, _, column = as_times(cast("ArrayLike", [epoch.time for epoch in given]))
    except InputError as error:
        raise InputError("time", error.message) from error
    except TypeError as error:
        raise InputError("time", "send seconds for all epochs, or points in time for all") from error
    if not np.isfinite(seconds).all():
        where = int(np.argmax(~np.isfinite(seconds)))
        raise InputError("time", f"epoch {where} has no time")
    return column, seconds


def _checked(epoch: Epoch, k: int, rotated: bool) -> Observed:
    try:
        return as_epoch(
            epoch.satellites_m, epoch.pseudoranges_m, epoch.sigma_m, epoch.system, epoch.satellite, rotated
        )
    except InputError as error:
        raise InputError(error.field, f"epoch {k}: {error.message}") from error


def _joined(tables: list[EpochTable], rotated: bool) -> EpochTable:
    return EpochTable(
        satellites_m=np.ascontiguousarray(np.concatenate([t.satellites_m for t in tables])),
        pseudoranges_m=np.concatenate([t.pseudoranges_m for t in tables]),
        sigma_m=np.concatenate([t.sigma_m for t in tables]),
        clock=np.concatenate([t.clock for t in tables]),
        offsets=np.concatenate([[0], np.cumsum([t.pseudoranges_m.size for t in tables])]).astype(np.int64),
        letters=tuple(t.letters[0] for t in tables),
        names=tuple(name for t in tables for name in t.names),
        rotated=rotated,
    )


def _epoch_of(table: EpochTable) -> IntArray:
    return np.repeat(np.arange(len(table)), np.diff(table.offsets))


def _extra(given: ArrayLike | None, observed: Observed, field: str, k: int) -> FloatArray:
    """Take a column at the usable rows; NaN where it is not given."""
    if given is None:
        return np.full(observed.rows.size, np.nan)
    column = as_vector(given, field)
    if column.size != observed.missing.size:
        raise InputError(field, f"epoch {k}: expected one per pseudorange, {observed.missing.size}")
    return column[observed.rows]


def _velocities(epoch: Epoch, observed: Observed, k: int) -> FloatArray:
    if epoch.satellite_velocity_mps is None:
        if epoch.range_rate_mps is not None:
            raise InputError("satellite_velocity_mps", f"epoch {k}: is needed to make use of range_rate_mps")
        return np.full((observed.rows.size, 3), np.nan)
    array = np.asarray(epoch.satellite_velocity_mps, dtype=np.float64)
    if array.shape != (observed.missing.size, 3):
        raise InputError(
            "satellite_velocity_mps", f"epoch {k}: expected {observed.missing.size} rows of three numbers"
        )
    return array[observed.rows]


def _elevations(table: EpochTable) -> FloatArray:
    """Elevations in degrees, as seen from where least squares of the nearest looked-at epoch lies."""
    enough = np.flatnonzero(np.diff(table.offsets) >= 3 + np.array([len(x) for x in table.letters]))
    picks = (
        enough[np.unique(np.linspace(0, enough.size - 1, _LOOKS).astype(np.int64))] if enough.size else enough
    )
    out = np.full(table.pseudoranges_m.size, 90.0)
    places = [(int(k), problem) for k in picks if (problem := solve_problem(table.epoch(int(k)))) is not None]
    if not places:
        return out
    near = np.abs(np.arange(len(table))[:, None] - np.array([k for k, _ in places])).argmin(axis=1)
    for which, (_, problem) in enumerate(places):
        rows = np.repeat(near == which, np.diff(table.offsets))
        place = np.ascontiguousarray(problem.state[:3])
        lat, lon, _ = to_geodetic(place).tolist()
        out[rows] = azimuth_elevation((table.satellites_m[rows] - place) @ enu_axes(lat, lon).T)[1]
    return out


def _weighted(
    sigma: FloatArray, plain: BoolArray, elevation: FloatArray, strength: FloatArray, letters: tuple[str, ...]
) -> FloatArray:
    """Sigmas of the rows that have none: by strength where it is known, else by elevation."""
    known = np.isfinite(strength)
    if np.any(known & ((strength < 0.0) | (strength > 80.0))):
        raise InputError("cn0_dbhz", "must lie between 0 and 80 dB-Hz")
    by_elevation = elevation_sigma(elevation, letters)
    by_strength = strength_sigma(np.where(known, strength, 40.0), elevation)
    return np.where(plain, np.where(known, by_strength, by_elevation), sigma)


def _previous(table: EpochTable, named: list[bool]) -> IntArray:
    """Rows of the same satellites in the epochs before."""
    out = np.full(table.pseudoranges_m.size, -1, dtype=np.int64)
    before: dict[str, int] = {}
    for k in range(len(table)):
        rows = range(int(table.offsets[k]), int(table.offsets[k + 1]))
        names = table.names[rows.start : rows.stop] if named[k] else ()
        for row, name in zip(rows, names, strict=False):
            out[row] = before.get(name, -1)
        before = dict(zip(names, rows, strict=False))
    return out


def _caller_rows(
    observed: list[Observed], order: IntArray, offsets: IntArray
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    names, systems = [""] * int(offsets[-1]), [""] * int(offsets[-1])
    for one, k in zip(observed, order, strict=True):
        names[offsets[k] : offsets[k + 1]] = one.name
        systems[offsets[k] : offsets[k + 1]] = one.system
    return tuple(names), tuple(systems)
