"""The one door for pseudoranges: an epoch checked for shape, finiteness, units and doubles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimators.arrays import ArrayLike, BoolArray, FloatArray, InputError, IntArray, as_vector
from estimators.geodesy.ellipsoid import SEMI_MAJOR_M
from estimators.gnss.snapshot.epochs import MOST_CLOCKS, MOST_SATELLITES
from estimators.gnss.systems import read_systems
from estimators.gnss.table import EpochTable

_LOWEST_ORBIT_M = SEMI_MAJOR_M + 100e3
_HIGHEST_ORBIT_M = 1e9
_KILOMETRES = 1e5
"""Ranges that are all smaller, to satellites that are farther from each other, are not in metres."""
_LARGEST_RANGE_M = 1e12
_SMALLEST_SIGMA_M, _LARGEST_SIGMA_M = 1e-6, 1e6


@dataclass(frozen=True, slots=True)
class Observed:
    """A checked epoch and the way back to the caller's rows.

    Attributes
    ----------
    table : EpochTable
        Of one epoch; the usable rows.
    rows : ndarray of int64
        The caller's row of each usable one.
    missing : ndarray of bool, shape (n,)
        The caller's rows without a range, a position or a sigma.
    name, system : tuple of str
        Of the caller's rows.
    """

    table: EpochTable
    rows: IntArray
    missing: BoolArray
    name: tuple[str, ...]
    system: tuple[str, ...]


def as_epoch(
    satellites_m: ArrayLike,
    pseudoranges_m: ArrayLike,
    sigma_m: ArrayLike | float | None,
    system: str | Sequence[str] | None,
    satellite: Sequence[str] | None,
    rotated: bool,
) -> Observed:
    """Check an epoch.

    Parameters
    ----------
    satellites_m : array_like, shape (n, 3)
    pseudoranges_m : array_like, shape (n,)
    sigma_m : array_like, shape (n,), float or None
        None is left to the weight model: all 1 here.
    system, satellite : sequence of str, shape (n,), or None
    rotated : bool

    Raises
    ------
    InputError
        If shapes disagree, a number is impossible or in another unit, or a satellite comes twice.
    """
    positions = _positions(satellites_m)
    ranges = as_vector(pseudoranges_m, "pseudoranges_m")
    n = ranges.size
    if positions.shape[0] != n:
        raise InputError(
            "satellites_m",
            f"has {positions.shape[0]} rows for {n} pseudoranges; send one per pseudorange",
        )
    if n > MOST_SATELLITES:
        raise InputError("pseudoranges_m", f"at most {MOST_SATELLITES} satellites make an epoch, got {n}")
    sigma = _sigmas(sigma_m, n)
    letters, clock = read_systems(system, n)
    if len(letters) > MOST_CLOCKS:
        raise InputError("system", f"at most {MOST_CLOCKS} systems make an epoch")
    names = _names(satellite, letters, clock, n)
    missing = ~(np.isfinite(ranges) & np.isfinite(positions).all(axis=1) & np.isfinite(sigma))
    kept = ~missing
    _check_orbits(positions, kept)
    _check_ranges(ranges, positions, kept)
    used = EpochTable(
        satellites_m=positions,
        pseudoranges_m=ranges,
        sigma_m=sigma,
        clock=clock,
        offsets=np.array([0, n], dtype=np.int64),
        letters=(letters,),
        names=names,
        rotated=bool(rotated),
    ).without(missing)
    return Observed(
        used, np.flatnonzero(kept).astype(np.int64), missing, names, tuple(letters[j] for j in clock)
    )


def _positions(given: ArrayLike) -> FloatArray:
    try:
        positions = np.array(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("satellites_m", "expected rows of three numbers: x, y, z in metres") from error
    if positions.size == 0:
        return np.empty((0, 3))
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise InputError(
            "satellites_m", f"expected rows of three numbers, x, y, z in metres; got shape {positions.shape}"
        )
    return positions


def _sigmas(given: ArrayLike | float | None, n: int) -> FloatArray:
    if given is None:
        return np.ones(n)
    array = np.full(n, given, dtype=np.float64) if np.ndim(given) == 0 else as_vector(given, "sigma_m")
    if array.size != n:
        raise InputError("sigma_m", f"has {array.size} entries, but there are {n} pseudoranges")
    wrong = np.isfinite(array) & ((array < _SMALLEST_SIGMA_M) | (array > _LARGEST_SIGMA_M))
    if np.any(wrong):
        row = int(np.argmax(wrong))
        raise InputError(
            "sigma_m",
            f"must lie between {_SMALLEST_SIGMA_M:g} and {_LARGEST_SIGMA_M:g} metres; "
            f"row {row} has {array[row]:g}",
        )
    return array


def _names(given: Sequence[str] | None, letters: tuple[str, ...], clock: IntArray, n: int) -> tuple[str, ...]:
    if given is None:
        return tuple(f"{letters[clock[i]]}?{i}" for i in range(n))
    names = tuple(str(name) for name in given)
    if len(names) != n:
        raise InputError("satellite", f"expected one name per pseudorange, {n}, got {len(names)}")
    seen: set[str] = set()
    for row, name in enumerate(names):
        if name in seen:
            raise InputError(
                "satellite",
                f"{name!r} comes again in row {row}; send one range per satellite and epoch",
            )
        seen.add(name)
    return names


def _check_orbits(positions: FloatArray, kept: BoolArray) -> None:
    radius = np.linalg.norm(positions[kept], axis=1)
    wrong = (radius < _LOWEST_ORBIT_M) | (radius > _HIGHEST_ORBIT_M)
    if np.any(wrong):
        place = int(np.argmax(wrong))
        row = int(np.flatnonzero(kept)[place])
        raise InputError(
            "satellites_m",
            f"row {row} is {radius[place]:.6g} m from the Earth's centre, which is no orbit; "
            "send Earth-centred, Earth-fixed coordinates in metres",
        )


def _check_ranges(ranges: FloatArray, positions: FloatArray, kept: BoolArray) -> None:
    known = ranges[kept]
    if np.any(np.abs(known) > _LARGEST_RANGE_M):
        row = int(np.flatnonzero(kept)[np.argmax(np.abs(known) > _LARGEST_RANGE_M)])
        raise InputError("pseudoranges_m", f"row {row} is {ranges[row]:.3g} m, no receiver clock errs so far")
    if known.size > 1 and np.ptp(known) < _KILOMETRES and np.max(np.abs(known)) < _KILOMETRES:
        spread = float(np.max(np.linalg.norm(positions[kept] - positions[kept][0], axis=1)))
        if spread > 1e7:
            raise InputError(
                "pseudoranges_m",
                "are all below 100 km while the satellites are thousands of kilometres apart; "
                "send metres, not kilometres or seconds",
            )
