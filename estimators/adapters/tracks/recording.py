"""A recorded track as columns: :class:`Recording`, what every reader returns and every writer takes.

One row per row of the file, in its order. A row that cannot be read stays, with NaN or NaT in place of what
is wrong and the reason in ``fault``: whoever sends 1,000 fixes gets 1,000 labels back.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from enum import IntEnum
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from estimators.arrays import CodeArray, FloatArray, InputError, IntArray
from estimators.trajectories.ellipse import accuracy_of_ellipse

Moments: TypeAlias = npt.NDArray[np.datetime64]
Offsets: TypeAlias = npt.NDArray[np.int16]

FIELD = "track"
"""Name of the file in errors."""


class RowFault(IntEnum):
    """Why a row holds NaN or NaT; the first that applies, in this order."""

    none = 0
    position_missing = 1
    position_unreadable = 2
    time_missing = 3
    time_unreadable = 4


@dataclass(frozen=True, slots=True)
class Recording:
    """Fixes of one or more devices, in input order.

    Parameters
    ----------
    form : str
        The format that they were read from: ``"gpx"``, ``"csv"``, ...
    time : ndarray, shape (n,)
        ``datetime64[ns]`` in UTC, NaT where there is none; or float64 seconds since any zero, then NaN.
    lat, lon : ndarray of float64, shape (n,)
        Degrees, WGS 84; -90 to 90 and -180 to 180, NaN where there is no position.
    fault : ndarray of uint8, shape (n,)
        :class:`RowFault` of each row.
    utc_offset_minutes : ndarray of int16, shape (n,), optional
        Of the zone in which a time was written, east positive. None: all of them in UTC.
    height_m : ndarray of float64, shape (n,), optional
        As the format means it, mostly above the geoid. Columns from here on are NaN where a row has none,
        and None where no row has one.
    accuracy_m : ndarray of float64, shape (n,), optional
        Radius that holds the truth with 68 %.
    ellipse_major_m, ellipse_minor_m, ellipse_bearing_deg : ndarray of float64, shape (n,), optional
        Half axes of the error ellipse at one sigma, and the bearing of the longer, clockwise from north.
    speed_mps, bearing_deg : ndarray of float64, shape (n,), optional
        Speed over ground, and course clockwise from north, 0 to 360.
    hdop, satellites : ndarray of float64, shape (n,), optional
        Dilution of precision, and number of satellites used.
    device : ndarray of int64, shape (n,), optional
        Place of the row's device in ``devices``. None: one device.
    devices : tuple of str
        Names of the devices.
    segment : ndarray of int64, shape (n,), optional
        Number of the piece of track, from 0; between pieces the format knows of a gap. None: one piece.
    left_out : int
        Records that carry no row: NMEA sentences with a wrong checksum.

    Raises
    ------
    InputError
        If the columns differ in length.

    Examples
    --------
    >>> import numpy as np
    >>> track = Recording("csv", np.array([0.0, 1.0]), np.zeros(2), np.zeros(2), np.zeros(2, dtype=np.uint8))
    >>> len(track)
    2
    """

    form: str
    time: Moments | FloatArray
    lat: FloatArray
    lon: FloatArray
    fault: CodeArray
    utc_offset_minutes: Offsets | None = None
    height_m: FloatArray | None = None
    accuracy_m: FloatArray | None = None
    ellipse_major_m: FloatArray | None = None
    ellipse_minor_m: FloatArray | None = None
    ellipse_bearing_deg: FloatArray | None = None
    speed_mps: FloatArray | None = None
    bearing_deg: FloatArray | None = None
    hdop: FloatArray | None = None
    satellites: FloatArray | None = None
    device: IntArray | None = None
    devices: tuple[str, ...] = ()
    segment: IntArray | None = None
    left_out: int = 0

    def __post_init__(self) -> None:
        for field in fields(self):
            column = getattr(self, field.name)
            if isinstance(column, np.ndarray) and column.shape != self.time.shape:
                raise InputError(
                    field.name, f"has {column.size} rows where time has {self.time.size}; send one per fix"
                )

    def __len__(self) -> int:
        return int(self.time.size)

    @property
    def radius_m(self) -> FloatArray | None:
        """Radius that holds 68 % of each row, for ``accuracy_m`` of :func:`estimators.clean_trajectory`.

        As the format reports it, or where a row has none, the circle of its error ellipse; None if no row
        has either.
        """
        if self.ellipse_major_m is None or self.ellipse_minor_m is None:
            return self.accuracy_m
        circle = accuracy_of_ellipse(self.ellipse_major_m, self.ellipse_minor_m)
        if self.accuracy_m is None:
            return circle
        return np.where(np.isnan(self.accuracy_m), circle, self.accuracy_m)

    def part(self, rows: slice | IntArray) -> Recording:
        """Give some of the rows; a slice is a view, nothing is copied."""
        columns: dict[str, Any] = {
            field.name: column[rows]
            for field in fields(self)
            if isinstance(column := getattr(self, field.name), np.ndarray)
        }
        return replace(self, **columns)

    def device_names(self) -> list[str | None]:
        """Name of the device of each row; None where the file names none."""
        if self.device is None:
            return [self.devices[0] if self.devices else None] * len(self)
        names = np.array(self.devices, dtype=object)[self.device]
        return [str(name) for name in names]
