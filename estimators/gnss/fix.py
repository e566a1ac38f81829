"""The answer to an epoch of pseudoranges: :class:`Fix` and its parts."""

from __future__ import annotations

import html
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from estimators.arrays import BoolArray, FloatArray
from estimators.gnss.presentation.dictionary import fix_to_dict, fix_to_feature
from estimators.gnss.presentation.frame import fix_to_frame
from estimators.gnss.presentation.words import fix_to_text
from estimators.notices import Notice
from estimators.result import Consensus

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

SatelliteStatus = Literal["used", "excluded", "untestable", "masked", "missing"]


@dataclass(frozen=True, slots=True)
class Geodetic:
    """A place on the WGS 84 ellipsoid: degrees, and metres above it."""

    lat_deg: float
    lon_deg: float
    height_m: float


@dataclass(frozen=True, slots=True)
class Dilution:
    """Dilution of precision of the satellites used: standard deviation per metre of range noise.

    Attributes
    ----------
    geometric, position, horizontal, vertical, time : float
        GDOP, PDOP, HDOP, VDOP, TDOP (the clocks together).
    """

    geometric: float
    position: float
    horizontal: float
    vertical: float
    time: float


@dataclass(frozen=True, slots=True)
class GlobalTest:
    """Chi-square test of the ranges used, at the sigmas as given.

    Attributes
    ----------
    statistic : float
        Sum of squared whitened residuals of least squares.
    dof : int
        Redundant satellites; 0 leaves nothing to test.
    threshold : float or None
        Limit at the false-alarm probability.
    p_value : float or None
    """

    statistic: float
    dof: int
    threshold: float | None
    p_value: float | None


@dataclass(frozen=True, slots=True)
class Integrity:
    """Protection levels and what they assume.

    Attributes
    ----------
    hpl_m, vpl_m : float
        The horizontal and the vertical error exceed these with at most the risk; infinite where faults that
        no range can contradict are likelier than that.
    risk : float
    fault_prior : float
        Mean probability of a satellite to be faulty.
    method : str
        ``"posterior"`` over fault sets, or ``"solution-separation"``.
    """

    hpl_m: float
    vpl_m: float
    risk: float
    fault_prior: float
    method: str = "posterior"


@dataclass(frozen=True, slots=True)
class Rival:
    """The likeliest position that lies elsewhere.

    Attributes
    ----------
    position_ecef_m : ndarray of float64, shape (3,)
    distance_m : float
        Horizontal, to the answer.
    probability : float
        Posterior probability of its fault set.
    excluded : ndarray of bool, shape (n,)
        The satellites that it calls faulty.
    """

    position_ecef_m: FloatArray
    distance_m: float
    probability: float
    excluded: BoolArray


@dataclass(frozen=True, slots=True)
class Satellites:
    """One entry per input row, in input order.

    Attributes
    ----------
    name, system : tuple of str
    status : tuple of str
        ``used``, ``excluded``, ``untestable`` (used, and nothing checks it), ``masked`` or ``missing``.
    inlier : ndarray of bool, shape (n,)
        Whether the answer uses it.
    fault_probability : ndarray of float64, shape (n,)
        Posterior; NaN for rows that take no part.
    weight : ndarray of float64, shape (n,)
        What the range counts, from 0 to 1, beside its sigma: ``auto`` lets ranges count less that agree less
        than the others.
    residual_m : ndarray of float64, shape (n,)
        Pseudorange minus what position and clock predict.
    sigma_m : ndarray of float64, shape (n,)
    statistic : ndarray of float64, shape (n,)
        Residual of least squares, without its sign, in its own standard deviations at the sigmas as given:
        the w-test of a used satellite, the prediction error of an excluded one.
    threshold : float
        Limit of the statistic at the false-alarm probability, all satellites together.
    mdb_m : ndarray of float64, shape (n,)
        Minimum detectable bias; infinite where nothing checks the satellite.
    azimuth_deg, elevation_deg : ndarray of float64, shape (n,)
    reason : tuple of str
        A sentence for people.
    """

    name: tuple[str, ...]
    system: tuple[str, ...]
    status: tuple[SatelliteStatus, ...]
    inlier: BoolArray
    fault_probability: FloatArray
    weight: FloatArray
    residual_m: FloatArray
    sigma_m: FloatArray
    statistic: FloatArray
    threshold: float
    mdb_m: FloatArray
    azimuth_deg: FloatArray
    elevation_deg: FloatArray
    reason: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.name)


