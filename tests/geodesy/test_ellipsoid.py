"""Cartesian and geodetic coordinates."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators.geodesy.ellipsoid import FLATTENING, SEMI_MAJOR_M, to_cartesian, to_geodetic
from estimators.geodesy.local_frame import azimuth_elevation, enu_axes

LATITUDES = st.floats(-90, 90)
LONGITUDES = st.floats(-180, 180)
HEIGHTS = st.floats(-6e5, 4e7)


@given(LATITUDES, LONGITUDES, HEIGHTS)
def test_there_and_back_changes_nothing(lat: float, lon: float, height: float) -> None:
    place = np.array([lat, lon, height])
    back = to_geodetic(to_cartesian(place))
    assert back[0] == pytest.approx(lat, abs=1e-11)
    assert back[2] == pytest.approx(height, abs=1e-6)
    # Close to a pole the longitude means nothing.
    turn = np.cos(np.radians(lat)) * (1e7 + height) * np.sin(np.radians(back[1] - lon))
    assert turn == pytest.approx(0.0, abs=1e-5)


def test_poles_and_equator_are_where_the_axes_of_the_ellipsoid_end() -> None:
    semi_minor = SEMI_MAJOR_M * (1 - FLATTENING)
    places = np.array([[90.0, 0.0, 0.0], [-90.0, 0.0, 0.0], [0.0, 90.0, 0.0], [0.0, 180.0, 0.0]])
    expected = [[0, 0, semi_minor], [0, 0, -semi_minor], [0, SEMI_MAJOR_M, 0], [-SEMI_MAJOR_M, 0, 0]]
    assert to_cartesian(places) == pytest.approx(np.array(expected), abs=1e-8)


def test_the_centre_of_the_earth_has_an_answer() -> None:
    assert to_geodetic(np.zeros(3)).tolist() == [0.0, 0.0, -SEMI_MAJOR_M]


def test_a_place_published_in_both_coordinates_agrees() -> None:
    # EPSG Guidance Note 7-2, method 9602.
    cartesian = np.array([3771793.968, 140253.342, 5124304.349])
    lat, lon, height = to_geodetic(cartesian)
    assert lat == pytest.approx(53 + 48 / 60 + 33.820 / 3600, abs=1e-8)
    assert lon == pytest.approx(2 + 7 / 60 + 46.380 / 3600, abs=1e-8)
    assert height == pytest.approx(73.0, abs=2e-3)


@given(LATITUDES, LONGITUDES)
def test_the_local_axes_are_a_right_handed_frame(lat: float, lon: float) -> None:
    axes = enu_axes(lat, lon)
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)


def test_azimuth_turns_clockwise_from_north() -> None:
    azimuth, elevation = azimuth_elevation(np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 0.0]]))
    assert azimuth == pytest.approx([0.0, 90.0, 270.0])
    assert elevation == pytest.approx([0.0, 45.0, 0.0])
