"""The answer to a series of epochs: :class:`Fixes`, its columns and its parts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.gnss.fix import Geodetic, SatelliteStatus
from estimators.gnss.series.choice import Motion, Surroundings
from estimators.notices import Notice

if TYPE_CHECKING:
    import pandas as pd

EpochStatus = Literal[
    "solved", "bridged", "too_few_satellites", "undetermined_geometry", "implausible_position"
]
"""``bridged``: too few satellites of its own; the position follows from the epochs around it."""


@dataclass(frozen=True, slots=True)
class SeriesSatellites:
    """One entry per input row, in input order.

    Attributes
    ----------
    epoch : ndarray of int64, shape (rows,)
    name, system : tuple of str
    status : tuple of str
        ``used``, ``excluded``, ``untestable`` (the epoch has no position), ``masked`` or ``missing``.
    inlier : ndarray of bool, shape (rows,)
        Whether the answer uses the range.
    fault_probability : ndarray of float64, shape (rows,)
        Posterior; NaN for rows that take no part.
    weight : ndarray of float64, shape (rows,)
        What the range counts, from 0 to 1.
    residual_m, sigma_m : ndarray of float64, shape (rows,)
        Pseudorange minus what position and clock predict, and its noise.
    reason : tuple of str
        A sentence for people.
    """

    epoch: IntArray
    name: tuple[str, ...]
    system: tuple[str, ...]
    status: tuple[SatelliteStatus, ...]
    inlier: BoolArray
    fault_probability: FloatArray
    weight: FloatArray
    residual_m: FloatArray
    sigma_m: FloatArray
    reason: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.name)

    def rows(self, rows: slice) -> SeriesSatellites:
        """Take some of the rows."""
        return SeriesSatellites(
            self.epoch[rows],
            self.name[rows],
            self.system[rows],
            self.status[rows],
            self.inlier[rows],
            self.fault_probability[rows],
            self.weight[rows],
            self.residual_m[rows],
            self.sigma_m[rows],
            self.reason[rows],
        )


@dataclass(frozen=True, slots=True)
class SeriesRival:
    """A solution that explains a stretch of the series nearly as well.

    Attributes
    ----------
    epochs : tuple of int
        First and last epoch (both included) of the stretch, by the input's numbers.
    position_ecef_m : ndarray of float64, shape (3,)
        Where it is farthest from the answer.
    distance_m : float
        Horizontal, there.
    probability : float
    """

    epochs: tuple[int, int]
    position_ecef_m: FloatArray
    distance_m: float
    probability: float


@dataclass(frozen=True, slots=True)
class EpochFix:
    """One epoch of a series. Falsy where it has no position.

    Attributes
    ----------
    time : float or datetime64
    status : str
    position_ecef_m : ndarray of float64, shape (3,)
    geodetic : Geodetic
    velocity_enu_mps : ndarray of float64, shape (3,)
    covariance_enu_m2 : ndarray of float64, shape (3, 3)
    clocks_m : mapping of str to float
    hpl_m, vpl_m, far_probability : float
    ambiguous : bool
    satellites : SeriesSatellites
    """

    time: Any
    status: EpochStatus
    position_ecef_m: FloatArray
    geodetic: Geodetic
    velocity_enu_mps: FloatArray
    covariance_enu_m2: FloatArray
    clocks_m: Mapping[str, float]
    hpl_m: float
    vpl_m: float
    far_probability: float
    ambiguous: bool
    satellites: SeriesSatellites

    def __bool__(self) -> bool:
        return self.status in ("solved", "bridged")

    @property
    def excluded(self) -> tuple[str, ...]:
        """Names of the satellites that were left out as faulty."""
        satellites = self.satellites
        return tuple(n for n, s in zip(satellites.name, satellites.status, strict=True) if s == "excluded")


@dataclass(frozen=True, slots=True)
class Fixes:
    """Positions of a series of epochs, in input order; NaN where there is none.

    Attributes
    ----------
    time : ndarray, shape (epochs,)
        As given: numbers or datetime64.
    status : tuple of str
        Of each epoch: ``solved``, ``bridged`` or why it has no position.
    position_ecef_m : ndarray of float64, shape (epochs, 3)
    geodetic : ndarray of float64, shape (epochs, 3)
        Latitude and longitude in degrees, height in metres (WGS 84).
    velocity_enu_mps : ndarray of float64, shape (epochs, 3)
        0 for a standing receiver, NaN where epochs were solved each on its own.
    covariance_enu_m2 : ndarray of float64, shape (epochs, 3, 3)
        At the noise that the residuals speak for, and wider where errors last from epoch to epoch.
    clocks_m : mapping of str to ndarray of float64, shape (epochs,)
        Receiver clock error per system.
    hpl_m, vpl_m : ndarray of float64, shape (epochs,)
        Protection levels at the integrity risk of the options.
    far_probability : ndarray of float64, shape (epochs,)
        Bound of the probability that the truth lies beyond the alert limit.
    ambiguous : ndarray of bool, shape (epochs,)
        Whether that is more than the options accept.
    satellites : SeriesSatellites
    motion, surroundings : str
        As asked for, or as decided.
    motion_reason, surroundings_reason : str
        Why.
    method : str
        Fault exclusion of single epochs, where they were solved so.
    window_s : float or None
        Of a moving receiver.
    causal : bool
        Whether epochs were answered by themselves and earlier ones only.
    sigma_scale : float
        Noise in units of the sigmas given.
    correlation : float
        Of a satellite's residuals from one epoch to the next.
    rivals : tuple of SeriesRival
    notices : tuple of Notice
    offsets : ndarray of int64, shape (epochs + 1,)
        Epoch k has rows ``offsets[k]:offsets[k + 1]`` of ``satellites``.
    """

    time: npt.NDArray[Any]
    status: tuple[EpochStatus, ...]
    position_ecef_m: FloatArray
    geodetic: FloatArray
    velocity_enu_mps: FloatArray
    covariance_enu_m2: FloatArray
    clocks_m: Mapping[str, FloatArray]
    hpl_m: FloatArray
    vpl_m: FloatArray
    far_probability: FloatArray
    ambiguous: BoolArray
    satellites: SeriesSatellites
    motion: Motion
    motion_reason: str
    surroundings: Surroundings
    surroundings_reason: str
    method: str
    window_s: float | None
    causal: bool
    sigma_scale: float
    correlation: float
    rivals: tuple[SeriesRival, ...]
    notices: tuple[Notice, ...]
    offsets: IntArray = field(repr=False)

    def __len__(self) -> int:
        return len(self.status)

    def __getitem__(self, k: int) -> EpochFix:
        """One epoch.

        Parameters
        ----------
        k : int
        """
        k = range(len(self))[k]
        clocks = {
            letter: float(column[k]) for letter, column in self.clocks_m.items() if np.isfinite(column[k])
        }
        return EpochFix(
            time=self.time[k],
            status=self.status[k],
            position_ecef_m=self.position_ecef_m[k],
            geodetic=Geodetic(*self.geodetic[k].tolist()),
            velocity_enu_mps=self.velocity_enu_mps[k],
            covariance_enu_m2=self.covariance_enu_m2[k],
            clocks_m=clocks,
            hpl_m=float(self.hpl_m[k]),
            vpl_m=float(self.vpl_m[k]),
            far_probability=float(self.far_probability[k]),
            ambiguous=bool(self.ambiguous[k]),
            satellites=self.satellites.rows(slice(int(self.offsets[k]), int(self.offsets[k + 1]))),
        )

    def __iter__(self) -> Iterator[EpochFix]:
        return (self[k] for k in range(len(self)))

    @property
    def solved(self) -> BoolArray:
        """Which epochs have a position."""
        return np.array([status in ("solved", "bridged") for status in self.status], dtype=np.bool_)

    def to_dict(self) -> dict[str, Any]:
        """JSON-safe columns; None where there is nothing."""
        from estimators.gnss.series.report import fixes_to_dict  # noqa: PLC0415  # it imports this module

        return fixes_to_dict(self)

    def to_frame(self) -> pd.DataFrame:
        """One row per epoch.

        Raises
        ------
        ImportError
            If pandas is not installed (extra ``[pandas]``).
        """
        from estimators.gnss.series.report import fixes_to_frame  # noqa: PLC0415  # it imports this module

        return fixes_to_frame(self)

    def summary(self) -> str:
        """Text for people."""
        from estimators.gnss.series.report import summarise  # noqa: PLC0415  # it imports this module

        return summarise(self)