@dataclass(frozen=True, slots=True)
class Fix:
    """A position from pseudoranges, with the faulty satellites left out.

    Attributes
    ----------
    method : str
    position_ecef_m : ndarray of float64, shape (3,)
    geodetic : Geodetic
    covariance_enu_m2 : ndarray of float64, shape (3, 3)
        East, north, up; at the noise scale that the residuals speak for.
    clocks_m : mapping of str to float
        Receiver clock error per system letter, in metres.
    dop : Dilution
    integrity : Integrity
    satellites : Satellites
    global_test : GlobalTest
    ambiguous : bool
        Whether the truth may lie beyond the alert limit, by more than the accepted probability.
    far_probability : float
        The probability of that.
    rival : Rival or None
    sigma_scale : float
        Noise in units of the sigmas given.
    consensus : Consensus
    notices : tuple of Notice
    axes : ndarray of float64, shape (3, 3)
        East, north and up as rows, at the position.
    """

    method: str
    position_ecef_m: FloatArray
    geodetic: Geodetic
    covariance_enu_m2: FloatArray
    clocks_m: Mapping[str, float]
    dop: Dilution
    integrity: Integrity
    satellites: Satellites
    global_test: GlobalTest
    ambiguous: bool
    far_probability: float
    rival: Rival | None
    sigma_scale: float
    consensus: Consensus
    notices: tuple[Notice, ...]
    axes: FloatArray = field(repr=False)

    @property
    def hpl_m(self) -> float:
        """Horizontal protection level."""
        return self.integrity.hpl_m

    @property
    def vpl_m(self) -> float:
        """Vertical protection level."""
        return self.integrity.vpl_m

    @property
    def excluded(self) -> tuple[str, ...]:
        """Names of the satellites that were left out as faulty."""
        names, status = self.satellites.name, self.satellites.status
        return tuple(name for name, state in zip(names, status, strict=True) if state == "excluded")

    def error_enu_m(self, truth_ecef_m: FloatArray) -> FloatArray:
        """East, north and up from a known position to the answer, in metres.

        Parameters
        ----------
        truth_ecef_m : ndarray of float64, shape (3,)
        """
        return np.asarray(self.axes @ (self.position_ecef_m - np.asarray(truth_ecef_m, dtype=np.float64)))

    def summary(self) -> str:
        """Text for people: where, how sure, which satellites lied and what to do about the notices."""
        return fix_to_text(self)

    def to_dict(self, *, satellites: bool = True) -> dict[str, Any]:
        """JSON-safe form, the same as the service answers.

        Parameters
        ----------
        satellites : bool
            Whether to include the columns per satellite.
        """
        return fix_to_dict(self, satellites=satellites)

    def to_geojson(self) -> dict[str, Any]:
        """GeoJSON feature (RFC 7946)."""
        return fix_to_feature(self)

    def to_frame(self) -> pd.DataFrame:
        """One row per satellite, in input order.

        Raises
        ------
        ImportError
            If pandas is not installed (extra ``[pandas]``).
        """
        return fix_to_frame(self)

    def plot(self, kind: Literal["sky", "residuals"] = "sky", **style: Any) -> Figure:
        """Picture of the sky or of the residuals (extra ``[plot]``).

        Parameters
        ----------
        kind : {"sky", "residuals"}
        **style
            ``width_px``, ``height_px``, ``theme`` and ``title``; see
            :func:`estimators.adapters.position_plots.sky_figure`.

        Raises
        ------
        ImportError
            If matplotlib is not installed (extra ``[plot]``).
        """
        from estimators.adapters.position_plots import residual_figure, sky_figure  # noqa: PLC0415

        return (sky_figure if kind == "sky" else residual_figure)(self, **style)

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(fix_to_text(self))}</pre>"
