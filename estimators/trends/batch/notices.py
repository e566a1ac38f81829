"""Codes of the notices of many series: the conditions of :mod:`..observations`, on columns."""

from __future__ import annotations

import numpy as np

from estimators.arrays import BoolArray, FloatArray
from estimators.consensus.presets import PRESETS
from estimators.notices import NoticeCode
from estimators.regression.influence import INLIERS
from estimators.series import EPOCH_NANOSECONDS
from estimators.trends.batch.group import Group
from estimators.trends.batch.lines import Lines
from estimators.trends.batch.source import Source
from estimators.trends.observations import (
    COARSE_QUANTUM,
    FEW_POINTS,
    LEAST_SAMPLING_PROBABILITY,
    NOTABLE_CORRELATION,
    input_notices,
)


def notice_codes(
    source: Source,
    group: Group,
    lines: Lines,
    rmse: FloatArray,
    lag1: FloatArray,
    ambiguous: BoolArray,
) -> list[tuple[str, ...]]:
    """Codes per series, in the order in which the notices of one answer stand.

    Parameters
    ----------
    source : Source
    group : Group
    lines : Lines
        One in every series.
    rmse, lag1 : ndarray of float64, shape (m,)
        NaN where there is none.
    ambiguous : ndarray of bool, shape (m,)
    """
    n = group.lengths
    exact = np.fmin(lines.sigma, rmse) <= 4.0 * group.floor
    everywhere = np.ones(n.size, dtype=np.bool_)
    conditions = (
        (NoticeCode.float_nanoseconds, everywhere & _came_as_floats(source, group)),
        (NoticeCode.not_robust, everywhere & (not PRESETS[source.settings.method].robust)),
        (NoticeCode.no_redundancy, n == 2),
        (NoticeCode.few_points, (n > 2) & (n < FEW_POINTS)),
        (NoticeCode.constant_values, group.constant),
        (NoticeCode.zero_noise, ~group.constant & (n > 2) & (group.quantum == 0.0) & exact),
        (NoticeCode.quantised_values, group.quantum > COARSE_QUANTUM * lines.sigma),
        (NoticeCode.low_inlier_ratio, 2.0 * lines.sums[:, INLIERS] < n),
        (NoticeCode.low_sampling_probability, lines.sampling_probability < LEAST_SAMPLING_PROBABILITY),
        (NoticeCode.serial_correlation, lag1 > NOTABLE_CORRELATION),
        (NoticeCode.ambiguous_structure, ambiguous),
    )
    marks = np.zeros(n.size, dtype=np.int64)
    for bit, (_, seen) in enumerate(conditions):
        marks |= seen.astype(np.int64) << bit
    # Few of the 2^11 combinations occur, each in many series.
    told = {
        mark: tuple(code.value for bit, (code, _) in enumerate(conditions) if mark >> bit & 1)
        for mark in np.unique(marks).tolist()
    }
    codes = [told[mark] for mark in marks.tolist()]
    for j, series in group.checked.items():
        first = tuple(item.code.value for item in input_notices(series))
        codes[j] = first + codes[j]
    return codes


def _came_as_floats(source: Source, group: Group) -> BoolArray:
    """Epoch nanoseconds as floats, of series that did not pass through a check of their own."""
    if source.times.dtype.kind != "f":
        return np.zeros(group.series.size, dtype=np.bool_)
    late = group.origin > EPOCH_NANOSECONDS
    late[list(group.checked)] = False
    return np.asarray(late)
