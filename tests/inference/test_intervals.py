"""Quantiles and p-values of Student's t."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm, t

from estimators.inference.intervals import student_quantile, two_sided_p


@given(level=st.floats(0.01, 0.999), dof=st.floats(1.0, 1e4))
def test_the_quantile_leaves_half_of_the_rest_on_either_side(level: float, dof: float) -> None:
    assert t.cdf(student_quantile(level, dof), dof) == pytest.approx(0.5 * (1.0 + level), rel=1e-9)


def test_infinitely_many_degrees_of_freedom_are_the_normal_law() -> None:
    assert student_quantile(0.95, math.inf) == pytest.approx(norm.ppf(0.975))
    assert two_sided_p(1.96, math.inf) == pytest.approx(0.05, abs=1e-4)


def test_without_degrees_of_freedom_there_is_neither() -> None:
    assert math.isnan(student_quantile(0.95, None))
    assert two_sided_p(3.0, None) is None
    assert two_sided_p(math.nan, 5.0) is None


@given(level=st.floats(0.01, 0.999), dof=st.floats(1.0, 1e4))
def test_a_statistic_at_the_quantile_has_the_p_value_that_is_left(level: float, dof: float) -> None:
    assert two_sided_p(student_quantile(level, dof), dof) == pytest.approx(1.0 - level, rel=1e-6)


@given(st.floats(-50.0, 50.0))
def test_p_values_are_two_sided(statistic: float) -> None:
    assert two_sided_p(statistic, 7.0) == two_sided_p(-statistic, 7.0)


@pytest.mark.parametrize(("statistic", "p_value"), [(0.0, 1.0), (math.inf, 0.0), (-math.inf, 0.0)])
def test_the_ends_of_the_scale_are_exact(statistic: float, p_value: float) -> None:
    assert two_sided_p(statistic, 9.0) == p_value
