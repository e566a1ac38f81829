"""What callers hand over as a series: :class:`Epoch` after epoch, or the columns of :class:`Epochs`."""

from __future__ import annotations

import datetime as dt
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar, overload

import numpy as np
import numpy.typing as npt

from estimators.arrays import ArrayLike, FloatArray, InputError, IntArray, as_column
from estimators.gnss.observed_epochs import ObservedEpochs

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Epoch:
    """Pseudoranges that were received at the same time.

    Attributes
    ----------
    time : float, datetime or datetime64
        Seconds, or a point in time.
    satellites_m : array_like, shape (n, 3)
        Satellite positions when they transmitted, Earth-centred and Earth-fixed, in metres.
    pseudoranges_m : array_like, shape (n,)
        Corrected for satellite clock, ionosphere and troposphere; NaN where missing.
    sigma_m : array_like, shape (n,), float or None
        Noise of each; None is by elevation, or by signal strength where that is given.
    system : str, sequence of str or None
        Letter or name of each satellite's system; None counts all as one.
    satellite : sequence of str or None
        Names; without them nothing connects a satellite with itself in another epoch.
    cn0_dbhz : array_like, shape (n,), or None
        Signal strength.
    range_rate_mps : array_like, shape (n,), or None
        How fast the ranges grow, by Doppler, corrected for the drift of the satellite clock; NaN where
        unknown.
    satellite_velocity_mps : array_like, shape (n, 3), or None
        Earth-centred, Earth-fixed, in the axes of ``satellites_m``; needed with ``range_rate_mps``.
    """

    time: float | dt.datetime | np.datetime64
    satellites_m: ArrayLike
    pseudoranges_m: ArrayLike
    sigma_m: ArrayLike | float | None = None
    system: str | Sequence[str] | None = None
    satellite: Sequence[str] | None = None
    cn0_dbhz: ArrayLike | None = None
    range_rate_mps: ArrayLike | None = None
    satellite_velocity_mps: ArrayLike | None = None


