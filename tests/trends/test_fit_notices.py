"""Every notice can occur, and clean data get none."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
import pytest

from estimators import Notice, NoticeCode, RobustOptions
from estimators.notices import POSITION_NOTICES, TRACK_NOTICES
from tests.trends.contaminated import contaminated, fitted, two_lines

T = np.arange(100.0)
NOISE = np.random.default_rng(16).normal(size=100)
LINE = 5.0 + 0.1 * T + NOISE
BRIEF = RobustOptions(max_hypotheses=2, min_hypotheses=1, work_budget=0)


def _correlated() -> np.ndarray:
    drift = np.zeros(100)
    for i in range(1, 100):
        drift[i] = 0.8 * drift[i - 1] + NOISE[i]
    return 0.1 * T + drift


def _with(y: np.ndarray, row: int, value: float) -> np.ndarray:
    changed = y.copy()
    changed[row] = value
    return changed


CASES: dict[NoticeCode, Callable[[], Iterable[Notice]]] = {
    NoticeCode.few_points: lambda: fitted(T[:5], LINE[:5]).notices,
    NoticeCode.no_redundancy: lambda: fitted(T[:2], LINE[:2]).notices,
    NoticeCode.ambiguous_structure: lambda: fitted(*two_lines(200, 0.5)).notices,
    NoticeCode.low_inlier_ratio: lambda: fitted(*contaminated(200, 0.6)[:2]).notices,
    NoticeCode.low_sampling_probability: lambda: (
        fitted(*contaminated(100, 0.5)[:2], method="ransac", options=BRIEF).notices
    ),
    NoticeCode.serial_correlation: lambda: fitted(T, _correlated()).notices,
    NoticeCode.quantised_values: lambda: fitted(T, 5.0 * np.round(LINE / 5.0)).notices,
    NoticeCode.zero_noise: lambda: fitted(T, 2.0 + 0.5 * T).notices,
    NoticeCode.constant_values: lambda: fitted(T, np.full(100, 4.0)).notices,
    NoticeCode.duplicate_times: lambda: fitted(np.repeat(T[:50], 2), LINE).notices,
    NoticeCode.unsorted_times: lambda: fitted(T[::-1], LINE).notices,
    NoticeCode.missing_values: lambda: fitted(T, _with(LINE, 3, np.nan)).notices,
    NoticeCode.invalid_values: lambda: fitted(T, _with(LINE, 3, np.inf)).notices,
    NoticeCode.float_nanoseconds: lambda: fitted(1.7e18 + 1e9 * T, LINE).notices,
    NoticeCode.extrapolation: lambda: fitted(T, LINE).predict([200.0]).notices,
    NoticeCode.not_robust: lambda: fitted(T, LINE, method="ols").notices,
    NoticeCode.nonpositive_values: lambda: (
        fitted(T, _with(LINE, 3, 0.0), model="exponential", noise="multiplicative").notices
    ),
    NoticeCode.undetermined_noise: lambda: fitted(T, 100.0 + NOISE, model="exponential").notices,
    NoticeCode.earlier_regimes: lambda: fitted(T, LINE + 20.0 * (T[60] < T), regime="last").notices,
    NoticeCode.rate_near_zero: lambda: fitted(T, 100.0 + NOISE, model="exponential").notices,
}


ELSEWHERE = POSITION_NOTICES | TRACK_NOTICES


@pytest.mark.parametrize("code", [code for code in NoticeCode if code not in ELSEWHERE])
def test_every_notice_occurs_where_it_should(code: NoticeCode) -> None:
    found = {item.code: item for item in CASES[code]()}
    assert code in found
    assert found[code].message


def test_a_clean_series_has_nothing_to_be_said_about_it() -> None:
    assert fitted(T, LINE).notices == ()


def test_a_notice_tells_its_numbers() -> None:
    trend = fitted(T, _with(_with(LINE, 3, np.nan), 9, np.nan))
    assert trend.notices[0].detail == {"rows": 2}
