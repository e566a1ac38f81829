import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from estimators.geodesy.ellipsoid import to_cartesian
from estimators.geodesy.plane import Plane


@given(
    latitude=st.floats(-90.0, 90.0),
    longitude=st.floats(-180.0, 180.0),
    east=st.floats(-2e5, 2e5),
    north=st.floats(-2e5, 2e5),
)
def test_a_place_comes_back_from_the_plane(
    latitude: float, longitude: float, east: float, north: float
) -> None:
    plane = Plane(latitude, longitude)
    wanted = np.array([[east, north]])
    assert np.abs(plane.project(*plane.locate(wanted)) - wanted).max() < 1e-4


@given(latitude=st.floats(-90.0, 90.0), angle=st.floats(0.0, 6.28))
def test_distances_from_the_centre_are_those_on_the_ground(latitude: float, angle: float) -> None:
    plane = Plane(latitude, 180.0)
    far = 1000.0 * np.array([[np.cos(angle), np.sin(angle)]])
    there = np.column_stack([*plane.locate(far), [0.0]])
    here = np.array([[latitude, 180.0, 0.0]])
    assert abs(np.linalg.norm(to_cartesian(there) - to_cartesian(here)) - 1000.0) < 0.01


def test_the_centre_is_the_origin() -> None:
    assert np.abs(Plane(10.0, 20.0).project(np.array([10.0]), np.array([20.0]))).max() < 1e-8


def test_the_other_side_of_the_earth_has_a_place() -> None:
    assert np.isfinite(Plane(0.0, 0.0).project(np.array([0.0, 5.0]), np.array([180.0, -170.0]))).all()