@dataclass(frozen=True, slots=True)
class Epochs(Sequence[Epoch]):
    """Epochs as columns: a row per satellite and epoch, and where each epoch begins.

    Attributes
    ----------
    time : ndarray, shape (epochs,)
        Numbers or datetime64.
    offsets : ndarray of int64, shape (epochs + 1,)
        Epoch k is rows ``offsets[k]:offsets[k + 1]``.
    satellites_m, pseudoranges_m, sigma_m, system, satellite, cn0_dbhz, range_rate_mps, satellite_velocity_mps
        One entry per row, as in :class:`Epoch`.
    source_row : ndarray of int64, shape (rows,)
        Row of the caller's table.

    Examples
    --------
    >>> import numpy as np
    >>> epochs = Epochs.from_columns(
    ...     time=[0.0, 0.0, 1.0], satellites_m=np.full((3, 3), 2e7), pseudoranges_m=[2e7, 2.1e7, 2.2e7]
    ... )
    >>> len(epochs), epochs[0].pseudoranges_m.tolist()
    (2, [20000000.0, 21000000.0])
    """

    time: npt.NDArray[Any]
    offsets: IntArray
    satellites_m: FloatArray
    pseudoranges_m: FloatArray
    source_row: IntArray
    sigma_m: FloatArray | None = None
    system: tuple[str, ...] | None = None
    satellite: tuple[str, ...] | None = None
    cn0_dbhz: FloatArray | None = None
    range_rate_mps: FloatArray | None = None
    satellite_velocity_mps: FloatArray | None = None

    @classmethod
    def from_columns(
        cls,
        *,
        time: ArrayLike,
        satellites_m: ArrayLike,
        pseudoranges_m: ArrayLike,
        sigma_m: ArrayLike | None = None,
        system: Sequence[str] | None = None,
        satellite: Sequence[str] | None = None,
        cn0_dbhz: ArrayLike | None = None,
        range_rate_mps: ArrayLike | None = None,
        satellite_velocity_mps: ArrayLike | None = None,
    ) -> Epochs:
        """Rows of equal time are an epoch; epochs come in the order of their first rows.

        Parameters
        ----------
        time : array_like, shape (rows,)
            Seconds or points in time.
        satellites_m : array_like, shape (rows, 3)
        pseudoranges_m, sigma_m, cn0_dbhz, range_rate_mps : array_like, shape (rows,)
        system, satellite : sequence of str, length rows
        satellite_velocity_mps : array_like, shape (rows, 3)

        Raises
        ------
        InputError
            If a column is not as long as ``time``, or a time is missing.
        """
        column = as_column(time, "time")
        if column.dtype.kind == "O":
            column = np.asarray(column.tolist())
        _, first, epoch = np.unique(column, return_index=True, return_inverse=True)
        rank = np.argsort(np.argsort(first, kind="stable"), kind="stable")
        of_row = rank[epoch]
        rows = np.argsort(of_row, kind="stable").astype(np.int64)
        n = column.size

        def numbers(given: ArrayLike, field: str, width: int = 0) -> FloatArray:
            try:
                array = np.asarray(given, dtype=np.float64)
            except (TypeError, ValueError) as error:
                raise InputError(field, "expected numbers") from error
            if array.shape != ((n, width) if width else (n,)):
                raise InputError(field, f"expected {n} rows, as many as times; got shape {array.shape}")
            return np.ascontiguousarray(array[rows])

        def maybe(given: ArrayLike | None, field: str, width: int = 0) -> FloatArray | None:
            return None if given is None else numbers(given, field, width)

        def words(given: Sequence[str] | None, field: str) -> tuple[str, ...] | None:
            if given is None:
                return None
            if isinstance(given, str) or len(given) != n:
                raise InputError(field, f"expected {n} entries, as many as times")
            listed = [str(word) for word in given]
            return tuple(listed[row] for row in rows)

        return cls(
            time=column[np.sort(first)],
            offsets=np.concatenate([[0], np.cumsum(np.bincount(of_row, minlength=first.size))]).astype(
                np.int64
            ),
            satellites_m=numbers(satellites_m, "satellites_m", 3),
            pseudoranges_m=numbers(pseudoranges_m, "pseudoranges_m"),
            source_row=rows,
            sigma_m=maybe(sigma_m, "sigma_m"),
            system=words(system, "system"),
            satellite=words(satellite, "satellite"),
            cn0_dbhz=maybe(cn0_dbhz, "cn0_dbhz"),
            range_rate_mps=maybe(range_rate_mps, "range_rate_mps"),
            satellite_velocity_mps=maybe(satellite_velocity_mps, "satellite_velocity_mps", 3),
        )

    @classmethod
    def from_observed(cls, observed: ObservedEpochs) -> Epochs:
        """Take epochs that were corrected here, from RINEX files or raw pseudoranges.

        Parameters
        ----------
        observed : ObservedEpochs

        Returns
        -------
        Epochs
            In GPS time; the sigmas are those of the weight model chosen there.
        """
        table = observed.table
        counts = np.diff(table.offsets)
        letters = [table.letters[k] for k in np.repeat(np.arange(len(table)), counts)]
        return cls(
            time=observed.time_gps,
            offsets=table.offsets,
            satellites_m=table.satellites_m,
            pseudoranges_m=table.pseudoranges_m,
            source_row=observed.source_row,
            sigma_m=table.sigma_m,
            system=tuple(present[clock] for present, clock in zip(letters, table.clock, strict=True)),
            satellite=table.names,
            range_rate_mps=observed.range_rate_mps,
            satellite_velocity_mps=observed.velocities_mps,
        )

    def __len__(self) -> int:
        return self.offsets.size - 1

    @overload
    def __getitem__(self, k: int) -> Epoch: ...
    @overload
    def __getitem__(self, k: slice) -> Sequence[Epoch]: ...
    def __getitem__(self, k: int | slice) -> Epoch | Sequence[Epoch]:
        """One epoch, or a list of them."""
        if isinstance(k, slice):
            return [self[j] for j in range(*k.indices(len(self)))]
        place = range(len(self))[k]
        rows = slice(int(self.offsets[place]), int(self.offsets[place + 1]))
        return Epoch(
            time=self.time[place],
            satellites_m=self.satellites_m[rows],
            pseudoranges_m=self.pseudoranges_m[rows],
            sigma_m=None if self.sigma_m is None else self.sigma_m[rows],
            system=None if self.system is None else self.system[rows],
            satellite=None if self.satellite is None else self.satellite[rows],
            cn0_dbhz=None if self.cn0_dbhz is None else self.cn0_dbhz[rows],
            range_rate_mps=None if self.range_rate_mps is None else self.range_rate_mps[rows],
            satellite_velocity_mps=(
                None if self.satellite_velocity_mps is None else self.satellite_velocity_mps[rows]
            ),
        )

    def __iter__(self) -> Iterator[Epoch]:
        return (self[k] for k in range(len(self)))
