"""Recorded drives with a truth of their own, read in place.

Nobody knows which of their fixes lie: they are held against the raw track.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from benchmarks.tracks.recording import UNSCORED, Recording

DRIVES = ("smartloc_potsdamer_wls", "urbannav_tokyo_odaiba_wls_1hz", "urbannav_tokyo_odaiba_wls_10hz")
_COLUMNS = ("t", "lat", "lon", "lat_true", "lon_true")


def data_folder() -> Path:
    """Folder of the recorded drives; ``PLUMBLINE_TEST_DATA`` names the folder that holds ``trajectories``."""
    beside = Path(__file__).resolve().parents[3] / "shared" / "data"
    return Path(os.environ.get("PLUMBLINE_TEST_DATA", beside)) / "trajectories" / "real"


def read_drive(path: Path) -> Recording:
    """Read a drive.

    Parameters
    ----------
    path : pathlib.Path
        CSV with the columns ``t, lat, lon, lat_true, lon_true``, degrees; an empty truth is unknown.
    """
    table = np.genfromtxt(path, delimiter=",", names=True)
    n = table.size
    t_s, lat, lon, true_lat, true_lon = (np.ascontiguousarray(table[name]) for name in _COLUMNS)
    unlabelled = np.full(n, UNSCORED, dtype=np.int8)
    nowhere = np.zeros(n, dtype=np.bool_)
    return Recording(
        path.stem, t_s, lat, lon, None, true_lat, true_lon, unlabelled, nowhere, np.full(n, np.nan)
    )


def present_drives(folder: Path) -> list[Recording]:
    """Drives that are there."""
    return [read_drive(path) for name in DRIVES if (path := folder / f"{name}.csv").is_file()]
