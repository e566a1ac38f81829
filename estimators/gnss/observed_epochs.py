"""Epochs as receivers observed them, corrected and ready to be solved: :class:`ObservedEpochs`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.calendar import TimeArray
from estimators.gnss.table import EpochTable

LeftOutReason = Literal["masked", "missing", "one_code", "unhealthy", "no_ephemeris"]


@dataclass(frozen=True, slots=True)
class LeftOut:
    """Observations that take no part; one entry each, by epoch.

    Attributes
    ----------
    epoch : ndarray of int64, shape (m,)
    satellite : tuple of str
    reason : tuple of str
        ``masked``: under the elevation mask; ``missing``: no range or no satellite position; ``one_code``:
        the second code is missing; ``unhealthy``: so the navigation message says; ``no_ephemeris``: none
        near enough in time.
    source_row : ndarray of int64, shape (m,)
    """

    epoch: IntArray
    satellite: tuple[str, ...]
    reason: tuple[LeftOutReason, ...]
    source_row: IntArray

    def __len__(self) -> int:
        return len(self.satellite)


@dataclass(frozen=True, slots=True)
class ObservedEpochs:
    """Corrected pseudoranges of epochs in the order given, with what was corrected.

    Attributes
    ----------
    table : EpochTable
        Corrected, satellite positions in the frame of reception. An epoch that lost all its satellites is
        there, without rows.
    time_gps, time_utc : ndarray of datetime64[ns], shape (epochs,)
        Reception by the receiver's clock.
    elevation_deg, azimuth_deg : ndarray of float64, shape (rows,)
        From a rough position; NaN where none could be found in the whole input.
    cn0_dbhz : ndarray of float64, shape (rows,)
        Signal strength; NaN where unknown.
    raw_m : ndarray of float64, shape (rows,)
        As measured: the code, or the combination of two.
    range_rate_mps : ndarray of float64, shape (rows,)
        How fast the range grows, by Doppler, corrected for the drift of the satellite clock; NaN where
        unknown.
    velocities_mps : ndarray of float64, shape (rows, 3)
        Of the satellites, in the axes of ``table.satellites_m``; NaN where unknown.
    satellite_clock_m : ndarray of float64, shape (rows,)
        Added to the measured range: satellite clock without the group delay of the signal.
    ionosphere_m, troposphere_m : ndarray of float64, shape (rows,)
        Subtracted.
    source_row : ndarray of int64, shape (rows,)
        Which observation of the input, counted from 0.
    left_out : LeftOut
    ionosphere : str
        ``klobuchar``, ``dual`` or ``none``: how its delay was removed.
    """

    table: EpochTable
    time_gps: TimeArray
    time_utc: TimeArray
    elevation_deg: FloatArray
    azimuth_deg: FloatArray
    cn0_dbhz: FloatArray
    raw_m: FloatArray
    range_rate_mps: FloatArray
    velocities_mps: FloatArray
    satellite_clock_m: FloatArray
    ionosphere_m: FloatArray
    troposphere_m: FloatArray
    source_row: IntArray
    left_out: LeftOut
    ionosphere: Literal["klobuchar", "dual", "none"]

    def __len__(self) -> int:
        return len(self.table)

    def epoch(self, k: int) -> EpochTable:
        """One epoch as a table of its own."""
        return self.table.epoch(k)
