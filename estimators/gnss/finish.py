"""From a solved epoch to a :class:`~estimators.gnss.fix.Fix`: covariances, tests, labels, notices."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc, chdtri, ndtri

from estimators.arrays import FloatArray
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.geodesy.local_frame import azimuth_elevation, enu_axes
from estimators.gnss.fix import (
    Dilution,
    Fix,
    Geodetic,
    GlobalTest,
    Integrity,
    Rival,
    Satellites,
    SatelliteStatus,
)
from estimators.gnss.methods.protocol import Verdict
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.problem import Problem
from estimators.gnss.snapshot.solved import SCALE_RATE, SCALE_SHAPE, Solved
from estimators.notices import Notice, NoticeCode, notice
from estimators.result import Consensus, Ledger, SearchKind

_UNCHECKED = 1e-9
"""Redundancy number below which nothing checks a satellite."""


@dataclass(frozen=True, slots=True)
class Ended:
    """What the last step needs: the problem at the answer, and how it was come by."""

    method: str
    problem: Problem
    solved: Solved
    verdict: Verdict | None
    options: PositionOptions


def make_fix(ended: Ended) -> Fix:
    """Put the answer of one epoch together."""
    problem, solved, options = ended.problem, ended.solved, ended.options
    table, used = problem.table, problem.used
    position = np.ascontiguousarray(problem.state[:3])
    lat, lon, height = to_geodetic(position).tolist()
    axes = enu_axes(lat, lon)
    freedom, squares = problem.freedom, problem.squares
    scale = math.sqrt((SCALE_RATE + 0.5 * squares) / (SCALE_SHAPE + 0.5 * freedom - 1.0))
    threshold = float(-ndtri(options.false_alarm / (2 * table.pseudoranges_m.size)))
    satellites = _satellites(problem, solved, axes, threshold, options)
    integrity = Integrity(
        float(solved.hpl_m[0]), float(solved.vpl_m[0]), options.integrity_risk, options.fault_prior
    )
    if ended.verdict is not None and ended.verdict.integrity is not None:
        integrity = ended.verdict.integrity
    far = float(solved.far_probability[0])
    test = _global_test(squares, freedom, options.false_alarm)
    rival = None
    if solved.rival_probability[0] > 0.0:
        rival = Rival(
            solved.rival_position_m[0],
            float(solved.rival_distance_m[0]),
            float(solved.rival_probability[0]),
            solved.rival,
        )
    ambiguous = far >= options.ambiguity
    inliers = int(used.sum())
    return Fix(
        method=ended.method,
        position_ecef_m=position,
        geodetic=Geodetic(lat, lon, height),
        covariance_enu_m2=scale**2 * (axes @ problem.N[:3, :3] @ axes.T),
        clocks_m=dict(zip(table.letters[0], problem.state[3:].tolist(), strict=True)),
        dop=_dilution(problem, axes),
        integrity=integrity,
        satellites=satellites,
        global_test=test,
        ambiguous=ambiguous,
        far_probability=far,
        rival=rival,
        sigma_scale=scale,
        consensus=Consensus(
            method=ended.method,
            n=used.size,
            inliers=inliers,
            inlier_ratio=inliers / used.size,
            threshold=threshold * float(np.median(table.sigma_m)),
            threshold_source="false_alarm",
            sigma=scale * float(np.median(table.sigma_m)),
            sigma_source="posterior",
            ledger=Ledger(scored=int(solved.weighed[0])) if ended.verdict is None else ended.verdict.ledger,
            sampling_probability=None,
            search=_search(ended),
            seed=0,
        ),
        notices=_notices(satellites, test, ambiguous, rival, far, freedom, integrity),
        axes=axes,
    )


def _search(ended: Ended) -> SearchKind:
    if ended.verdict is not None:
        return ended.verdict.search
    return "exhaustive" if bool(ended.solved.exhaustive[0]) else "closed"


def _global_test(squares: float, freedom: int, false_alarm: float) -> GlobalTest:
    if freedom < 1:
        return GlobalTest(squares, 0, None, None)
    return GlobalTest(squares, freedom, float(chdtri(freedom, false_alarm)), float(chdtrc(freedom, squares)))


def _dilution(problem: Problem, axes: FloatArray) -> Dilution:
    """From the unweighted design of the satellites used."""
    H = problem.A[problem.used] * problem.table.sigma_m[problem.used, None]
    Q = np.linalg.inv(H.T @ H)
    local = np.diag(axes @ Q[:3, :3] @ axes.T)
    time = float(np.trace(Q[3:, 3:]))
    east_north, up = float(local[0] + local[1]), float(local[2])
    return Dilution(
        math.sqrt(east_north + up + time),
        math.sqrt(east_north + up),
        math.sqrt(east_north),
        math.sqrt(up),
        math.sqrt(time),
    )


def _satellites(
    problem: Problem, solved: Solved, axes: FloatArray, threshold: float, options: PositionOptions
) -> Satellites:
    table, used = problem.table, problem.used
    azimuth, elevation = azimuth_elevation((table.satellites_m - problem.state[:3]) @ axes.T)
    # Variance of a residual: 1 - a N a' of a satellite that took part, 1 + a N a' of one that did not.
    spread = np.einsum("ij,jk,ik->i", problem.A, problem.N, problem.A)
    variance = np.where(used, 1.0 - spread, 1.0 + spread)
    checked = variance > _UNCHECKED
    root = np.sqrt(np.where(checked, variance, 1.0))
    statistic = np.where(checked, np.abs(problem.left_over) / root, np.nan)
    shift = float(-ndtri(options.false_alarm / (2 * used.size)) - ndtri(options.missed_detection))
    # A bias b moves the w-test by b sqrt(S_ii) / sigma, a prediction error by b / (sigma sqrt(1 + a N a')).
    reach = np.where(used, 1.0 / root, root)
    mdb = np.where(checked, shift * table.sigma_m * reach, np.inf)
    status: list[SatelliteStatus] = [
        "excluded" if not took_part else "used" if ok else "untestable"
        for took_part, ok in zip(used, checked, strict=True)
    ]
    probability = np.asarray(solved.fault_probability)
    reason = tuple(_reason(status[i], float(statistic[i]), float(probability[i])) for i in range(used.size))
    return Satellites(
        name=table.names,
        system=tuple(table.letters[0][j] for j in table.clock),
        status=tuple(status),
        inlier=used.copy(),
        fault_probability=probability,
        weight=solved.weight,
        residual_m=problem.z * table.sigma_m,
        sigma_m=table.sigma_m,
        statistic=statistic,
        threshold=threshold,
        mdb_m=mdb,
        azimuth_deg=azimuth,
        elevation_deg=elevation,
        reason=reason,
    )


def _reason(status: SatelliteStatus, statistic: float, probability: float) -> str:
    if status == "excluded":
        return f"faulty with probability {probability:.2g}; off by {statistic:.1f} standard deviations"
    if status == "untestable":
        return "used, but no other satellite checks it"
    return "agrees with the others"


def _notices(
    satellites: Satellites,
    test: GlobalTest,
    ambiguous: bool,
    rival: Rival | None,
    far: float,
    freedom: int,
    integrity: Integrity,
) -> tuple[Notice, ...]:
    found = []
    if ambiguous:
        detail = {} if rival is None else {"distance_m": rival.distance_m, "probability": rival.probability}
        found.append(notice(NoticeCode.ambiguous_faults, far_probability=far, **detail))
    if freedom == 0:
        found.append(notice(NoticeCode.unchecked_position, used=int(satellites.inlier.sum())))
    elif "untestable" in satellites.status:
        names = [
            name
            for name, status in zip(satellites.name, satellites.status, strict=True)
            if status == "untestable"
        ]
        found.append(notice(NoticeCode.untestable_satellites, satellites=names))
    if math.isinf(integrity.hpl_m):
        found.append(
            notice(NoticeCode.unbounded_error, risk=integrity.risk, fault_prior=integrity.fault_prior)
        )
    if test.threshold is not None and test.statistic > test.threshold:
        found.append(
            notice(NoticeCode.inconsistent_ranges, statistic=test.statistic, threshold=test.threshold)
        )
    return tuple(found)
