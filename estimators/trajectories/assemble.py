"""From labels and a smoothed track in the plane to the answer on the caller's rows."""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import CodeArray, FloatArray
from estimators.geodesy.ellipsoid import to_cartesian
from estimators.notices import Notice, NoticeCode, notice
from estimators.trajectories.distance import steps_of, travelled
from estimators.trajectories.estimation import Measured
from estimators.trajectories.headings import directions
from estimators.trajectories.labelling.modes import (
    ADRIFT,
    BURST,
    COLOUR_TIME_S,
    ENTRY,
    LEVEL_STRIDE,
    REDRAW,
    SPIKE,
)
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.motion import is_moving, stretches
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.reasons import FixReason
from estimators.trajectories.rows import Rows
from estimators.trajectories.smoothing.height import smooth_height
from estimators.trajectories.smoothing.solved import Solved, at_times
from estimators.trajectories.smoothing.uncertainty import position_variance
from estimators.trajectories.stale import runs_of
from estimators.trajectories.track import Distance, Track, TrackNoise, TrackPoints

_STALE_GATE = 9.21
"""99 % of chi-square with two degrees of freedom."""
_GAP_STEPS = 10.0
_GAP_M = 100.0
"""A gap is ten steps long or longer, and leaves the position that uncertain."""
_FEW = 5
_MOSTLY = 0.3
_COLOURED = 0.5
_SPARSE = 2.0


def assemble(
    rows: Rows,
    measured: Measured,
    labelled: Labelled,
    solved: Solved,
    method: str,
    options: TrackOptions,
    level: float,
) -> Track:
    """Make the answer.

    Parameters
    ----------
    rows : Rows
    measured : Measured
        The rows that measure something.
    labelled : Labelled
        What the method says of them.
    solved : Solved
    method : str
    options : TrackOptions
    level : float
        Of intervals.
    """
    places = np.ascontiguousarray(solved.states[:, :, 0])
    variance = position_variance(rows.t, rows.fixes, solved, labelled.parameters.colour_m)
    residual = np.hypot(*(rows.fixes - places).T)
    gaps = _gaps(rows, labelled)
    codes = _reasons(rows, solved, variance, residual, gaps)
    inlier = np.isin(codes, (FixReason.ok, FixReason.gap_edge))
    probability = np.zeros(rows.t.size)
    probability[rows.measures] = labelled.probability
    probability[rows.repeat] = np.where(inlier[rows.repeat], 1.0, 0.0)
    # A duplicate is what its twin is, and so is its label; its reason stays.
    twins = rows.twin
    probability, inlier = probability[twins], inlier[twins]
    usable = rows.codes[rows.order] != FixReason.invalid
    inlier &= usable & (rows.codes[rows.order] != FixReason.out_of_order)
    probability[~usable] = math.nan
    residual[~usable] = math.nan
    known = rows.codes[rows.order] != FixReason.ok
    codes[known] = rows.codes[rows.order][known]

    latitude, longitude = rows.plane.locate(places)
    ground = _on_ground(latitude, longitude)
    sigma = np.sqrt(variance)
    moving = is_moving(rows.t, places, sigma)
    if rows.shift.any():
        # What stands beside a time is the place at that time, though the clock was off.
        solved = at_times(solved, rows.t, rows.t - rows.shift)
        variance = np.interp(rows.t - rows.shift, rows.t, variance)
        latitude, longitude = rows.plane.locate(solved.states[:, :, 0])
    speed, heading, speed_sigma, heading_sigma = directions(rows.plane, latitude, longitude, solved)
    height, up = None, np.full(rows.t.size, math.nan)
    if rows.height is not None:
        height, up = smooth_height(rows.t, rows.height, inlier)
    covariance = np.zeros((rows.t.size, 3, 3))
    covariance[:, 0, 0] = covariance[:, 1, 1] = variance
    covariance[:, 2, 2] = up

    parameters = labelled.parameters
    unit = 1.0 if rows.reported is None else float(np.median(rows.reported))
    raw = rows.measures
    reasons, flags = rows.codes.copy(), np.zeros(rows.codes.size, dtype=np.bool_)
    reasons[rows.order], flags[rows.order] = codes, inlier
    return Track(
        method=method,
        time=rows.time,
        points=TrackPoints(
            flags,
            _spread(rows, probability),
            _spread(rows, residual),
            reasons,
        ),
        lat_deg=_spread(rows, latitude),
        lon_deg=_spread(rows, longitude),
        height_m=None if height is None else _spread(rows, height),
        covariance_enu_m2=_spread(rows, covariance),
        speed_mps=_spread(rows, speed),
        speed_sigma_mps=_spread(rows, speed_sigma),
        heading_deg=_spread(rows, heading),
        heading_sigma_deg=_spread(rows, heading_sigma),
        noise=TrackNoise(
            parameters.sigma * unit,
            parameters.colour_m,
            COLOUR_TIME_S,
            parameters.manoeuvre,
            "estimated" if options.sigma_m is None else "given",
        ),
        distance=Distance(
            float(np.sum(steps_of(_on_ground(rows.lat_deg[rows.order][raw], rows.lon_deg[rows.order][raw])))),
            travelled(ground, sigma, level),
        ),
        stretches=stretches(rows.t, ground, sigma, speed, moving, rows.order, level),
        level=level,
        notices=_notices(rows, measured, labelled, codes, gaps),
        input_lat_deg=rows.lat_deg,
        input_lon_deg=rows.lon_deg,
    )


