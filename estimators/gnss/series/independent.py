"""Epochs solved each on its own by :func:`estimators.gnss.locate.locate`, with any of its methods."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from estimators.gnss.fix import Fix
from estimators.gnss.locate import locate
from estimators.gnss.options import PositionOptions
from estimators.gnss.series.assemble import Settled, series_notices
from estimators.gnss.series.epochs import Epoch
from estimators.gnss.series.fixes import EpochStatus, Fixes, SeriesRival, SeriesSatellites
from estimators.gnss.series.observed import MASKED, MISSING, Observations
from estimators.result import NoFit, NoFitReason

_STATUS: dict[NoFitReason, EpochStatus] = {
    NoFitReason.too_few_satellites: "too_few_satellites",
    NoFitReason.undetermined_geometry: "undetermined_geometry",
    NoFitReason.implausible_position: "implausible_position",
}


def solve_each(
    epochs: Sequence[Epoch],
    observations: Observations,
    settled: Settled,
    method: str,
    options: PositionOptions,
    progress: Callable[[int, int], object] | None,
) -> Fixes:
    """Answer every epoch by itself.

    Parameters
    ----------
    epochs : sequence of Epoch
        In the caller's order.
    observations : Observations
    settled : Settled
    method : str
    options : PositionOptions
    progress : callable, optional
    """
    answers: list[Fix | NoFit] = []
    for epoch in epochs:
        answers.append(
            locate(
                epoch.satellites_m,
                epoch.pseudoranges_m,
                sigma_m=epoch.sigma_m,
                system=epoch.system,
                satellite=epoch.satellite,
                cn0_dbhz=epoch.cn0_dbhz,
                rotated=observations.table.rotated,
                method=method,
                options=options,
            )
        )
        if progress is not None:
            progress(len(answers), len(epochs))
    n = len(answers)
    position, covariance, velocity = (
        np.full((n, 3), np.nan),
        np.full((n, 3, 3), np.nan),
        np.full((n, 3), np.nan),
    )
    geodetic, numbers = np.full((n, 3), np.nan), np.full((n, 4), np.nan)
    clocks = {letter: np.full(n, np.nan) for letter in observations.letters}
    ambiguous = np.zeros(n, dtype=np.bool_)
    rivals = []
    for k, fix in enumerate(answers):
        if isinstance(fix, NoFit):
            continue
        position[k], covariance[k] = fix.position_ecef_m, fix.covariance_enu_m2
        geodetic[k] = fix.geodetic.lat_deg, fix.geodetic.lon_deg, fix.geodetic.height_m
        numbers[k] = fix.hpl_m, fix.vpl_m, fix.far_probability, fix.sigma_scale
        ambiguous[k] = fix.ambiguous
        for letter, value in fix.clocks_m.items():
            clocks[letter][k] = value
        if fix.rival is not None:
            rivals.append(
                SeriesRival((k, k), fix.rival.position_ecef_m, fix.rival.distance_m, fix.rival.probability)
            )
    scales = numbers[np.isfinite(numbers[:, 3]), 3]
    return Fixes(
        time=observations.time,
        status=tuple(_STATUS[x.reason] if isinstance(x, NoFit) else "solved" for x in answers),
        position_ecef_m=position,
        geodetic=geodetic,
        velocity_enu_mps=velocity,
        covariance_enu_m2=covariance,
        clocks_m=clocks,
        hpl_m=numbers[:, 0].copy(),
        vpl_m=numbers[:, 1].copy(),
        far_probability=numbers[:, 2].copy(),
        ambiguous=ambiguous,
        satellites=_satellites(answers, observations),
        motion="independent",
        motion_reason=settled.motion_reason,
        surroundings=settled.surroundings,
        surroundings_reason=settled.surroundings_reason,
        method=method,
        window_s=None,
        causal=True,
        sigma_scale=float(np.median(scales)) if scales.size else float("nan"),
        correlation=0.0,
        rivals=tuple(rivals),
        notices=series_notices(observations, int(ambiguous.sum()), 0.0, tuple(rivals)),
        offsets=observations.offsets,
    )


def _satellites(answers: list[Fix | NoFit], observations: Observations) -> SeriesSatellites:
    rows = observations.left_out.size
    status = ["untestable"] * rows
    reason = ["the epoch has no position"] * rows
    for row in np.flatnonzero(observations.left_out == MISSING):
        status[row], reason[row] = "missing", "a number is missing"
    for row in np.flatnonzero(observations.left_out == MASKED):
        status[row], reason[row] = "masked", "under the elevation mask"
    numbers = np.full((rows, 4), np.nan)
    inlier = np.zeros(rows, dtype=np.bool_)
    for k, fix in enumerate(answers):
        if isinstance(fix, NoFit):
            continue
        own = slice(int(observations.offsets[k]), int(observations.offsets[k + 1]))
        inner = fix.satellites
        status[own], reason[own] = inner.status, inner.reason
        inlier[own] = inner.inlier
        numbers[own] = np.stack(
            [inner.fault_probability, inner.weight, inner.residual_m, inner.sigma_m], axis=1
        )
    return SeriesSatellites(
        epoch=np.repeat(np.arange(len(answers)), np.diff(observations.offsets)).astype(np.int64),
        name=observations.name,
        system=observations.row_system,
        status=tuple(status),  # type: ignore[arg-type]
        inlier=inlier,
        fault_probability=numbers[:, 0].copy(),
        weight=numbers[:, 1].copy(),
        residual_m=numbers[:, 2].copy(),
        sigma_m=numbers[:, 3].copy(),
        reason=tuple(reason),
    )
