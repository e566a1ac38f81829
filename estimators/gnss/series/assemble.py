"""From a joint solution, in order of time, to the answer in the caller's order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.gnss.fix import SatelliteStatus
from estimators.gnss.options import PositionOptions
from estimators.gnss.series.choice import Motion, Surroundings
from estimators.gnss.series.fixes import EpochStatus, Fixes, SeriesRival, SeriesSatellites
from estimators.gnss.series.joint import Joint
from estimators.gnss.series.observed import MASKED, MISSING, Observations
from estimators.gnss.series.snapshots import count_clocks
from estimators.gnss.series.unwatched import widen_unwatched
from estimators.gnss.series.weights import fault_probabilities
from estimators.notices import Notice, NoticeCode, notice

_DEEPEST_M, _HIGHEST_M = -20e3, 2000e3
"""Heights of receivers: from the deepest trench to low orbits."""
_CORRELATED = 0.3
_COUNTS = 0.1
"""Share of its weight that a range among buildings must keep to be called used."""


@dataclass(frozen=True, slots=True)
class Settled:
    """How a series was solved.

    Attributes
    ----------
    motion, motion_reason, surroundings, surroundings_reason : str
    window_s : float or None
    causal : bool
    """

    motion: Motion
    motion_reason: str
    surroundings: Surroundings
    surroundings_reason: str
    window_s: float | None
    causal: bool


def make_fixes(observations: Observations, joint: Joint, settled: Settled, options: PositionOptions) -> Fixes:
    """Put an answer together.

    Parameters
    ----------
    observations : Observations
    joint : Joint
    settled : Settled
    options : PositionOptions
    """
    joint = widen_unwatched(joint, observations, options)
    order = observations.order
    back = np.argsort(order, kind="stable")
    geodetic = np.full(joint.position_m.shape, np.nan)
    geodetic[joint.solved] = to_geodetic(joint.position_m[joint.solved])
    plausible = joint.solved.copy()
    plausible[joint.solved] = (geodetic[joint.solved, 2] > _DEEPEST_M) & (
        geodetic[joint.solved, 2] < _HIGHEST_M
    )

    def column(values: FloatArray) -> FloatArray:
        blank = plausible.reshape(-1, *([1] * (values.ndim - 1)))
        return np.ascontiguousarray(np.where(blank, values, np.nan)[back])

    counts = np.diff(observations.table.offsets)
    enough = counts >= 3 + count_clocks(observations.table)
    status: list[EpochStatus] = []
    for k in back:
        if plausible[k]:
            status.append("solved" if enough[k] else "bridged")
        elif joint.solved[k]:
            status.append("implausible_position")
        else:
            status.append("undetermined_geometry" if enough[k] else "too_few_satellites")
    far = column(joint.far_probability)
    ambiguous = np.nan_to_num(far) >= options.ambiguity
    rivals = tuple(
        SeriesRival(
            (int(order[rival.first]), int(order[rival.last])),
            rival.position_ecef_m,
            rival.distance_m,
            rival.probability,
        )
        for rival in joint.rivals
    )
    satellites = _satellites(observations, joint, settled, options)
    return Fixes(
        time=observations.time,
        status=tuple(status),
        position_ecef_m=column(joint.position_m),
        geodetic=column(geodetic),
        velocity_enu_mps=column(joint.velocity_enu_mps),
        covariance_enu_m2=column(joint.covariance_enu_m2),
        clocks_m={letter: column(joint.clock_m[:, j]) for j, letter in enumerate(observations.letters)},
        hpl_m=column(joint.hpl_m),
        vpl_m=column(joint.vpl_m),
        far_probability=far,
        ambiguous=ambiguous,
        satellites=satellites,
        motion=settled.motion,
        motion_reason=settled.motion_reason,
        surroundings=settled.surroundings,
        surroundings_reason=settled.surroundings_reason,
        method="auto",
        window_s=settled.window_s,
        causal=settled.causal,
        sigma_scale=joint.sigma_scale,
        correlation=joint.correlation,
        rivals=rivals,
        notices=series_notices(observations, int(ambiguous.sum()), joint.correlation, rivals),
        offsets=observations.offsets,
    )


def _satellites(
    observations: Observations, joint: Joint, settled: Settled, options: PositionOptions
) -> SeriesSatellites:
    rows, source, table = observations.left_out.size, observations.source, observations.table
    has_position = np.repeat(joint.solved, np.diff(table.offsets)) & np.isfinite(joint.healthy)
    city = settled.surroundings == "city" and settled.motion == "moving"
    if city:
        probability = fault_probabilities(
            joint.residual_m, table.sigma_m, joint.sigma_scale, options.fault_prior
        )
        taken = joint.healthy >= _COUNTS
    else:
        probability, taken = 1.0 - joint.healthy, joint.healthy >= 0.5
    status: list[SatelliteStatus] = ["missing"] * rows
    reason = ["a number is missing"] * rows
    for row in np.flatnonzero(observations.left_out == MASKED):
        status[row], reason[row] = "masked", "under the elevation mask"
    for place, row in enumerate(source):
        if not has_position[place]:
            status[row], reason[row] = "untestable", "the epoch has no position"
        elif taken[place]:
            status[row], reason[row] = "used", "agrees with the series"
        else:
            status[row] = "excluded"
            reason[row] = (
                f"faulty with probability {probability[place]:.2g}; off by {joint.residual_m[place]:.1f} m"
            )

    def spread(values: FloatArray) -> FloatArray:
        out = np.full(rows, np.nan)
        out[source] = np.where(has_position, values, np.nan)
        return out

    inlier = np.zeros(rows, dtype=np.bool_)
    inlier[source] = has_position & taken
    return SeriesSatellites(
        epoch=np.repeat(np.arange(len(observations)), np.diff(observations.offsets)).astype(np.int64),
        name=observations.name,
        system=observations.row_system,
        status=tuple(status),
        inlier=inlier,
        fault_probability=spread(probability),
        weight=spread(joint.healthy),
        residual_m=spread(joint.residual_m),
        sigma_m=spread(table.sigma_m),
        reason=tuple(reason),
    )


def series_notices(
    observations: Observations, ambiguous: int, correlation: float, rivals: tuple[SeriesRival, ...]
) -> tuple[Notice, ...]:
    """Collect what a user should know about a series."""
    found = []
    if ambiguous:
        detail = {}
        if rivals:
            worst = max(rivals, key=lambda rival: rival.probability)
            detail = {"distance_m": worst.distance_m, "probability": worst.probability}
        found.append(notice(NoticeCode.ambiguous_faults, epochs=ambiguous, **detail))
    if correlation > _CORRELATED:
        found.append(notice(NoticeCode.serial_correlation, lag1=correlation))
    if np.any(np.diff(observations.order) < 0):
        found.append(notice(NoticeCode.unsorted_times))
    repeated = int((np.diff(observations.seconds) == 0.0).sum())
    if repeated:
        found.append(notice(NoticeCode.duplicate_times, epochs=repeated))
    missing = int((observations.left_out == MISSING).sum())
    if missing:
        found.append(notice(NoticeCode.missing_values, rows=missing))
    masked = int((observations.left_out == MASKED).sum())
    if masked:
        found.append(notice(NoticeCode.satellites_below_mask, satellites=masked))
    return tuple(found)
