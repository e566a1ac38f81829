"""Positions that repeat exactly: by chance of rounding, or because nothing was measured.

How often rounded coordinates repeat by chance shows in the rows where only one of them does: if a share a of
the steps leaves the latitude alone and a share b the longitude, a b leaves both. Runs of repeats that are far
less likely than that are no measurements, but an old one told again. Where steps are no longer than the unit
of rounding, all repeats are honest: the track has not gone that far.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import BoolArray, FloatArray

_CHANCE = 1e-3
"""A run of repeats less likely than this was not measured."""
_UNITS = 2.5
_SAME_M, _SOME = 1e-3, 0.05
"""Steps are none below a millimetre; a twentieth is more than a few."""


def repeats(latitude_deg: FloatArray, longitude_deg: FloatArray) -> BoolArray:
    """Mark rows that repeat the position before them without having measured it.

    Parameters
    ----------
    latitude_deg, longitude_deg : ndarray, shape (n,)
        In order of time, as they came.

    Returns
    -------
    ndarray of bool, shape (n,)

    Examples
    --------
    >>> moving = np.arange(20.0) ** 1.5
    >>> repeats(np.append(moving, moving[[-1, -1]]), np.append(moving, moving[[-1, -1]]))[-3:].tolist()
    [False, True, True]
    """
    n = latitude_deg.size
    same_latitude = latitude_deg[1:] == latitude_deg[:-1]
    same_longitude = longitude_deg[1:] == longitude_deg[:-1]
    both = same_latitude & same_longitude
    marked = np.zeros(n, dtype=np.bool_)
    if not both.any():
        return marked
    if not (_are_fine(latitude_deg) or _are_fine(longitude_deg)):
        return marked
    moved = n - 1 - np.count_nonzero(both)
    if moved == 0:
        return marked
    share_latitude = (np.count_nonzero(same_latitude & ~both) + 1.0) / (moved + 2.0)
    share_longitude = (np.count_nonzero(same_longitude & ~both) + 1.0) / (moved + 2.0)
    chance = share_latitude * share_longitude
    for first, stop in runs_of(both):
        if chance ** (stop - first) < _CHANCE:
            marked[first + 1 : stop + 1] = True
    return marked


def rounding_of(fixes: FloatArray) -> float:
    """Tell the unit to which coordinates are rounded: where some repeat, the least step.

    Parameters
    ----------
    fixes : ndarray, shape (n, 2)
        Metres.

    Returns
    -------
    float
        Metres; 0 where hardly any coordinate repeats.
    """
    units = [0.0]
    for steps in np.abs(np.diff(fixes, axis=0)).T:
        moved = steps[steps > _SAME_M]
        if 0 < moved.size <= (1.0 - _SOME) * steps.size:
            units.append(float(np.quantile(moved, _SOME)))
    return max(units)


def _are_fine(degrees: FloatArray) -> bool:
    """Whether most steps are several units of rounding long."""
    steps = np.abs(np.diff(degrees))
    steps = steps[steps > 0.0]
    return bool(steps.size) and float(np.median(steps)) > _UNITS * float(steps.min())


def runs_of(marked: BoolArray) -> list[tuple[int, int]]:
    """First and last row + 1 of each run of marked rows."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], marked, [False]]).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
