"""The answer of a call with a piece of a live track: :class:`LiveTrack` and its rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import numpy.typing as npt

from estimators.arrays import BoolArray, CodeArray, FloatArray, IntArray
from estimators.presentation.json_values import numbers_to_json
from estimators.trajectories.presentation.dictionary import times
from estimators.trajectories.reasons import FixReason
from estimators.trajectories.track import Track, TrackNoise


@dataclass(frozen=True, slots=True)
class LiveRows:
    """Some rows of a live track; all arrays have one entry per row.

    Rows that have no place in the track, for want of a time or because they came too late, hold NaN.

    Attributes
    ----------
    row : ndarray of int64, shape (k,)
        Number of the row in the stream, from 0, in the order in which rows were sent.
    time : ndarray, shape (k,)
        Numbers, or datetime64[ns].
    inlier : ndarray of bool, shape (k,)
        Whether the row tells where the track was.
    probability : ndarray, shape (k,)
        Of that.
    reason_codes : ndarray of uint8, shape (k,)
        Codes of :class:`~estimators.trajectories.reasons.FixReason`.
    lat_deg, lon_deg, height_m : ndarray, shape (k,)
        Smoothed; heights are NaN where there are none nearby.
    covariance_enu_m2 : ndarray, shape (k, 3, 3)
        Of these places: east, north, up.
    speed_mps, speed_sigma_mps, heading_deg, heading_sigma_deg : ndarray, shape (k,)
        As of a :class:`~estimators.trajectories.track.Track`.
    """

    row: IntArray
    time: npt.NDArray[Any]
    inlier: BoolArray
    probability: FloatArray
    reason_codes: CodeArray
    lat_deg: FloatArray
    lon_deg: FloatArray
    height_m: FloatArray
    covariance_enu_m2: FloatArray
    speed_mps: FloatArray
    speed_sigma_mps: FloatArray
    heading_deg: FloatArray
    heading_sigma_deg: FloatArray

    def __len__(self) -> int:
        return int(self.row.size)

    @property
    def reason(self) -> list[str]:
        """Reasons by name."""
        names = [member.name for member in FixReason]
        return [names[code] for code in self.reason_codes]

    @property
    def sigma_m(self) -> FloatArray:
        """Standard deviation of the place, per horizontal axis, shape (k,)."""
        return np.sqrt(0.5 * (self.covariance_enu_m2[:, 0, 0] + self.covariance_enu_m2[:, 1, 1]))

    def to_dict(self) -> dict[str, Any]:
        """JSON-safe columns; None for what is not a number."""
        covariance = self.covariance_enu_m2
        return {
            "row": self.row.tolist(),
            "time": times(self.time),
            "inlier": self.inlier.tolist(),
            "probability": numbers_to_json(self.probability),
            "reason": self.reason,
            "lat_deg": numbers_to_json(self.lat_deg),
            "lon_deg": numbers_to_json(self.lon_deg),
            "height_m": numbers_to_json(self.height_m),
            "variance_east_m2": numbers_to_json(covariance[:, 0, 0]),
            "variance_north_m2": numbers_to_json(covariance[:, 1, 1]),
            "covariance_east_north_m2": numbers_to_json(covariance[:, 0, 1]),
            "variance_up_m2": numbers_to_json(covariance[:, 2, 2]),
            "speed_mps": numbers_to_json(self.speed_mps),
            "speed_sigma_mps": numbers_to_json(self.speed_sigma_mps),
            "heading_deg": numbers_to_json(self.heading_deg),
            "heading_sigma_deg": numbers_to_json(self.heading_sigma_deg),
        }


@dataclass(frozen=True, slots=True)
class LiveTrack:
    """What one call says of a live track.

    Attributes
    ----------
    settled : LiveRows
        Rows whose answer became final in this call. Over all calls each row is settled once.
    provisional : LiveRows
        Rows that wait for more fixes, with what can be said of them now.
    noise : TrackNoise
        As estimated so far.
    state : str
        What the next call needs: send it back as it is. It holds the last fixes, unencrypted.
    """

    settled: LiveRows
    provisional: LiveRows
    noise: TrackNoise
    state: str

    def __len__(self) -> int:
        return len(self.settled)

    def to_dict(self) -> dict[str, Any]:
        """JSON-safe form."""
        return {
            "settled": self.settled.to_dict(),
            "provisional": self.provisional.to_dict(),
            "noise": {
                "sigma_m": self.noise.sigma_m,
                "coloured_m": self.noise.coloured_m,
                "correlation_s": self.noise.correlation_s,
                "manoeuvre": self.noise.manoeuvre,
                "source": self.noise.source,
            },
            "state": self.state,
        }

    def summary(self) -> str:
        """Text for people."""
        faulty = int(np.count_nonzero(~self.settled.inlier))
        return (
            f"{len(self.settled)} rows settled, {faulty} of them faulty; "
            f"{len(self.provisional)} provisional; noise {self.noise.sigma_m:.3g} m per axis"
        )


def rows_of_track(track: Track, first: int, row: Sequence[int], time: npt.NDArray[Any]) -> LiveRows:
    """Rows of a window, from place ``first`` on, with their numbers and times."""
    part = slice(first, first + len(row))
    height = np.full(len(row), np.nan) if track.height_m is None else track.height_m[part]
    return LiveRows(
        np.array(row, dtype=np.int64),
        time,
        track.points.inlier[part],
        track.points.probability[part],
        track.points.reason_codes[part],
        track.lat_deg[part],
        track.lon_deg[part],
        height,
        track.covariance_enu_m2[part],
        track.speed_mps[part],
        track.speed_sigma_mps[part],
        track.heading_deg[part],
        track.heading_sigma_deg[part],
    )


def rows_without_place(row: Sequence[int], time: npt.NDArray[Any], reason: FixReason) -> LiveRows:
    """Rows of which nothing is said but why."""
    unknown = np.full(len(row), np.nan)
    return LiveRows(
        np.array(row, dtype=np.int64),
        time,
        np.zeros(len(row), dtype=np.bool_),
        unknown,
        np.full(len(row), reason, dtype=np.uint8),
        unknown,
        unknown,
        unknown,
        np.full((len(row), 3, 3), np.nan),
        unknown,
        unknown,
        unknown,
        unknown,
    )


def joined(parts: Sequence[LiveRows]) -> LiveRows:
    """Several pieces as one; there has to be at least one."""
    columns = [np.concatenate([getattr(part, item.name) for part in parts]) for item in fields(LiveRows)]
    return LiveRows(*columns)
