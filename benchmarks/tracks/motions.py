"""How something really moves: paths in the plane on a fine grid of time, metres east and north.

A motion is a function of a duration and a generator. Speeds and turns are drawn, then integrated.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from scipy.signal import lfilter

from estimators.arrays import FloatArray

GRID_S = 0.1

Motion: TypeAlias = Callable[[float, np.random.Generator], FloatArray]


def _steps(duration_s: float) -> int:
    return round(duration_s / GRID_S) + 1


def _wander(n: int, spread: float, time_s: float, rng: np.random.Generator) -> FloatArray:
    """Draw an Ornstein-Uhlenbeck process on the grid."""
    keep = float(np.exp(-GRID_S / time_s))
    drive = rng.normal(size=n) * spread * np.sqrt(1.0 - keep**2)
    drive[0] = rng.normal() * spread
    return np.asarray(lfilter([1.0], [1.0, -keep], drive), dtype=np.float64)


def _held(n: int, shortest_s: float, longest_s: float, rng: np.random.Generator) -> FloatArray:
    """Give every step of the grid the number of its stretch; stretches are of random length."""
    most = int(n * GRID_S / shortest_s) + 2
    ends = np.cumsum(rng.uniform(shortest_s, longest_s, most))
    return np.searchsorted(ends, np.arange(n) * GRID_S).astype(np.float64)


def _smooth(values: FloatArray, seconds: float) -> FloatArray:
    """Take the moving mean: no change of speed or heading is instant."""
    width = max(1, round(seconds / GRID_S)) | 1
    padded = np.pad(values, width // 2, mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")


def _drive(speed: FloatArray, heading: FloatArray) -> FloatArray:
    """Integrate speed along a heading (radians, clockwise from north)."""
    velocity = speed[:, None] * np.stack([np.sin(heading), np.cos(heading)], axis=1)
    moved = np.cumsum(0.5 * GRID_S * (velocity[1:] + velocity[:-1]), axis=0)
    return np.vstack([np.zeros((1, 2)), moved])


def _corners(n: int, shortest_s: float, longest_s: float, rng: np.random.Generator) -> FloatArray:
    """Draw headings with right-angled turns: the streets of a town."""
    stretch = _held(n, shortest_s, longest_s, rng).astype(np.int64)
    turns = rng.choice([-0.5, 0.0, 0.5], size=int(stretch[-1]) + 1, p=[0.4, 0.2, 0.4])
    turns[0] = rng.uniform(-1.0, 1.0)
    return np.asarray(np.pi * np.cumsum(turns)[stretch])


def stationary(duration_s: float, rng: np.random.Generator) -> FloatArray:
    """Stand still."""
    del rng
    return np.zeros((_steps(duration_s), 2))


def constant_velocity(duration_s: float, rng: np.random.Generator) -> FloatArray:
    """Go straight at 15 m/s."""
    n = _steps(duration_s)
    return _drive(np.full(n, 15.0), np.full(n, rng.uniform(-np.pi, np.pi)))


def walk(duration_s: float, rng: np.random.Generator) -> FloatArray:
    """Walk at about 1.4 m/s around corners, never quite straight."""
    n = _steps(duration_s)
    heading = _smooth(_corners(n, 30.0, 120.0, rng), 3.0) + _wander(n, 0.15, 20.0, rng)
    return _drive(np.maximum(1.4 + _wander(n, 0.2, 10.0, rng), 0.0), heading)


def city(duration_s: float, rng: np.random.Generator) -> FloatArray:
    """Drive at 8 to 15 m/s with stops of 10 to 40 s; turns take five seconds."""
    n = _steps(duration_s)
    stretch = _held(n, 10.0, 40.0, rng).astype(np.int64)
    targets = rng.uniform(8.0, 15.0, size=int(stretch[-1]) + 1)
    # Every third stretch on average is a wait, but never the first: a track that starts moving.
    targets[1:][rng.random(targets.size - 1) < 1 / 3] = 0.0
    speed = _smooth(targets[stretch], 7.0)
    return _drive(speed, _smooth(_corners(n, 25.0, 80.0, rng), 5.0))


def train(duration_s: float, rng: np.random.Generator) -> FloatArray:
    """Run at 300 km/h, braking once, on curves of some kilometres' radius."""
    n = _steps(duration_s)
    target = np.full(n, 300.0 / 3.6)
    begin = int(rng.uniform(0.3, 0.6) * n)
    target[begin : begin + n // 5] = 160.0 / 3.6
    heading = rng.uniform(-np.pi, np.pi) + np.cumsum(_wander(n, 0.006, 40.0, rng)) * GRID_S
    return _drive(_smooth(target, 90.0), heading)


def circle(duration_s: float, rng: np.random.Generator) -> FloatArray:
    """Go round and round at 10 m/s on a radius of 60 m: the velocity is never the same."""
    n = _steps(duration_s)
    turned = 10.0 / 60.0 * GRID_S * np.arange(n, dtype=np.float64)
    return _drive(np.full(n, 10.0), np.asarray(rng.uniform(-np.pi, np.pi) + turned))


def stop_and_go(duration_s: float, rng: np.random.Generator) -> FloatArray:
    """Crawl in a jam: up to 8 m/s and back to zero every half minute."""
    n = _steps(duration_s)
    stretch = _held(n, 8.0, 25.0, rng).astype(np.int64)
    targets = np.where(np.arange(stretch[-1] + 1) % 2 == 0, rng.uniform(3.0, 8.0, int(stretch[-1]) + 1), 0.0)
    heading = rng.uniform(-np.pi, np.pi) + _wander(n, 0.3, 120.0, rng)
    return _drive(_smooth(targets[stretch], 4.0), _smooth(heading, 10.0))


def walk_then_drive(duration_s: float, rng: np.random.Generator) -> FloatArray:
    """Walk to a car, and drive off: no one process noise suits both."""
    first = walk(0.5 * duration_s, rng)
    second = city(duration_s - 0.5 * duration_s, rng)
    whole = np.vstack([first, first[-1] + second[1:]])
    return whole[: _steps(duration_s)]


def at_times(path: FloatArray, t_s: FloatArray) -> FloatArray:
    """Places on a path at seconds since its beginning, shape (n, 2)."""
    grid = np.arange(path.shape[0]) * GRID_S
    return np.stack([np.interp(t_s, grid, path[:, axis]) for axis in range(2)], axis=1)
