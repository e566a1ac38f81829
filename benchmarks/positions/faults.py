"""Faults on healthy epochs: how many satellites, by how much, at random or in collusion."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from benchmarks.positions.sky import Sky
from estimators.arrays import BoolArray, FloatArray
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.geodesy.local_frame import enu_axes

SIZES = ("50", "100", "1000", "20-2000", "colluding")
"""Metres, of random sign; log-uniform between bounds; a common false position 100 to 1000 m away."""


@dataclass(frozen=True, slots=True)
class Faulty:
    """An epoch with faults and which satellites have them."""

    sky: Sky
    bias_m: FloatArray

    @property
    def faulty(self) -> BoolArray:
        """The satellites that lie."""
        return np.asarray(self.bias_m != 0.0)


def inject(sky: Sky, k: int, size: str, rng: np.random.Generator) -> Faulty:
    """Bias k random satellites of an epoch.

    Parameters
    ----------
    sky : Sky
    k : int
    size : str
        One of ``SIZES``.
    rng : numpy.random.Generator

    Examples
    --------
    >>> from benchmarks.positions.sky import simulate_sky
    >>> rng = np.random.default_rng(3)
    >>> np.unique(np.abs(inject(simulate_sky(rng, 45.0, 0.3), 2, "100", rng).bias_m)).tolist()
    [0.0, 100.0]
    """
    bias = np.zeros(len(sky.name))
    hit = rng.choice(bias.size, size=min(k, bias.size), replace=False)
    if size == "colluding":
        lat, lon, _ = to_geodetic(sky.truth_m).tolist()
        bearing = rng.uniform(0.0, 2.0 * np.pi)
        off = 100.0 * 10.0 ** rng.uniform() * np.array([np.sin(bearing), np.cos(bearing), 0.0])
        false = sky.truth_m + off @ enu_axes(lat, lon)
        lie = np.linalg.norm(sky.satellites_m - false, axis=1) - np.linalg.norm(
            sky.satellites_m - sky.truth_m, axis=1
        )
        bias[hit] = lie[hit]
    else:
        low, _, high = size.partition("-")
        length = float(low) * (float(high or low) / float(low)) ** rng.uniform(size=hit.size)
        bias[hit] = length * rng.choice([-1.0, 1.0], size=hit.size)
    return Faulty(dataclasses.replace(sky, ranges_m=sky.ranges_m + bias, raw_m=sky.raw_m + bias), bias)
