"""Columns as a reader found them to a :class:`Recording`: ranges checked, faults of rows named."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from estimators.adapters.tracks.recording import FIELD, Moments, Offsets, Recording, RowFault
from estimators.arrays import BoolArray, FloatArray, InputError, IntArray

RANGES: dict[str, tuple[float, float]] = {
    "height_m": (-12_000.0, 1e8),
    "accuracy_m": (1e-6, 1e8),
    "ellipse_major_m": (1e-6, 1e8),
    "ellipse_minor_m": (1e-6, 1e8),
    "ellipse_bearing_deg": (-360.0, 360.0),
    "speed_mps": (0.0, 1e5),
    "bearing_deg": (-360.0, 360.0),
    "hdop": (1e-6, 1e3),
    "satellites": (0.0, 1e3),
}
"""Optional columns and what they can hold: from below the deepest sea to beyond the highest orbits. A value
outside is taken as missing, since receivers write -1, 0 or 99.99 for what they do not know."""


def assemble(
    form: str,
    *,
    time: Moments | FloatArray,
    lat: FloatArray,
    lon: FloatArray,
    time_unreadable: BoolArray | None = None,
    position_unreadable: BoolArray | None = None,
    offsets: Offsets | None = None,
    measured: Mapping[str, FloatArray] | None = None,
    device: IntArray | None = None,
    devices: tuple[str, ...] = (),
    segment: IntArray | None = None,
    left_out: int = 0,
) -> Recording:
    """Check the ranges of columns and name the fault of each row.

    Parameters
    ----------
    form : str
    time : ndarray, shape (n,)
    lat, lon : ndarray of float64, shape (n,)
        Degrees as written; longitudes to 360 are brought to -180 to 180. Taken over and changed.
    time_unreadable, position_unreadable : ndarray of bool, shape (n,), optional
        Rows where something stands that is no time, or no number.
    offsets : ndarray of int16, shape (n,), optional
        Minutes east of UTC.
    measured : mapping of str to ndarray of float64, optional
        Columns named in :data:`RANGES`; NaN where missing.
    device : ndarray of int64, shape (n,), optional
        Place of each row's device in ``devices``, as :func:`code_names` gives both.
    devices : tuple of str
    segment : ndarray of int64, shape (n,), optional
    left_out : int

    Returns
    -------
    Recording

    Raises
    ------
    InputError
        If there are no rows, or no row has a time.

    Examples
    --------
    >>> import numpy as np
    >>> lat, lon = np.array([91.0, 50.0]), np.array([7.0, 359.0])
    >>> track = assemble("csv", time=np.array([0.0, 1.0]), lat=lat, lon=lon)
    >>> track.lon, [RowFault(code).name for code in track.fault]
    (array([nan, -1.]), ['position_unreadable', 'none'])
    """
    n = time.size
    if n == 0:
        raise InputError(FIELD, "has no track points")
    timeless = np.isnat(time) if time.dtype.kind == "M" else ~np.isfinite(time)
    if timeless.all():
        raise InputError("time", "no point of the track has a time that can be read; export it with times")
    absent = np.isnan(lat) | np.isnan(lon)
    with np.errstate(invalid="ignore"):
        inside = (lat >= -90.0) & (lat <= 90.0) & (lon >= -180.0) & (lon <= 360.0)
    wrong = ~absent & ~inside
    if position_unreadable is not None:
        wrong |= position_unreadable
    fault = np.zeros(n, dtype=np.uint8)
    fault[timeless] = RowFault.time_missing
    if time_unreadable is not None:
        fault[timeless & time_unreadable] = RowFault.time_unreadable
    fault[absent] = RowFault.position_missing
    fault[wrong] = RowFault.position_unreadable
    # In place, since ten million rows have to fit into memory with nothing to spare.
    lat[absent | wrong] = np.nan
    lon[absent | wrong] = np.nan
    np.subtract(lon, 360.0, out=lon, where=lon > 180.0)
    several_pieces = segment is not None and bool(np.any(segment != segment[0]))
    return Recording(
        form,
        np.where(timeless, np.nan, time) if time.dtype.kind != "M" else time,
        lat,
        lon,
        fault,
        utc_offset_minutes=None if offsets is None or not offsets.any() else offsets,
        device=device if len(devices) > 1 else None,
        devices=devices,
        segment=segment if several_pieces else None,
        left_out=left_out,
        **_sound(measured or {}),
    )


def _sound(measured: Mapping[str, FloatArray]) -> dict[str, Any]:
    """Measured columns with values out of range as NaN, without the empty ones."""
    kept: dict[str, Any] = {}
    for name, column in measured.items():
        low, high = RANGES[name]
        with np.errstate(invalid="ignore"):
            values = np.where((column >= low) & (column <= high), column, np.nan)
        if name.endswith("bearing_deg"):
            values = np.mod(values, 360.0)
        if not np.isnan(values).all():
            kept[name] = values
    return kept


def code_names(
    names: Iterable[str | None], known: dict[str, int] | None = None
) -> tuple[IntArray, tuple[str, ...]]:
    """Place of each name among the different ones, and these in order of first appearance.

    Parameters
    ----------
    names : iterable of str or None
    known : dict of str to int, optional
        Names that were seen before and their places; it grows.

    Examples
    --------
    >>> code_names(["bus 7", "bus 3", "bus 7"])
    (array([0, 1, 0]), ('bus 7', 'bus 3'))
    """
    places = {} if known is None else known
    codes = np.array([places.setdefault(name or "", len(places)) for name in names], dtype=np.int64)
    return codes, tuple(places)
