"""A :class:`~estimators.trajectories.track.Track` as a JSON-safe dict: the keys of the wire format."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from estimators.notices import notice_to_dict
from estimators.presentation.json_values import estimate_to_dict, numbers_to_json

if TYPE_CHECKING:
    from estimators.trajectories.track import Stretch, Track


def times(values: npt.NDArray[Any]) -> list[Any]:
    """Numbers as they are, points in time as ISO 8601 in UTC, None where a time is missing."""
    if values.dtype.kind != "M":
        return (
            list(values.tolist()) if values.dtype.kind in "iu" else numbers_to_json(values.astype(np.float64))
        )
    moments = values.astype("datetime64[ns]")
    exact = bool(np.all((moments == moments.astype("datetime64[ms]")) | np.isnat(moments)))
    texts = np.datetime_as_string(moments, unit="ms" if exact else "ns").tolist()
    return [None if text == "NaT" else f"{text}Z" for text in texts]


def track_to_dict(track: Track, *, points: bool = True) -> dict[str, Any]:
    """JSON-safe form of an answer; columns have one entry per input row.

    Parameters
    ----------
    track : Track
    points : bool
        Whether to include the columns per row.
    """
    answer: dict[str, Any] = {
        "method": track.method,
        "level": track.level,
        "n": len(track),
        "inliers": int(track.points.inlier.sum()),
        "noise": {
            "sigma_m": track.noise.sigma_m,
            "coloured_m": track.noise.coloured_m,
            "correlation_s": track.noise.correlation_s,
            "manoeuvre": track.noise.manoeuvre,
            "source": track.noise.source,
        },
        "distance": {"raw_m": track.distance.raw_m, "cleaned_m": estimate_to_dict(track.distance.cleaned)},
        "stretches": [_stretch(item) for item in track.stretches],
        "notices": [notice_to_dict(item) for item in track.notices],
    }
    if points:
        covariance = track.covariance_enu_m2
        answer["points"] = {
            "time": times(track.time),
            "inlier": track.points.inlier.tolist(),
            "probability": numbers_to_json(track.points.probability),
            "reason": track.points.reason,
            "residual_m": numbers_to_json(track.points.residual_m),
            "lat_deg": numbers_to_json(track.lat_deg),
            "lon_deg": numbers_to_json(track.lon_deg),
            "height_m": None if track.height_m is None else numbers_to_json(track.height_m),
            "variance_east_m2": numbers_to_json(covariance[:, 0, 0]),
            "variance_north_m2": numbers_to_json(covariance[:, 1, 1]),
            "covariance_east_north_m2": numbers_to_json(covariance[:, 0, 1]),
            "variance_up_m2": None if track.height_m is None else numbers_to_json(covariance[:, 2, 2]),
            "speed_mps": numbers_to_json(track.speed_mps),
            "speed_sigma_mps": numbers_to_json(track.speed_sigma_mps),
            "heading_deg": numbers_to_json(track.heading_deg),
            "heading_sigma_deg": numbers_to_json(track.heading_sigma_deg),
        }
    return answer


def _stretch(item: Stretch) -> dict[str, Any]:
    trend = item.acceleration_mps2
    return {
        "kind": item.kind,
        "first": item.first,
        "last": item.last,
        "duration_s": item.duration_s,
        "distance_m": item.distance_m,
        "speed_mps": item.speed_mps,
        "acceleration_mps2": None if trend is None else estimate_to_dict(trend),
    }
