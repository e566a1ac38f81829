"""From lines to rows of the table: inference, quality and notices of a slice of series at once.

The arithmetic is that of :mod:`estimators.trends.line.fit`, in the same order: plain functions run here as
compiled twins, quantiles are the same scipy functions on whole columns.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types
from scipy.special import stdtr

from estimators.arrays import BoolArray, FloatArray, IntArray, Reason
from estimators.inference.chance import chances_of_lines
from estimators.inference.intervals import student_quantiles
from estimators.inference.sandwich import sandwich
from estimators.kernels import device, kernel, ro
from estimators.regression.influence import INLIERS, SSE, VALUE, VALUE_SQUARE
from estimators.trends.batch.columns import Columns
from estimators.trends.batch.group import Group
from estimators.trends.batch.lines import Lines
from estimators.trends.batch.notices import notice_codes
from estimators.trends.quality import quality

CENTER, LEVEL, SLOPE, LEVEL_STDERR, SLOPE_STDERR, EFFECTIVE_N, LAG1, DOF, R2, RMSE = range(10)
"""Rows of what :func:`fill_facts` writes."""

_sandwich = device(sandwich)
_quality = device(quality)
_REAL = types.float64


@kernel(
    types.void(
        ro(_REAL, 2), ro(types.int64), ro(_REAL), ro(_REAL, 2), ro(_REAL), ro(_REAL), types.boolean,
        _REAL[:, ::1],
    )
)  # fmt: skip
def fill_facts(
    sums: FloatArray,
    n: IntArray,
    sigma: FloatArray,
    theta: FloatArray,
    middle: FloatArray,
    half: FloatArray,
    correct: bool,
    facts: FloatArray,
) -> None:
    """Uncertainty, line in the caller's time, and quality of many series; NaN where there is none."""
    for k in range(n.size):
        known, center, level_variance, slope_variance, effective, lag1, dof, _ = _sandwich(
            sums[k], n[k], sigma[k], correct
        )
        if not known:
            center, level_variance, slope_variance = 0.0, np.nan, np.nan
            effective, lag1, dof = np.nan, np.nan, np.nan
        facts[CENTER, k] = middle[k] + half[k] * center
        facts[LEVEL, k] = theta[k, 0] + theta[k, 1] * center
        facts[SLOPE, k] = theta[k, 1] / half[k]
        facts[LEVEL_STDERR, k] = math.sqrt(level_variance)
        facts[SLOPE_STDERR, k] = math.sqrt(slope_variance) / half[k]
        facts[EFFECTIVE_N, k], facts[LAG1, k], facts[DOF, k] = effective, lag1, dof
        facts[R2, k], facts[RMSE, k] = np.nan, np.nan
        if sums[k, INLIERS] > 0.0:
            facts[R2, k], facts[RMSE, k] = _quality(
                sums[k, INLIERS], sums[k, SSE], sums[k, VALUE], sums[k, VALUE_SQUARE]
            )


def conclude(columns: Columns, group: Group, lines: Lines, ambiguous: BoolArray) -> None:
    """Write the rows of series that have a line.

    Parameters
    ----------
    columns : Columns
    group : Group
    lines : Lines
    ambiguous : ndarray of bool, shape (m,)
        Whether another line is equally good.
    """
    asked = columns.source.settings
    n = group.lengths
    facts = np.empty((10, n.size))
    fill_facts(
        lines.sums, n, lines.sigma, lines.theta, group.middle, group.half,
        asked.options.correct_serial_correlation, facts,
    )  # fmt: skip
    dated = group.origin.dtype.kind == "M"
    away = (0.0 if dated else -group.origin.astype(np.float64)) - facts[CENTER]
    slope, slope_stderr = facts[SLOPE], facts[SLOPE_STDERR]
    intercept = facts[LEVEL] + slope * away
    # math.hypot, as for one series: numpy's differs in the last digit.
    across = map(math.hypot, facts[LEVEL_STDERR].tolist(), (slope_stderr * away).tolist())
    intercept_stderr = np.fromiter(across, np.float64, n.size)
    quantile = student_quantiles(asked.level, facts[DOF])
    to = group.series
    for name, value, stderr in (
        ("slope", slope, slope_stderr),
        ("intercept", intercept, intercept_stderr),
    ):
        margin = quantile * stderr
        estimates = columns.estimates(name)
        estimates.value[to], estimates.stderr[to] = value, stderr
        estimates.low[to], estimates.high[to] = value - margin, value + margin
    inliers = lines.sums[:, INLIERS].astype(np.int64)
    columns.fitted[to] = True
    columns.origin[to] = group.origin if dated else 0.0
    columns.n[to], columns.inliers[to] = n, inliers
    numbers = columns.numbers
    numbers["inlier_ratio"][to] = inliers / n
    numbers["sigma"][to], numbers["threshold"][to] = lines.sigma, lines.threshold
    chance = chances_of_lines(n, inliers, lines.threshold, group.central)
    numbers["p_value"][to] = np.maximum(_two_sided(slope, slope_stderr, facts[DOF]), chance)
    numbers["r2"][to], numbers["rmse"][to] = facts[R2], facts[RMSE]
    numbers["effective_n"][to], numbers["lag1"][to] = facts[EFFECTIVE_N], facts[LAG1]
    numbers["dof"][to] = facts[DOF]
    codes = notice_codes(columns.source, group, lines, facts[RMSE], facts[LAG1], ambiguous)
    for k, told in zip(to.tolist(), codes, strict=True):
        columns.notices[k] = told
    _write_points(columns, group, lines)


def _two_sided(slope: FloatArray, stderr: FloatArray, dof: FloatArray) -> FloatArray:
    with np.errstate(divide="ignore", invalid="ignore"):
        statistic = slope / stderr
    # A level line without noise has no statistic to show.
    statistic[(stderr == 0.0) & (slope == 0.0)] = 0.0
    return np.asarray(2.0 * stdtr(dof, -np.abs(statistic)))


def _write_points(columns: Columns, group: Group, lines: Lines) -> None:
    if columns.points is None:
        return
    rows, points = group.rows, columns.points
    points.inlier[rows] = lines.inlier
    points.probability[rows] = lines.probability
    points.residual[rows] = lines.residual
    if isinstance(rows, slice):
        # Every row is ok (0) or an outlier (1): the reason is the flag turned round.
        np.logical_not(lines.inlier, out=points.reason_codes[rows].view(np.bool_))
        return
    for j, series in group.checked.items():
        start = int(columns.source.offsets[group.series[j]])
        points.reason_codes[start : start + series.n_input] = series.reasons
    points.reason_codes[rows[~lines.inlier]] = Reason.outlier
