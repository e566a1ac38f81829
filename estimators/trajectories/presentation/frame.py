"""A track as a pandas data frame: one row per input row."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from estimators.trajectories.reasons import FixReason

if TYPE_CHECKING:
    import pandas as pd

    from estimators.trajectories.track import Track


def track_to_frame(track: Track) -> pd.DataFrame:
    """One row per input row, in input order.

    Parameters
    ----------
    track : Track

    Raises
    ------
    ImportError
        If pandas is not installed (extra ``[pandas]``).
    """
    import pandas as pd  # noqa: PLC0415

    names = pd.Index([member.name for member in FixReason])
    columns: dict[str, Any] = {
        "time": track.time,
        "inlier": track.points.inlier,
        "probability": track.points.probability,
        "reason": pd.Categorical.from_codes(track.points.reason_codes.astype(np.int8), categories=names),
        "residual_m": track.points.residual_m,
        "lat_deg": track.lat_deg,
        "lon_deg": track.lon_deg,
    }
    if track.height_m is not None:
        columns["height_m"] = track.height_m
        columns["sigma_up_m"] = np.sqrt(track.covariance_enu_m2[:, 2, 2])
    columns |= {
        "sigma_m": track.sigma_m,
        "speed_mps": track.speed_mps,
        "speed_sigma_mps": track.speed_sigma_mps,
        "heading_deg": track.heading_deg,
        "heading_sigma_deg": track.heading_sigma_deg,
    }
    return pd.DataFrame(columns)
