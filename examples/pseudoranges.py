"""How ``examples/pseudoranges.csv`` was made: one moment of a receiver between tall buildings.

The receiver stands at 52.5 N, 13.4 E, 80 m, under the satellites of GPS and Galileo as circular orbits place
them. A building hides the western sky up to 50 degrees, and the signals from there arrive by way of a glass
front 40 m to the east: too long by the detour, and in agreement with one another about a place behind the
glass. Every range has a noise of one metre.
``python -m examples.pseudoranges`` writes the file again.
"""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np

from estimators.arrays import FloatArray
from estimators.geodesy.ellipsoid import to_cartesian
from estimators.geodesy.local_frame import azimuth_elevation, enu_axes

FILE = Path(__file__).with_suffix(".csv")
LATITUDE_DEG, LONGITUDE_DEG, HEIGHT_M = 52.5, 13.4, 80.0
MASK_DEG = 10.0
#: Letter, name, planes, satellites of a plane, radius, inclination, and node of the first plane.
CONSTELLATIONS = (
    ("G", "GPS", 6, 4, 26_560e3, 55.0, 20.0),
    ("E", "Galileo", 3, 8, 29_600e3, 56.0, 47.0),
)
CLOCKS_M = {"GPS": 4_200.0, "Galileo": 4_207.5}
HIDDEN_AZIMUTHS_DEG = (225.0, 315.0)
HIDDEN_ELEVATION_DEG = 50.0
WALL_M = 40.0
COLUMNS = ("satellite", "system", "x_m", "y_m", "z_m", "pseudorange_m")


def orbit_positions(
    planes: int, per_plane: int, radius_m: float, tilt_deg: float, node_deg: float
) -> FloatArray:
    """Satellites evenly spread over circular orbits, Earth-fixed, metres, shape (planes * per_plane, 3)."""
    plane, slot = np.divmod(np.arange(planes * per_plane), per_plane)
    node = np.radians(360.0 / planes * plane + node_deg)
    along = np.radians(360.0 / per_plane * slot + 15.0 * plane)
    tilt = np.radians(tilt_deg)
    x, y = np.cos(along), np.sin(along) * np.cos(tilt)
    turned = (x * np.cos(node) - y * np.sin(node), x * np.sin(node) + y * np.cos(node))
    return radius_m * np.column_stack([*turned, np.sin(along) * np.sin(tilt)])


def simulate() -> tuple[list[tuple[str, str, float, float, float, float]], list[str]]:
    """Rows as in the file, and the names of the satellites whose signal was reflected."""
    # The legacy generator: its streams are frozen, so the file stays the same under every numpy.
    random = np.random.RandomState(20261123)
    here = truth_m()
    axes = enu_axes(LATITUDE_DEG, LONGITUDE_DEG)
    rows, reflected = [], []
    for letter, system, planes, per_plane, radius, tilt, node in CONSTELLATIONS:
        satellites = orbit_positions(planes, per_plane, radius, tilt, node)
        azimuths, elevations = azimuth_elevation((satellites - here) @ axes.T)
        for row in np.flatnonzero(elevations > MASK_DEG):
            name, up = f"{letter}{row + 1:02d}", np.radians(elevations[row])
            noise_m = random.standard_normal()
            range_m = np.linalg.norm(satellites[row] - here) + CLOCKS_M[system] + noise_m
            first, last = HIDDEN_AZIMUTHS_DEG
            if first < azimuths[row] < last and elevations[row] < HIDDEN_ELEVATION_DEG:
                # The mirror image of the receiver is twice as far to the east as the wall.
                range_m -= 2.0 * WALL_M * np.cos(up) * np.sin(np.radians(azimuths[row]))
                reflected.append(name)
            rows.append((name, system, *satellites[row].tolist(), float(range_m)))
    return rows, reflected


def truth_m() -> FloatArray:
    """Where the receiver is, Earth-centred and Earth-fixed."""
    return to_cartesian(np.array([LATITUDE_DEG, LONGITUDE_DEG, HEIGHT_M]))


def to_csv(rows: list[tuple[str, str, float, float, float, float]]) -> str:
    """CSV text with the columns of :data:`COLUMNS`, in metres."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows((*row[:2], *(f"{value:.2f}" for value in row[2:])) for row in rows)
    return text.getvalue()


if __name__ == "__main__":
    FILE.write_text(to_csv(simulate()[0]))
