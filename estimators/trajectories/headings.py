"""Speed and heading of a smoothed track, in the local frame of each place.

The axes of the plane turn away from north, and its scale from 1, far from its centre.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray
from estimators.geodesy.ellipsoid import to_cartesian
from estimators.geodesy.plane import Plane
from estimators.trajectories.smoothing.solved import Solved

_AHEAD_M = 10.0
UNKNOWN_DEG = 360.0 / np.sqrt(12.0)
"""Standard deviation of a direction of which nothing is known."""


def directions(
    plane: Plane, latitude_deg: FloatArray, longitude_deg: FloatArray, solved: Solved
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Speed, heading and their standard deviations, each of shape (m,).

    Headings are those to a place some metres ahead, so that the projection's turn and scale are undone.
    """
    velocity = solved.states[:, :, 1]
    speed = np.hypot(velocity[:, 0], velocity[:, 1])
    toward = np.divide(velocity, speed[:, None], out=np.zeros_like(velocity), where=speed[:, None] > 0.0)
    ahead = plane.locate(solved.states[:, :, 0] + _AHEAD_M * toward)
    here = to_cartesian(np.column_stack([latitude_deg, longitude_deg, np.zeros(speed.size)]))
    there = to_cartesian(np.column_stack([*ahead, np.zeros(speed.size)]))
    step = there - here
    lat, lon = np.radians(latitude_deg), np.radians(longitude_deg)
    east = -np.sin(lon) * step[:, 0] + np.cos(lon) * step[:, 1]
    level = np.cos(lon) * step[:, 0] + np.sin(lon) * step[:, 1]
    north = np.cos(lat) * step[:, 2] - np.sin(lat) * level
    scale = np.where(speed > 0.0, np.hypot(east, north) / _AHEAD_M, 1.0)
    heading = np.where(speed > 0.0, np.degrees(np.arctan2(east, north)) % 360.0, 0.0)
    sigma = np.sqrt(np.maximum(solved.covariances[:, 1, 1], 0.0))
    turn = np.divide(sigma, speed, out=np.full_like(sigma, np.inf), where=speed > 0.0)
    return speed * scale, heading, sigma * scale, np.minimum(np.degrees(turn), UNKNOWN_DEG)
