"""Answers about the satellites that took part, put back where the caller's rows were."""

from __future__ import annotations

import dataclasses

import numpy as np

from estimators.arrays import BoolArray, FloatArray
from estimators.gnss.fix import Fix, Rival, Satellites, SatelliteStatus
from estimators.gnss.observations import Observed
from estimators.notices import NoticeCode, notice


def on_input_rows(fix: Fix, observed: Observed, masked: BoolArray) -> Fix:
    """Spread an answer over all rows of the input.

    Parameters
    ----------
    fix : Fix
        Of the rows that took part.
    observed : Observed
    masked : ndarray of bool
        Which of the usable rows lie under the elevation mask.
    """
    n = observed.missing.size
    if observed.rows.size == n and not masked.any():
        return fix
    rows = observed.rows[~masked]
    inner = fix.satellites
    status: list[SatelliteStatus] = ["missing"] * n
    reason = ["a number is missing"] * n
    for row in observed.rows[masked]:
        status[row] = "masked"
        reason[row] = "under the elevation mask"
    for place, row in enumerate(rows):
        status[row] = inner.status[place]
        reason[row] = inner.reason[place]

    def spread(values: FloatArray) -> FloatArray:
        out = np.full(n, np.nan)
        out[rows] = values
        return out

    def flags(values: BoolArray) -> BoolArray:
        out = np.zeros(n, dtype=np.bool_)
        out[rows] = values
        return out

    satellites = Satellites(
        name=observed.name,
        system=observed.system,
        status=tuple(status),
        inlier=flags(inner.inlier),
        fault_probability=spread(inner.fault_probability),
        weight=spread(inner.weight),
        residual_m=spread(inner.residual_m),
        sigma_m=spread(inner.sigma_m),
        statistic=spread(inner.statistic),
        threshold=inner.threshold,
        mdb_m=spread(inner.mdb_m),
        azimuth_deg=spread(inner.azimuth_deg),
        elevation_deg=spread(inner.elevation_deg),
        reason=tuple(reason),
    )
    rival: Rival | None = fix.rival
    if rival is not None:
        rival = dataclasses.replace(rival, excluded=flags(rival.excluded))
    notices = fix.notices
    if masked.any():
        notices = (*notices, notice(NoticeCode.satellites_below_mask, satellites=int(masked.sum())))
    if observed.missing.any():
        notices = (*notices, notice(NoticeCode.missing_values, rows=int(observed.missing.sum())))
    return dataclasses.replace(fix, satellites=satellites, rival=rival, notices=notices)
