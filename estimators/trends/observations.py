"""What was seen on the way and the caller should know: the typed notices of an answer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray, Reason
from estimators.consensus.found import Found
from estimators.consensus.presets import Preset
from estimators.inference.columns import ColumnUncertainty
from estimators.inference.sandwich import LineUncertainty
from estimators.noise.resolution import Quantisation
from estimators.notices import Notice, NoticeCode, notice
from estimators.series import Series
from estimators.trends.trend import RunnerUp

FEW_POINTS = 8
NOTABLE_CORRELATION = 0.25
LEAST_SAMPLING_PROBABILITY = 0.95
COARSE_QUANTUM = 1.0
"""Quantum in noise scales from which rounding is worth a notice."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What notices are drawn from."""

    series: Series
    preset: Preset
    found: Found
    inliers: int
    spread: LineUncertainty | ColumnUncertainty | None
    quantisation: Quantisation
    floor: float
    rmse: float | None
    runner_up: RunnerUp | None


_ABOUT_ROWS = ((Reason.missing, NoticeCode.missing_values), (Reason.invalid, NoticeCode.invalid_values))


def input_notices(series: Series) -> tuple[Notice, ...]:
    """Notices about the input alone."""
    notices: list[Notice] = []
    if series.rows is not None:
        for reason, code in _ABOUT_ROWS:
            rows = int(np.count_nonzero(series.reasons == reason))
            if rows:
                notices.append(notice(code, rows=rows))
    if not series.was_sorted:
        notices.append(notice(NoticeCode.unsorted_times))
    if series.duplicate_times:
        notices.append(notice(NoticeCode.duplicate_times, points=series.duplicate_times))
    if series.float_nanoseconds:
        notices.append(notice(NoticeCode.float_nanoseconds))
    return tuple(notices)


def _is_constant(y: FloatArray) -> bool:
    # The first pair settles it for nearly every series.
    return bool(y[0] == y[-1]) and float(y.min()) == float(y.max())


def collect_notices(seen: Evidence) -> tuple[Notice, ...]:
    """All notices of an answer, those about the input first."""
    notices = list(input_notices(seen.series))
    n = seen.series.n
    found = seen.found
    if not seen.preset.robust:
        notices.append(notice(NoticeCode.not_robust, method=seen.preset.name))
    if n == 2:
        notices.append(notice(NoticeCode.no_redundancy))
    elif n < FEW_POINTS:
        notices.append(notice(NoticeCode.few_points, points=n))
    if _is_constant(seen.series.y):
        notices.append(notice(NoticeCode.constant_values))
    elif n > 2 and _is_exact(seen):
        notices.append(notice(NoticeCode.zero_noise, sigma=found.sigma))
    if seen.quantisation.is_quantised and seen.quantisation.quantum > COARSE_QUANTUM * found.sigma:
        notices.append(notice(NoticeCode.quantised_values, quantum=seen.quantisation.quantum))
    if 2 * seen.inliers < n:
        notices.append(notice(NoticeCode.low_inlier_ratio, inlier_ratio=seen.inliers / n))
    drawn = found.sampling_probability
    # For models of many columns, auto starts from robust fits as well and does not rest on its samples.
    rests_on_samples = seen.preset.search.needs_threshold or not isinstance(seen.spread, ColumnUncertainty)
    if rests_on_samples and drawn is not None and drawn < LEAST_SAMPLING_PROBABILITY:
        notices.append(notice(NoticeCode.low_sampling_probability, sampling_probability=drawn))
    if seen.spread is not None and seen.spread.lag1 > NOTABLE_CORRELATION:
        notices.append(
            notice(NoticeCode.serial_correlation, lag1=seen.spread.lag1, effective_n=seen.spread.effective_n)
        )
    if seen.runner_up is not None and seen.runner_up.equally_good:
        notices.append(notice(NoticeCode.ambiguous_structure, **dict(seen.runner_up.parameters)))
    return tuple(notices)


def _is_exact(seen: Evidence) -> bool:
    """Whether the inliers are as near to the line as arithmetic can tell, and not because of rounding."""
    if seen.quantisation.is_quantised:
        return False
    nearest = seen.found.sigma if seen.rmse is None else min(seen.found.sigma, seen.rmse)
    return nearest <= 4.0 * seen.floor
