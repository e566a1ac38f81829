"""What must not change an answer: where on Earth a track is, when, its order of rows, and asking twice."""

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import Track, clean_trajectory
from estimators.geodesy.plane import Plane
from tests.trajectories.drives import MUNICH, Drive, drive, with_bursts, with_spikes

MADE = with_bursts(with_spikes(drive(8), share=0.05))


def _moved(plane: Plane) -> tuple[np.ndarray, Track]:
    track = MADE.clean(plane)
    return MADE.places(track, plane), track


@pytest.mark.parametrize(
    ("latitude", "longitude"), [(48.1, 180.0), (48.1, -179.999), (90.0, 0.0), (-89.99, 77.0), (0.0, 180.0)]
)
def test_a_track_moved_to_the_antimeridian_or_a_pole_has_the_same_answer_within_a_centimetre(
    latitude: float, longitude: float
) -> None:
    there, track = _moved(Plane(latitude, longitude))
    here, unmoved = _moved(MUNICH)
    assert np.abs(there - here).max() < 0.01
    assert track.points.reason == unmoved.points.reason
    assert np.all(np.abs(track.lon_deg) <= 180.0)


@settings(max_examples=15, deadline=None)
@given(latitude=st.floats(-90.0, 90.0), longitude=st.floats(-180.0, 180.0))
def test_a_track_moved_anywhere_has_the_same_answer_within_a_centimetre(
    latitude: float, longitude: float
) -> None:
    assert np.abs(_moved(Plane(latitude, longitude))[0] - _moved(MUNICH)[0]).max() < 0.01


@settings(max_examples=15, deadline=None)
@given(shift=st.integers(-(10**9), 10**9))
def test_a_track_at_another_time_has_the_same_answer(shift: int) -> None:
    lat, lon = MUNICH.locate(MADE.fixes)
    later = clean_trajectory(MADE.t.astype(np.int64) + shift, lat, lon)
    assert isinstance(later, Track)
    np.testing.assert_array_equal(later.lat_deg, MADE.clean().lat_deg)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_order_of_rows_changes_nothing_but_the_order_of_the_answer(seed: int) -> None:
    order = np.random.default_rng(seed).permutation(MADE.t.size)
    mixed = Drive(MADE.t[order], MADE.fixes[order], MADE.truth[order], MADE.faulty[order]).clean()
    straight = MADE.clean()
    np.testing.assert_array_equal(mixed.lat_deg, straight.lat_deg[order])
    np.testing.assert_array_equal(mixed.points.inlier, straight.points.inlier[order])


@settings(max_examples=40, deadline=None)
@given(
    rows=st.lists(
        st.tuples(
            st.integers(-50, 50).map(float) | st.integers(-(10**9), 10**9).map(float) | st.just(math.nan),
            st.floats(-100.0, 100.0) | st.sampled_from([math.nan, 0.0, 48.0, 90.0]),
            st.floats(-400.0, 400.0) | st.sampled_from([math.nan, 0.0, 11.0, 180.0]),
            st.floats(-1e5, 1e5) | st.just(math.nan),
        ),
        max_size=30,
    )
)
def test_whatever_comes_in_there_is_a_row_out_and_no_nan_beside_a_time(
    rows: list[tuple[float, float, float, float]],
) -> None:
    t, lat, lon, height = np.array(rows).reshape(-1, 4).T
    found = clean_trajectory(t, lat, lon, height_m=height)
    if not isinstance(found, Track):
        assert len(found.points.reason) == len(rows)
        return
    assert len(found) == len(rows)
    timed = np.isfinite(t)
    for column in (found.lat_deg, found.lon_deg, found.sigma_m, found.speed_mps, found.heading_sigma_deg):
        assert np.isfinite(column[timed]).all()
    assert not re.search(r"\bNaN|Infinity\b", str(found.to_dict()))


def test_the_same_input_gives_the_same_bytes() -> None:
    first, second = MADE.clean(), MADE.clean()
    assert first.lat_deg.tobytes() == second.lat_deg.tobytes()
    assert first.to_dict() == second.to_dict()
