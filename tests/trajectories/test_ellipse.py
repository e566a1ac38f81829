"""Error ellipses as circles: as large as the ellipse, however it lies."""

import doctest

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators import InputError, Track, accuracy_of_ellipse, clean_trajectory
from estimators.trajectories import ellipse
from tests.trajectories.drives import MUNICH, drive

AXIS = st.floats(1e-3, 1e5)


def test_the_example_is_true() -> None:
    found = doctest.testmod(ellipse)
    assert found.attempted > 0
    assert found.failed == 0


def test_the_circle_of_a_circle_holds_68_percent_of_its_errors() -> None:
    errors = 7.0 * np.random.default_rng(0).normal(size=(100_000, 2))
    (radius,) = accuracy_of_ellipse([7.0], [7.0])
    assert np.mean(np.hypot(*errors.T) < radius) == pytest.approx(0.68, abs=0.005)


def test_the_mean_square_is_that_of_the_ellipse() -> None:
    errors = np.random.default_rng(0).normal(size=(100_000, 2)) * [30.0, 4.0]
    (radius,) = accuracy_of_ellipse([30.0], [4.0])
    assert 2.0 * (radius / ellipse.RADIUS_68) ** 2 == pytest.approx(
        np.mean(np.sum(errors**2, axis=1)), rel=0.02
    )


@given(AXIS, AXIS)
def test_the_circle_lies_between_the_axes_whichever_is_longer(one: float, other: float) -> None:
    (radius,) = accuracy_of_ellipse([one], [other])
    assert radius == accuracy_of_ellipse([other], [one])[0]
    assert min(one, other) <= radius / ellipse.RADIUS_68 * (1 + 1e-12)
    assert radius / ellipse.RADIUS_68 <= max(one, other) * (1 + 1e-12)


@pytest.mark.parametrize("missing", [np.nan, None, -1.0, np.inf])
def test_a_missing_axis_leaves_no_radius(missing: float | None) -> None:
    found = accuracy_of_ellipse([5.0, missing, 5.0], [missing, 5.0, 5.0])  # type: ignore[list-item]
    assert np.isnan(found).tolist() == [True, True, False]


def test_columns_of_different_length_are_refused() -> None:
    with pytest.raises(InputError, match="semi_minor_m: 1 values for 2"):
        accuracy_of_ellipse([1.0, 2.0], [1.0])


def test_fixes_of_large_ellipses_count_less() -> None:
    made = drive(6, n=300)
    large = np.arange(300) % 3 == 0
    fixes = made.fixes + np.where(large[:, None], 1.0, 0.0) * 25.0 * np.random.default_rng(1).normal(
        size=(300, 2)
    )
    lat, lon = MUNICH.locate(fixes)
    major, minor = np.where(large, 35.0, 4.0), np.where(large, 5.0, 2.0)
    plain = clean_trajectory(made.t, lat, lon)
    helped = clean_trajectory(made.t, lat, lon, accuracy_m=accuracy_of_ellipse(major, minor))
    assert isinstance(plain, Track)
    assert isinstance(helped, Track)
    assert made.error(helped) < 0.9 * made.error(plain)