def _reasons(
    rows: Rows, solved: Solved, variance: FloatArray, residual: FloatArray, gaps: list[int]
) -> CodeArray:
    """Reasons of the rows in order of time, as far as labels say them."""
    codes = np.zeros(rows.t.size, dtype=np.uint8)
    kind = solved.labels % LEVEL_STRIDE
    codes[kind == SPIKE] = FixReason.spike
    codes[np.isin(kind, (ENTRY, BURST, REDRAW, ADRIFT))] = FixReason.burst
    off = residual**2 > _STALE_GATE * (variance + solved.variance)
    for first, stop in runs_of(rows.repeat):
        if off[first:stop].any():
            codes[first:stop] = FixReason.stale
    for place in gaps:
        for edge in (place, place + 1):
            if codes[edge] == FixReason.ok:
                codes[edge] = FixReason.gap_edge
    return codes


def _gaps(rows: Rows, labelled: Labelled) -> list[int]:
    """Places after which there is a gap."""
    steps = np.diff(rows.t)
    if steps.size < _FEW:
        return []
    hidden = np.sqrt(labelled.parameters.manoeuvre * steps**3 / 3.0)
    typical = float(np.median(steps))
    return list(np.flatnonzero((steps > _GAP_STEPS * typical) & (hidden > _GAP_M)).tolist())


def _on_ground(latitude: FloatArray, longitude: FloatArray) -> FloatArray:
    return to_cartesian(np.column_stack([latitude, longitude, np.zeros(latitude.size)]))


def _spread(rows: Rows, values: FloatArray) -> FloatArray:
    """Put values in order of time back on the caller's rows; NaN where there is no time."""
    out = np.full((rows.codes.size, *values.shape[1:]), math.nan)
    out[rows.order] = values
    return out


def _notices(
    rows: Rows, measured: Measured, labelled: Labelled, codes: CodeArray, gaps: list[int]
) -> tuple[Notice, ...]:
    """Say what is worth knowing."""
    found = []
    parameters = labelled.parameters
    m = measured.t.size
    bad = int(np.isin(codes, (FixReason.spike, FixReason.burst, FixReason.stale)).sum())
    sigma = parameters.sigma * (1.0 if measured.reported is None else float(np.median(measured.reported)))
    counts = np.bincount(codes, minlength=len(FixReason))
    if m < _FEW:
        found.append(notice(NoticeCode.few_fixes, fixes=m))
    if bad > _MOSTLY * codes.size:
        found.append(notice(NoticeCode.mostly_faulty, share=round(bad / codes.size, 3)))
    # Where most fixes count as faulty, errors that last pass for the motion.
    if m >= _FEW and (parameters.colour_m > _COLOURED * sigma or bad > _MOSTLY * codes.size):
        found.append(notice(NoticeCode.drift_unobservable, coloured_m=parameters.colour_m))
    if m >= _FEW:
        step = float(np.median(np.diff(measured.t)))
        hidden = math.sqrt(parameters.manoeuvre * step**3 / 3.0)
        if hidden > _SPARSE * sigma:
            found.append(notice(NoticeCode.sampling_too_sparse, step_s=step, hidden_m=hidden))
    if counts[FixReason.stale]:
        found.append(notice(NoticeCode.stale_positions, rows=int(counts[FixReason.stale])))
    shifted = int(np.count_nonzero(rows.codes == FixReason.out_of_order))
    if shifted:
        found.append(notice(NoticeCode.clock_jumped, rows=shifted))
    if gaps:
        found.append(notice(NoticeCode.long_gaps, gaps=len(gaps)))
    invalid = int(np.count_nonzero(rows.codes == FixReason.invalid))
    if invalid:
        found.append(notice(NoticeCode.invalid_rows, rows=invalid))
    if not rows.was_sorted:
        found.append(notice(NoticeCode.unsorted_times))
    return tuple(found)
