"""Tracks with truth, made on a plane and laid on the Earth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators import NoFit, Track, clean_trajectory
from estimators.arrays import BoolArray, FloatArray
from estimators.geodesy.plane import Plane

MUNICH = Plane(48.1, 11.5)


@dataclass(frozen=True)
class Drive:
    """Fixes in a plane, where they really were, and which of them are faulty."""

    t: FloatArray
    fixes: FloatArray
    truth: FloatArray
    faulty: BoolArray

    def clean(self, plane: Plane = MUNICH, **settings: object) -> Track:
        found = clean_trajectory(self.t, *plane.locate(self.fixes), **settings)  # type: ignore[arg-type]
        assert not isinstance(found, NoFit)
        return found

    def places(self, track: Track, plane: Plane = MUNICH) -> FloatArray:
        return plane.project(track.lat_deg, track.lon_deg)

    def error(self, track: Track) -> float:
        return float(np.sqrt(np.mean(np.sum((self.places(track) - self.truth) ** 2, axis=1))))


def drive(seed: int = 0, n: int = 400, sigma: float = 4.0) -> Drive:
    """Town: straights, bends and changes of speed, a fix a second."""
    rng = np.random.default_rng(seed)
    t = np.arange(float(n))
    speed = 10.0 + 4.0 * np.sin(t / 25.0)
    heading = 0.6 * np.sin(t / 40.0) + t / 120.0
    steps = speed[:, None] * np.column_stack([np.sin(heading), np.cos(heading)])
    truth = np.cumsum(steps, axis=0) - steps[0]
    fixes = truth + sigma * rng.normal(size=truth.shape)
    return Drive(t, fixes, truth, np.zeros(n, dtype=np.bool_))


def with_spikes(made: Drive, seed: int = 1, share: float = 0.1) -> Drive:
    rng = np.random.default_rng(seed)
    faulty = rng.random(made.t.size) < share
    far = 10.0 ** rng.uniform(2.0, 3.5, made.t.size)
    angle = rng.uniform(0.0, 2.0 * np.pi, made.t.size)
    offset = far[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    return Drive(made.t, made.fixes + faulty[:, None] * offset, made.truth, faulty)


def with_bursts(made: Drive, offset: float = 80.0, length: int = 25) -> Drive:
    faulty = made.faulty.copy()
    shift = np.zeros_like(made.fixes)
    for k, first in enumerate(range(60, made.t.size - length, 110)):
        faulty[first : first + length] = True
        angle = 2.0 * k
        shift[first : first + length] = offset * np.array([np.cos(angle), np.sin(angle)])
    return Drive(made.t, made.fixes + shift, made.truth, faulty)


def f1(track: Track, faulty: BoolArray) -> float:
    flagged = ~track.points.inlier
    hits = np.count_nonzero(flagged & faulty)
    return float(2.0 * hits / (np.count_nonzero(flagged) + np.count_nonzero(faulty)))
