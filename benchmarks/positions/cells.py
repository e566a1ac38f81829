"""Every contender on the same epochs: cells of a bed, by number and size of the faults."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.positions.answers import Answer, Score, judge
from benchmarks.positions.faults import SIZES, Faulty, inject
from benchmarks.positions.ours import answer_by_auto, answer_by_method
from benchmarks.positions.peers import answer_by_peer, peer_version
from benchmarks.positions.rtklib import answer_by_rtklib, is_present
from benchmarks.positions.sky import STATIONS, Sky, Station, read_station, simulate_sky
from estimators.gnss.methods.registry import POSITION_METHODS

NOISES = (0.3, 0.6, 1.0)
LATITUDES = (0.0, 20.0, 40.0, 60.0, 80.0)
OURS = tuple(POSITION_METHODS)
RTKLIB, SIDEREON, GNSS_LIB_PY = "RTKLIB, RAIM FDE", "sidereon FDE", "gnss_lib_py residual FDE"

Solve = Callable[[Sequence[Faulty]], tuple[list[Answer], float]]


@dataclass(frozen=True, slots=True)
class Bed:
    """Epochs and who is asked about them."""

    title: str
    skies: Sequence[Sky]
    counts: tuple[int, ...]
    contenders: Mapping[str, Solve]


@dataclass(frozen=True, slots=True)
class Cell:
    """A contender's score on a bed with so many faults of a size, and its processor time."""

    bed: str
    contender: str
    faults: int
    size: str
    score: Score
    ms: float


def our_contenders(methods: Sequence[str]) -> dict[str, Solve]:
    """Plumbline's methods by name."""

    def one_by_one(method: str) -> Solve:
        return lambda faulty: answer_by_method(method, faulty)

    return {name: answer_by_auto if name == "auto" else one_by_one(name) for name in methods}


def station_bed(station: Station, data: Path, epochs: int, methods: Sequence[str]) -> Bed:
    """Thin a station's epochs evenly and gather the peers that are present.

    Parameters
    ----------
    station : Station
    data : pathlib.Path
    epochs : int
        At most so many.
    methods : sequence of str
        Ours.
    """
    everything = read_station(station, data)
    skies = everything[:: max(1, -(-len(everything) // epochs))]
    contenders = our_contenders(methods)
    if is_present():
        contenders[RTKLIB] = lambda faulty: answer_by_rtklib(station, data, faulty)
    # gnss_lib_py has one receiver clock, whatever the systems.
    single = len(station.systems) == 1
    for title, package in ((SIDEREON, "sidereon"), (GNSS_LIB_PY, "gnss_lib_py"))[: 1 + single]:
        if peer_version(package) is not None:
            contenders[title] = _peer(package, station, data, skies)
    return Bed(station.title, skies, (0, 1, 2, 3, 4) if single else (0, 1, 2, 4, 6, 8), contenders)


def _peer(package: str, station: Station, data: Path, skies: Sequence[Sky]) -> Solve:
    return lambda faulty: answer_by_peer(package, station, data, skies, faulty)


def simulated_bed(noise: float, epochs: int, seed: int, methods: Sequence[str]) -> Bed:
    """Simulate skies at five latitudes, the true noise ``noise`` times the stated one."""
    rng = np.random.default_rng((seed, round(10 * noise)))
    skies = [simulate_sky(rng, LATITUDES[k % len(LATITUDES)], noise) for k in range(epochs)]
    return Bed(f"simulated GPS, noise x {noise:g}", skies, (0, 1, 2, 3, 4), our_contenders(methods))


def all_beds(data: Path, epochs: int, seed: int) -> list[Bed]:
    """Gather the stations, and simulated skies at three levels of noise.

    Several systems take the peers a fifth of a second per epoch: they get a third of the epochs.
    """
    beds = [
        station_bed(station, data, epochs if len(station.systems) == 1 else -(-epochs // 3), OURS)
        for station in STATIONS
    ]
    return beds + [simulated_bed(noise, epochs, seed, OURS) for noise in NOISES]


def measure_bed(bed: Bed, seed: int, say: Callable[[str], None]) -> list[Cell]:
    """Ask every contender about every cell."""
    cells = []
    for k in bed.counts:
        for size in SIZES if k > 0 else SIZES[:1]:
            rng = np.random.default_rng((seed, k, SIZES.index(size)))
            faulty = [inject(sky, k, size, rng) for sky in bed.skies]
            for name, solve in bed.contenders.items():
                say(f"{bed.title}: {k} faults of {size}, {name}")
                answers, ms = solve(faulty)
                cells.append(Cell(bed.title, name, k, size, judge(faulty, answers), ms))
    return cells


def measure_protection(epochs: int, seed: int, say: Callable[[str], None]) -> list[Cell]:
    """Protection levels of ``auto`` on simulated skies: clean, and with one or two faults of any size."""
    cells = []
    for noise in NOISES:
        bed = simulated_bed(noise, epochs, seed + 1, ("auto",))
        for k, size in ((0, SIZES[0]), (1, "20-2000"), (2, "20-2000")):
            say(f"protection levels: {bed.title}, {k} faults")
            rng = np.random.default_rng((seed + 1, k))
            faulty = [inject(sky, k, size, rng) for sky in bed.skies]
            answers, ms = answer_by_auto(faulty)
            cells.append(Cell(bed.title, "auto", k, size, judge(faulty, answers), ms))
    return cells


def warm_up(beds: Sequence[Bed]) -> None:
    """Ask our methods once, so that no figure holds a compilation."""
    rng = np.random.default_rng(0)
    for bed in beds:
        faulty = [inject(bed.skies[0], 2, SIZES[1], rng)]
        for name, solve in bed.contenders.items():
            if name in OURS:
                solve(faulty)
