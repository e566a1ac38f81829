from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators.trends.presentation.units import (
    moment_text,
    natural_unit,
    p_value_text,
    percent,
    rounded,
    significant,
)

VALUES = st.floats(-1e12, 1e12, allow_subnormal=False).filter(lambda value: value == 0 or abs(value) > 1e-12)
ERRORS = st.floats(1e-15, 1e12)


@given(VALUES, ERRORS)
def test_rounding_loses_less_than_a_tenth_of_the_uncertainty(value: float, error: float) -> None:
    assert abs(float(rounded(value, error)) - value) <= max(0.1 * error, 1e-6 * abs(value))


@given(VALUES)
def test_without_an_uncertainty_six_digits_are_kept(value: float) -> None:
    assert float(rounded(value, None)) == pytest.approx(value, rel=1e-5)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_what_is_not_finite_is_a_dash(value: float) -> None:
    assert rounded(value, 1.0) == significant(value) == "–"


@given(st.floats(0.0, 1.0))
def test_only_certainty_is_100_percent_and_only_nothing_is_0(share: float) -> None:
    assert (percent(share) == "100 %") == (share == 1.0)
    assert (percent(share) == "0 %") == (share == 0.0)


def test_a_p_value_of_zero_is_told_as_smaller_than_floats_hold() -> None:
    assert p_value_text(0.0) == "< 1e-300"
    assert p_value_text(0.0312) == "0.031"
    assert p_value_text(None) == "–"


@pytest.mark.parametrize(
    ("span_s", "name"),
    [(0.5, "second"), (119, "second"), (120, "minute"), (7200, "hour"), (2 * 86400, "day"), (8e7, "year")],
)
def test_the_unit_is_the_largest_that_fits_twice(span_s: float, name: str) -> None:
    assert natural_unit(span_s).name == name


@pytest.mark.parametrize(
    ("moment", "told"),
    [
        (np.datetime64("2024-02-29"), "2024-02-29"),
        (np.datetime64("2024-02-29T14:05"), "2024-02-29 14:05"),
        (np.datetime64("2024-02-29T14:05:10"), "2024-02-29 14:05:10"),
        (np.datetime64("2024-02-29T14:05:10.250"), "2024-02-29 14:05:10.25"),
        (np.datetime64("2024-02-29T00:00:00.000000001"), "2024-02-29 00:00:00.000000001"),
        (np.datetime64("NaT"), "–"),
        (np.int64(1_700_000_000_000_000_001), "1700000000000000001"),
        (0.1, "0.1"),
        (math.nan, "–"),
    ],
)
def test_times_are_written_for_people(moment: np.datetime64 | float, told: str) -> None:
    assert moment_text(moment) == told
