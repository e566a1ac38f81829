"""The answer of cleaning a track: :class:`Track` and its parts.

Frozen data with the ways out people expect on it. How the numbers come about is in
:mod:`estimators.trajectories.clean`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from estimators.arrays import BoolArray, CodeArray, FloatArray
from estimators.notices import Notice
from estimators.result import Estimate
from estimators.trajectories.presentation.dictionary import track_to_dict
from estimators.trajectories.presentation.frame import track_to_frame
from estimators.trajectories.presentation.geojson import track_to_geojson
from estimators.trajectories.presentation.words import track_to_html, track_to_text
from estimators.trajectories.reasons import FixReason

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True)
class TrackPoints:
    """One entry per input row, in input order.

    Attributes
    ----------
    inlier : ndarray of bool, shape (n,)
        Whether the row tells where the track was.
    probability : ndarray, shape (n,)
        Of that; NaN for rows that are invalid.
    residual_m : ndarray, shape (n,)
        Distance of the row from the smoothed track; NaN for rows that are invalid.
    reason_codes : ndarray of uint8, shape (n,)
        Codes of :class:`~estimators.trajectories.reasons.FixReason`.
    """

    inlier: BoolArray
    probability: FloatArray
    residual_m: FloatArray
    reason_codes: CodeArray

    @property
    def reason(self) -> list[str]:
        """Reasons by name, one per input row."""
        names = [member.name for member in FixReason]
        return [names[code] for code in self.reason_codes]


@dataclass(frozen=True, slots=True)
class TrackNoise:
    """What the track is made of.

    Attributes
    ----------
    sigma_m : float
        Standard deviation, per axis, of the errors of good fixes that are independent of one another.
    coloured_m : float
        Of those that last for ``correlation_s``.
    correlation_s : float
        Correlation time of the latter, seconds.
    manoeuvre : float
        Spectral density of the acceleration, m^2/s^3: how soon the motion cannot be foretold.
    source : {"estimated", "given"}
    """

    sigma_m: float
    coloured_m: float
    correlation_s: float
    manoeuvre: float
    source: Literal["estimated", "given"]


@dataclass(frozen=True, slots=True)
class Distance:
    """How far the track goes.

    Attributes
    ----------
    raw_m : float
        Along all valid fixes as they came, in order of time.
    cleaned : Estimate
        Along the smoothed track while it moves, metres.
    """

    raw_m: float
    cleaned: Estimate


@dataclass(frozen=True, slots=True)
class Stretch:
    """A stretch of the track that moves or stands.

    Attributes
    ----------
    kind : {"moving", "stopped"}
    first, last : int
        Input rows of its ends.
    duration_s, distance_m : float
    speed_mps : float
        Median speed.
    acceleration_mps2 : Estimate or None
        Robust trend of the speed (Theil-Sen); None of fewer than four fixes and of a stop.
    """

    kind: Literal["moving", "stopped"]
    first: int
    last: int
    duration_s: float
    distance_m: float
    speed_mps: float
    acceleration_mps2: Estimate | None


@dataclass(frozen=True, slots=True)
class Track:
    """A cleaned track; all arrays have one entry per input row, in input order.

    Rows without a time have no place in the track: NaN (``null`` on the wire). Rows with a time but
    without a usable position have the smoothed one of their time.

    Attributes
    ----------
    method : str
    time : ndarray, shape (n,)
        As given: numbers or datetime64[ns].
    points : TrackPoints
    lat_deg, lon_deg : ndarray, shape (n,)
        Smoothed; longitudes from -180 to 180.
    height_m : ndarray, shape (n,), or None
        Smoothed; None if there were none.
    variance_m2, variance_up_m2 : ndarray, shape (n,)
        Of the smoothed positions: per horizontal axis, and upward, NaN without heights.
    speed_mps, speed_sigma_mps : ndarray, shape (n,)
    heading_deg, heading_sigma_deg : ndarray, shape (n,)
        Clockwise from north, 0 to 360. A sigma of 104, that of the uniform distribution, says: unknown.
    noise : TrackNoise
    distance : Distance
    stretches : tuple of Stretch
        In order of time.
    level : float
        Confidence level of intervals.
    notices : tuple of Notice
    input_lat_deg, input_lon_deg : ndarray, shape (n,)
        As given, longitudes wrapped; NaN where invalid.
    """

    method: str
    time: npt.NDArray[Any]
    points: TrackPoints
    lat_deg: FloatArray
    lon_deg: FloatArray
    height_m: FloatArray | None
    variance_m2: FloatArray
    variance_up_m2: FloatArray
    speed_mps: FloatArray
    speed_sigma_mps: FloatArray
    heading_deg: FloatArray
    heading_sigma_deg: FloatArray
    noise: TrackNoise
    distance: Distance
    stretches: tuple[Stretch, ...]
    level: float
    notices: tuple[Notice, ...]
    input_lat_deg: FloatArray = field(repr=False)
    input_lon_deg: FloatArray = field(repr=False)

    def __len__(self) -> int:
        return int(self.lat_deg.size)

    @property
    def covariance_enu_m2(self) -> FloatArray:
        """Covariance of the smoothed positions: east, north, up; shape (n, 3, 3), NaN upward without heights.

        Made when asked for: of nine entries two are distinct.
        """
        covariance = np.zeros((len(self), 3, 3))
        covariance[:, 0, 0] = covariance[:, 1, 1] = self.variance_m2
        covariance[:, 2, 2] = self.variance_up_m2
        covariance[np.isnan(self.variance_m2)] = np.nan
        return covariance

    @property
    def sigma_m(self) -> FloatArray:
        """Standard deviation of the smoothed position, per horizontal axis, shape (n,)."""
        return np.sqrt(self.variance_m2)

    def summary(self) -> str:
        """Text for people: how many fixes lie, how far it goes, how sure that is."""
        return track_to_text(self)

    def to_dict(self, *, points: bool = True) -> dict[str, Any]:
        """JSON-safe form.

        Parameters
        ----------
        points : bool
            Whether to include the columns per row.
        """
        return track_to_dict(self, points=points)

    def to_frame(self) -> pd.DataFrame:
        """One row per input row.

        Raises
        ------
        ImportError
            If pandas is not installed (extra ``[pandas]``).
        """
        return track_to_frame(self)

    def to_geojson(self, *, points: bool = False) -> dict[str, Any]:
        """GeoJSON (RFC 7946): the smoothed track, cut at the antimeridian, and if wanted every row.

        Parameters
        ----------
        points : bool
            Whether to add a feature per row with its label.
        """
        return track_to_geojson(self, points=points)

    def plot(self, kind: Literal["map", "error"] = "map", **style: Any) -> Figure:
        """Map of the track, or how far each fix is off over time (extra ``[plot]``).

        Parameters
        ----------
        kind : {"map", "error"}
        **style
            ``width_px``, ``height_px``, ``theme`` and ``title``; see
            :func:`estimators.adapters.track_plots.map_figure`.

        Raises
        ------
        ImportError
            If matplotlib is not installed (extra ``[plot]``).
        InputError
            If the kind, the size or the theme is unknown.
        """
        from estimators.adapters.track_plots import plot_track  # noqa: PLC0415

        return plot_track(self, kind, **style)

    def _repr_html_(self) -> str:
        return track_to_html(self)
