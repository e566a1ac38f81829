"""Tables of corrected pseudoranges that RTKLIB made of recorded files, read in place."""

from __future__ import annotations

import csv
import gzip
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from estimators.gnss.calendar import GPS_EPOCH

STATIONS = {
    "esbc": ("esbc_2020_177/corrected_pseudoranges_240ep.csv.gz", (3582104.9028, 532590.1902, 5232755.3379)),
    "kamakura": (
        "kamakura_2021_078/corrected_pseudoranges_150ep.csv.gz",
        (-3962108.6617, 3381309.5232, 3668678.6410),
    ),
}


@dataclass(frozen=True)
class Recorded:
    """Columns of a table, its epochs, and where the antenna stood."""

    columns: dict[str, np.ndarray]
    satellite: list[str]
    offsets: np.ndarray
    time_gps: np.ndarray
    truth: np.ndarray

    @property
    def positions(self) -> np.ndarray:
        return np.column_stack([self.columns[name] for name in ("x_m", "y_m", "z_m")])


def read_recorded(folder: Path, station: str) -> Recorded:
    name, truth = STATIONS[station]
    with gzip.open(folder / name) as packed:
        rows = list(csv.DictReader(io.TextIOWrapper(packed)))
    satellite = [row["sat"] for row in rows]
    columns = {key: np.array([float(row[key]) for row in rows]) for key in rows[0] if key != "sat"}
    epoch = columns["epoch"].astype(np.int64)
    offsets = np.searchsorted(epoch, np.arange(epoch[-1] + 2)).astype(np.int64)
    seconds = columns["week"][offsets[:-1]] * 604800.0 + columns["tow"][offsets[:-1]]
    time = GPS_EPOCH + (seconds * 1e3).astype("timedelta64[ms]")
    return Recorded(columns, satellite, offsets, time, np.array(truth))
