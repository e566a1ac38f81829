"""Tracks that go far: the plane in which they are cleaned must not show."""

import numpy as np
import pytest

from estimators import Track, clean_trajectory
from estimators.arrays import FloatArray
from estimators.geodesy.ellipsoid import to_cartesian, to_geodetic

EARTH_M = 6371e3
SIGMA_M = 5.0


def flown(kilometres: float, start: FloatArray, toward: FloatArray) -> tuple[Track, FloatArray]:
    """A flight along a great circle, a fix a second, and where it really was."""
    t = np.arange(0.0, kilometres * 1e3 / 230.0)
    start = start / np.linalg.norm(start)
    across = toward - np.dot(toward, start) * start
    across /= np.linalg.norm(across)
    angle = 230.0 * t[:, None] / EARTH_M
    directions = np.cos(angle) * start + np.sin(angle) * across
    lat = np.degrees(np.arcsin(directions[:, 2]))
    lon = np.degrees(np.arctan2(directions[:, 1], directions[:, 0]))
    truth = to_cartesian(np.column_stack([lat, lon, np.zeros(t.size)]))
    fixes = to_geodetic(truth + SIGMA_M * np.random.default_rng(3).normal(size=truth.shape))
    track = clean_trajectory(t, fixes[:, 0], fixes[:, 1])
    assert isinstance(track, Track)
    return track, truth


@pytest.mark.parametrize("kilometres", [100.0, 1000.0, 8000.0])
@pytest.mark.parametrize(
    ("start", "toward"),
    [
        (np.array([0.6, 0.2, 0.7]), np.array([0.0, 0.8, 0.3])),
        (np.array([-1.0, 0.3, 0.4]), np.array([0.0, -1.0, 0.2])),
        (np.array([0.5, 0.1, 0.9]), np.array([-0.6, 0.0, 0.5])),
    ],
    ids=["Europe to Asia", "across the antimeridian", "across the pole"],
)
def test_a_flight_is_smoothed_and_measured_whatever_its_length(
    kilometres: float, start: FloatArray, toward: FloatArray
) -> None:
    track, truth = flown(kilometres, start, toward)
    found = to_cartesian(np.column_stack([track.lat_deg, track.lon_deg, np.zeros(len(track))]))
    off = np.linalg.norm(found - truth, axis=1)
    assert np.sqrt(np.mean(off**2)) < 0.4 * SIGMA_M
    assert track.points.inlier.mean() > 0.99
    assert np.mean(off**2 / track.sigma_m**2 < 5.991) > 0.91
    length = float(np.sum(np.linalg.norm(np.diff(truth, axis=0), axis=1)))
    assert track.distance.cleaned.value == pytest.approx(length, rel=1e-3)
    speed = np.linalg.norm(np.gradient(truth, axis=0), axis=1)
    assert np.median(np.abs(track.speed_mps - speed)) < 0.5
