"""Simulated receivers with a known truth: satellites on circular orbits, a car on a curved road, a mast."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from estimators.arrays import BoolArray, FloatArray
from estimators.geodesy.ellipsoid import to_cartesian
from estimators.geodesy.local_frame import azimuth_elevation, enu_axes
from estimators.gnss.series.epochs import Epoch

PLACE = (52.5, 13.4, 80.0)
SIGMA_M = 2.0
_RADIUS_M, _RATE, _TILT = 26.56e6, 2.0 * math.pi / 43082.0, math.radians(55.0)
_EARTH_RATE = 7.2921151467e-5
_PER_SYSTEM = {"G": (6, 5, 0.0), "E": (3, 8, 0.4)}


@dataclass(frozen=True)
class Drive:
    """Epochs with a truth.

    Attributes
    ----------
    epochs : list of Epoch
    truth_m : ndarray, shape (epochs, 3)
    axes : ndarray, shape (3, 3)
        East, north, up at the start.
    faulty : list of ndarray of bool
        Per epoch, the rows that lie.
    """

    epochs: list[Epoch]
    truth_m: FloatArray
    axes: FloatArray
    faulty: list[BoolArray]

    def error_enu_m(self, position_m: FloatArray) -> FloatArray:
        """East, north and up from the truth, per epoch."""
        return np.asarray((position_m - self.truth_m) @ self.axes.T)

    def with_epochs(self, epochs: list[Epoch]) -> Drive:
        """See the same drive through other epochs."""
        return replace(self, epochs=epochs)


def satellites_at(time_s: float, system: str) -> tuple[list[str], FloatArray]:
    """Names and positions of a system's satellites, Earth-centred and Earth-fixed."""
    planes, per_plane, turn = _PER_SYSTEM[system]
    names, places = [], []
    for plane in range(planes):
        for slot in range(per_plane):
            node = 2.0 * math.pi * plane / planes + turn - _EARTH_RATE * time_s
            along = 2.0 * math.pi * (slot / per_plane + plane / (planes * per_plane)) + _RATE * time_s + turn
            u, v = math.cos(along), math.sin(along)
            places.append(
                [
                    _RADIUS_M * (u * math.cos(node) - v * math.cos(_TILT) * math.sin(node)),
                    _RADIUS_M * (u * math.sin(node) + v * math.cos(_TILT) * math.cos(node)),
                    _RADIUS_M * v * math.sin(_TILT),
                ]
            )
            names.append(f"{system}{plane * per_plane + slot + 1:02d}")
    return names, np.array(places)


def car(time_s: float) -> FloatArray:
    """Drive at 14 m/s and turn: east, north and up."""
    return np.array([14.0 * time_s, 150.0 * math.sin(time_s / 15.0), 2.0 * math.sin(time_s / 40.0)])


def mast(_: float) -> FloatArray:
    """Stand still."""
    return np.zeros(3)


def drive(
    count: int,
    *,
    step_s: float = 1.0,
    path: Callable[[float], FloatArray] = car,
    systems: str = "G",
    seed: int = 0,
    faults: int = 0,
    size_m: float = 100.0,
    persistent: bool = False,
    noise: float = 0.5,
    start_s: float = 0.0,
    doppler: bool = False,
    clock: Callable[[float], float] = lambda t: 40.0 * t,
) -> Drive:
    """Simulate a receiver.

    Parameters
    ----------
    count : int
        Epochs.
    step_s : float
    path : callable
        East, north, up at seconds since the start.
    systems : str
    seed : int
    faults : int
        Satellites that lie in each epoch, anew in each or always the same.
    size_m : float
    persistent : bool
    noise : float
        In units of the sigmas that are stated.
    start_s : float
    doppler : bool
    clock : callable
        Receiver clock error in metres.
    """
    rng = np.random.default_rng(seed)
    origin, axes = to_cartesian(np.array(PLACE)), enu_axes(PLACE[0], PLACE[1])
    offsets = {"G": 0.0, "E": 35.0}
    epochs, truth, faulty = [], [], []
    always: dict[str, float] = {}
    for k in range(count):
        t = k * step_s
        here, moved = origin + path(t) @ axes, (path(t + 0.5) - path(t - 0.5)) @ axes
        names, places, speeds = [], [], []
        for system in systems:
            listed, now = satellites_at(start_s + t, system)
            _, later = satellites_at(start_s + t + 0.5, system)
            _, earlier = satellites_at(start_s + t - 0.5, system)
            seen = azimuth_elevation((now - here) @ axes.T)[1] > 10.0
            names += [name for name, up in zip(listed, seen, strict=True) if up]
            places.append(now[seen])
            speeds.append((later - earlier)[seen])
        satellites, velocities = np.concatenate(places), np.concatenate(speeds)
        ranges = np.linalg.norm(satellites - here, axis=1) + clock(t)
        ranges += np.array([offsets[name[0]] for name in names])
        ranges += rng.normal(0.0, noise * SIGMA_M, ranges.size)
        lying = np.zeros(ranges.size, dtype=np.bool_)
        if faults and (not persistent or not always):
            chosen = rng.choice(len(names), min(faults, len(names)), replace=False)
            always = {names[j]: float(size_m * rng.choice([-1.0, 1.0])) for j in chosen}
        for j, name in enumerate(names):
            if name in always:
                ranges[j] += always[name]
                lying[j] = True
        towards = (satellites - here) / np.linalg.norm(satellites - here, axis=1)[:, None]
        rates = np.einsum("ij,ij->i", towards, velocities - moved) + (clock(t + 0.5) - clock(t - 0.5))
        epochs.append(
            Epoch(
                time=t,
                satellites_m=satellites,
                pseudoranges_m=ranges,
                sigma_m=np.full(ranges.size, SIGMA_M),
                system=[name[0] for name in names],
                satellite=names,
                range_rate_mps=rates + rng.normal(0.0, 0.1, rates.size) if doppler else None,
                satellite_velocity_mps=velocities if doppler else None,
            )
        )
        truth.append(here)
        faulty.append(lying)
    return Drive(epochs, np.array(truth), axes, faulty)
