"""Skies made by us: stations, satellites on circular orbits, ranges with noise and faults."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.geodesy.ellipsoid import to_cartesian
from estimators.geodesy.local_frame import azimuth_elevation, enu_axes

ORBIT_M = 26_560e3
INCLINATION_DEG = 55.0


@dataclass(frozen=True, slots=True)
class Sky:
    """An epoch whose truth is known."""

    truth_m: FloatArray
    axes: FloatArray
    satellites_m: FloatArray
    ranges_m: FloatArray
    sigma_m: FloatArray
    names: tuple[str, ...]

    def with_faults(self, faults: dict[int, float]) -> Sky:
        """The same epoch, some ranges of which lie by so many metres."""
        ranges = self.ranges_m.copy()
        for row, bias in faults.items():
            ranges[row] += bias
        return Sky(self.truth_m, self.axes, self.satellites_m, ranges, self.sigma_m, self.names)

    def taken(self, rows: FloatArray | list[int]) -> Sky:
        """The same epoch with some satellites, in this order."""
        return Sky(
            self.truth_m,
            self.axes,
            np.ascontiguousarray(self.satellites_m[rows]),
            self.ranges_m[rows],
            self.sigma_m[rows],
            tuple(self.names[row] for row in rows),
        )


def make_sky(
    n: int = 9, seed: int = 0, *, noise: float = 0.4, clock_m: float = 3000.0, mask_deg: float = 10.0
) -> Sky:
    """Station and satellites in general position.

    Parameters
    ----------
    n : int
        Satellites above the mask.
    seed : int
    noise : float
        In units of the sigmas.
    clock_m : float
        Receiver clock.
    mask_deg : float
    """
    rng = np.random.default_rng([seed, n])
    lat, lon, height = rng.uniform(-65, 65), rng.uniform(-180, 180), rng.uniform(0, 800)
    truth, axes = to_cartesian(np.array([lat, lon, height])), enu_axes(lat, lon)
    kept: list[FloatArray] = []
    while len(kept) < n:
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        if abs(np.degrees(np.arcsin(direction[2]))) > INCLINATION_DEG:
            continue
        _, elevation = azimuth_elevation((axes @ (direction * ORBIT_M - truth))[None])
        if elevation[0] > mask_deg:
            kept.append(direction * ORBIT_M)
    satellites = np.array(kept)
    _, elevation = azimuth_elevation((satellites - truth) @ axes.T)
    sigma = np.sqrt(0.09 * (1 + 1 / np.sin(np.radians(elevation))) + 4.0)
    ranges = np.linalg.norm(satellites - truth, axis=1) + clock_m + noise * sigma * rng.normal(size=n)
    return Sky(truth, axes, satellites, ranges, sigma, tuple(f"G{row + 1:02d}" for row in range(n)))
