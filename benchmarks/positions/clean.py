"""Open sky without faults: errors of single epochs of whole files, from RINEX to the position.

Unlike the beds with faults, where all contenders get the same corrected ranges, everybody computes satellites
and corrections by himself here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.positions import rtklib
from benchmarks.positions.sky import Station
from estimators.adapters.rinex import read_rinex
from estimators.arrays import FloatArray
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.geodesy.local_frame import enu_axes
from estimators.gnss.calendar import WEEK_NS, gps_nanoseconds
from estimators.gnss.observed_epochs import ObservedEpochs
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.one_epoch import SOLVED
from estimators.gnss.snapshot.solved import Solved, solve_epochs

AUTO, PLAIN = "auto", "ols"
RTKLIB_AS_IS, RTKLIB_ONE_MESSAGE = "RTKLIB", "RTKLIB, I/NAV alone"


@dataclass(frozen=True, slots=True)
class CleanCell:
    """Errors of a contender on a station's epochs, in metres.

    Attributes
    ----------
    station, contender : str
    epochs : int
        Those that all contenders answer.
    horizontal_m, vertical_m, whole_m : tuple of float
        50 and 95 % of the horizontal, the vertical and the spatial error.
    """

    station: str
    contender: str
    epochs: int
    horizontal_m: tuple[float, float]
    vertical_m: tuple[float, float]
    whole_m: tuple[float, float]


def measure_clean(stations: Sequence[Station], data: Path, say: Callable[[str], None]) -> list[CleanCell]:
    """Let everybody that is present answer all epochs of the stations.

    Parameters
    ----------
    stations : sequence of Station
    data : pathlib.Path
        Folder of the stations.
    say : callable
        Told what is under way.
    """
    cells = []
    for station in stations:
        say(f"clean: {station.title}")
        answers = _ours(station, data)
        if rtklib.is_present():
            answers[RTKLIB_AS_IS] = rtklib.clean_positions(station, data, one_message=False)
            if "E" in station.systems:
                answers[RTKLIB_ONE_MESSAGE] = rtklib.clean_positions(station, data, one_message=True)
        times = sorted(set.intersection(*(set(found) for found in answers.values())))
        truth = np.array(station.truth_m)
        cells += [
            _cell(station.title, name, np.array([found[at] for at in times]), truth)
            for name, found in answers.items()
        ]
    return cells


def _ours(station: Station, data: Path) -> dict[str, dict[int, FloatArray]]:
    folder = data / station.folder
    observed = read_rinex(
        folder / station.observations, folder / station.navigation, systems=list(station.systems)
    )
    everybody = np.zeros(observed.table.pseudoranges_m.size, dtype=np.bool_)
    options = PositionOptions()
    return {
        AUTO: _by_time(observed, solve_epochs(observed.table, options)),
        PLAIN: _by_time(observed, solve_epochs(observed.table, options, everybody)),
    }


def _by_time(observed: ObservedEpochs, solved: Solved) -> dict[int, FloatArray]:
    seconds = np.round(gps_nanoseconds(observed.time_gps) % WEEK_NS * 1e-9).astype(np.int64).tolist()
    return {at: solved.state[k, :3] for k, at in enumerate(seconds) if solved.status[k] == SOLVED}


def _cell(title: str, contender: str, positions: FloatArray, truth: FloatArray) -> CleanCell:
    lat, lon, _ = to_geodetic(truth).tolist()
    error = (positions - truth) @ enu_axes(lat, lon).T

    def quantiles(lengths: FloatArray) -> tuple[float, float]:
        return float(np.quantile(lengths, 0.5)), float(np.quantile(lengths, 0.95))

    return CleanCell(
        title,
        contender,
        len(positions),
        quantiles(np.linalg.norm(error[:, :2], axis=1)),
        quantiles(np.abs(error[:, 2])),
        quantiles(np.linalg.norm(error, axis=1)),
    )
