"""Epochs with a known truth: two stations' measured ranges, and simulated skies at other latitudes."""

from __future__ import annotations

import csv
import gzip
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from estimators.arrays import FloatArray
from estimators.geodesy.ellipsoid import to_cartesian
from estimators.geodesy.local_frame import azimuth_elevation, enu_axes
from estimators.gnss.systems import read_systems
from estimators.gnss.table import EpochTable
from estimators.gnss.weighting import elevation_sigma

_ORBIT_M = 26_559.8e3
_INCLINATION_DEG = 55.0
_PLANES, _PER_PLANE = 6, 5
_MASK_DEG = 10.0


@dataclass(frozen=True, slots=True)
class Sky:
    """One epoch.

    Attributes
    ----------
    time_s : float
        GPS time of week.
    name, system : tuple of str
    satellites_m : ndarray, shape (n, 3)
        In the frame of the time of reception.
    ranges_m, sigma_m : ndarray, shape (n,)
        Corrected pseudoranges, and their noise.
    raw_m : ndarray, shape (n,)
        As the receiver measured them.
    truth_m : ndarray, shape (3,)
    """

    time_s: float
    name: tuple[str, ...]
    system: tuple[str, ...]
    satellites_m: FloatArray
    ranges_m: FloatArray
    sigma_m: FloatArray
    raw_m: FloatArray
    truth_m: FloatArray


@dataclass(frozen=True, slots=True)
class Station:
    """Files of a station: corrected pseudoranges (the data's README says how), RINEX, and the truth."""

    title: str
    folder: str
    table: str
    observations: str
    navigation: str
    truth_m: tuple[float, float, float]
    systems: str


_ESBC = (
    "esbc_2020_177",
    "corrected_pseudoranges_240ep.csv.gz",
    "ESBC00DNK_20201770000_120S.rnx.gz",
    "ESBC00DNK_R_20201770000_01D_MN.rnx.gz",
    (3582104.9028, 532590.1902, 5232755.3379),
)
_KAMAKURA = (
    "kamakura_2021_078",
    "corrected_pseudoranges_150ep.csv.gz",
    "SEPT078M.21O.gz",
    "SEPT078M.21P",
    (-3962108.6617, 3381309.5232, 3668678.6410),
)
STATIONS = (
    Station("ESBC, GPS", *_ESBC, systems="G"),
    Station("ESBC, four systems", *_ESBC, systems="GREC"),
    Station("Kamakura, GPS + Galileo + QZSS", *_KAMAKURA, systems="GEJ"),
)
OPEN_SKIES = (
    STATIONS[0],
    Station("ESBC, GPS + Galileo", *_ESBC, systems="GE"),
    STATIONS[1],
    Station("Kamakura, GPS", *_KAMAKURA, systems="G"),
    Station("Kamakura, GPS + Galileo", *_KAMAKURA, systems="GE"),
    STATIONS[2],
)
"""Without faults, more combinations of systems."""


def data_folder() -> Path:
    """Folder of the published data; ``PLUMBLINE_TEST_DATA`` names the folder that holds ``gnss``."""
    beside = Path(__file__).resolve().parents[3] / "shared" / "data"
    return Path(os.environ.get("PLUMBLINE_TEST_DATA", beside)) / "gnss"


def read_station(station: Station, folder: Path) -> list[Sky]:
    """Read a station's epochs, the satellites of its systems.

    A satellite alone in its system checks nothing and gives nothing; it is left out.
    """
    by_time: dict[float, list[dict[str, str]]] = {}
    with gzip.open(folder / station.folder / station.table, "rt", encoding="ascii") as lines:
        for row in csv.DictReader(lines):
            if row["sat"][0] in station.systems:
                by_time.setdefault(float(row["tow"]), []).append(row)
    skies = []
    for time_s, rows in sorted(by_time.items()):
        letters = [row["sat"][0] for row in rows]
        kept = [row for row, letter in zip(rows, letters, strict=True) if letters.count(letter) > 1]
        skies.append(
            Sky(
                time_s,
                tuple(row["sat"] for row in kept),
                tuple(row["sat"][0] for row in kept),
                np.array([[float(row[axis]) for axis in ("x_m", "y_m", "z_m")] for row in kept]),
                np.array([float(row["corr_pr_m"]) for row in kept]),
                np.array([float(row["sigma_m"]) for row in kept]),
                np.array([float(row["raw_pr_m"]) for row in kept]),
                np.array(station.truth_m),
            )
        )
    return skies


def simulate_sky(rng: np.random.Generator, latitude_deg: float, noise: float) -> Sky:
    """Draw a sky of satellites on orbits like those of GPS, at a random time and longitude.

    Parameters
    ----------
    rng : numpy.random.Generator
    latitude_deg : float
    noise : float
        True standard deviation in units of the sigmas that are stated.

    Examples
    --------
    >>> sky = simulate_sky(np.random.default_rng(1), 45.0, 0.3)
    >>> 5 <= len(sky.name) <= 16
    True
    """
    longitude = rng.uniform(-180.0, 180.0)
    truth = to_cartesian(np.array([latitude_deg, longitude, rng.uniform(0.0, 500.0)]))
    axes = enu_axes(latitude_deg, longitude)
    node = np.repeat(np.arange(_PLANES) * 2 * np.pi / _PLANES, _PER_PLANE) + rng.uniform(0, 2 * np.pi)
    phase = rng.uniform(0, 2 * np.pi, size=node.size)
    tilt = np.radians(_INCLINATION_DEG)
    satellites = _ORBIT_M * np.stack(
        [
            np.cos(node) * np.cos(phase) - np.sin(node) * np.sin(phase) * np.cos(tilt),
            np.sin(node) * np.cos(phase) + np.cos(node) * np.sin(phase) * np.cos(tilt),
            np.sin(phase) * np.sin(tilt),
        ],
        axis=1,
    )
    elevation = azimuth_elevation((satellites - truth) @ axes.T)[1]
    seen = elevation > _MASK_DEG
    if int(seen.sum()) < 5:
        return simulate_sky(rng, latitude_deg, noise)
    system = ("G",) * int(seen.sum())
    sigma = elevation_sigma(elevation[seen], system)
    ranges = np.linalg.norm(satellites[seen] - truth, axis=1) + rng.uniform(-1e5, 1e5)
    measured = ranges + noise * sigma * rng.normal(size=sigma.size)
    return Sky(
        0.0,
        tuple(f"G{k + 1:02d}" for k in np.flatnonzero(seen)),
        system,
        satellites[seen],
        measured,
        sigma,
        measured,
        truth,
    )


def as_table(skies: Sequence[Sky]) -> EpochTable:
    """Epochs as the solver's table."""
    clocks = [read_systems(sky.system, len(sky.system)) for sky in skies]
    return EpochTable(
        satellites_m=np.concatenate([sky.satellites_m for sky in skies]),
        pseudoranges_m=np.concatenate([sky.ranges_m for sky in skies]),
        sigma_m=np.concatenate([sky.sigma_m for sky in skies]),
        clock=np.concatenate([clock for _, clock in clocks]),
        offsets=np.cumsum([0, *(len(sky.name) for sky in skies)]).astype(np.int64),
        letters=tuple(letters for letters, _ in clocks),
        names=tuple(name for sky in skies for name in sky.name),
        rotated=True,
    )
