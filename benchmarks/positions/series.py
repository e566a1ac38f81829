"""``python -m benchmarks.positions.series``: epochs solved jointly, beside the same solved one by one."""

from __future__ import annotations

import argparse
import gzip
import math
import sys
import time
import tracemalloc
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.positions.drives import Drive, car, drive, mast
from benchmarks.positions.sky import STATIONS, data_folder, read_station
from estimators.arrays import BoolArray, FloatArray
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.geodesy.local_frame import enu_axes
from estimators.gnss.series.epochs import Epoch
from estimators.gnss.series.fixes import Fixes
from estimators.gnss.series.locate_series import locate_series
from estimators.gnss.series.stream import locate_stream

_SERIES = 20
_SIZES = (50.0, 100.0, 1000.0, None)
_INSIDE = 7.815
"""95 % of chi square with three degrees of freedom."""


def solved(epochs: Sequence[Epoch], **arguments: object) -> Fixes:
    """Solve a series that is known to be solvable."""
    fixes = locate_series(epochs, **arguments)  # type: ignore[arg-type]
    if not isinstance(fixes, Fixes):
        raise TypeError(fixes.message)
    return fixes


def station_epochs(which: int, data: Path) -> tuple[list[Epoch], FloatArray]:
    """Measured epochs of a station and its position."""
    skies = read_station(STATIONS[which], data)
    epochs = [
        Epoch(sky.time_s, sky.satellites_m, sky.ranges_m, sky.sigma_m, sky.system, sky.name) for sky in skies
    ]
    return epochs, skies[0].truth_m


def with_faults(
    epochs: Sequence[Epoch], k: int, size: float | None, persistent: bool, rng: np.random.Generator
) -> tuple[list[Epoch], list[BoolArray]]:
    """Bias k satellites, in every epoch others or always the same; without a size, 20 to 2000 m."""
    out, lying = [], []
    always: dict[str, float] = {}
    for epoch in epochs:
        names = tuple(epoch.satellite or ())
        if not (persistent and always):
            chosen = rng.choice(len(names), min(k, len(names)), replace=False)
            always = {
                names[j]: (size or math.exp(rng.uniform(math.log(20.0), math.log(2000.0))))
                * float(rng.choice([-1.0, 1.0]))
                for j in chosen
            }
        bias = np.array([always.get(name, 0.0) for name in names])
        out.append(replace(epoch, pseudoranges_m=np.asarray(epoch.pseudoranges_m, dtype=np.float64) + bias))
        lying.append(bias != 0.0)
    return out, lying


def cleared(fixes: Fixes, lying: Sequence[BoolArray]) -> tuple[float, float]:
    """Percent of epochs without a faulty satellite left, and of healthy satellites left out."""
    left_out = np.array([status == "excluded" for status in fixes.satellites.status])
    parts = np.split(left_out, fixes.offsets[1:-1])
    good = [not (bad & ~out).any() for bad, out in zip(lying, parts, strict=True)]
    bad_rows = np.concatenate(list(lying))
    return 100.0 * float(np.mean(good)), 100.0 * float(left_out[~bad_rows].mean())


def standing_table(data: Path, seed: int) -> Iterator[str]:
    """Measure static series of twenty epochs at a station, random and persistent faults."""
    epochs, truth = station_epochs(0, data)
    yield "| faults | size, m | all faulty excluded, jointly % | one by one % | healthy excluded % |"
    yield "| --- | --- | --- | --- | --- |"
    for persistent in (False, True):
        for size in _SIZES:
            for k in (1, 2, 3, 4):
                rows = []
                rng = np.random.default_rng((seed, k, int(size or 0), int(persistent)))
                for first in range(0, len(epochs) - _SERIES + 1, _SERIES):
                    faulty, lying = with_faults(epochs[first : first + _SERIES], k, size, persistent, rng)
                    joint, single = solved(faulty, motion="static"), solved(faulty, motion="independent")
                    rows.append((*cleared(joint, lying), cleared(single, lying)[0]))
                done, healthy, alone = np.mean(rows, axis=0)
                name = f"{k} persistent" if persistent else f"{k}"
                yield f"| {name} | {size or '20-2000'} | {done:.1f} | {alone:.1f} | {healthy:.2f} |"
    axes = enu_axes(*to_geodetic(truth)[:2].tolist())
    errors = [
        np.hypot(*(axes @ (solved(epochs[k : k + _SERIES]).position_ecef_m[0] - truth))[:2])
        for k in range(0, len(epochs) - _SERIES + 1, _SERIES)
    ]
    yield f"\nClean series at {STATIONS[0].title}: horizontal error {np.median(errors):.2f} m (median)."


def simulated_table(seed: int) -> Iterator[str]:
    """Simulate receivers: errors, coverage of 95 % regions, protection levels."""
    yield (
        "| receiver | faults | error 50 % / 95 %, m | one by one | in 95 % region | beyond HPL, unflagged "
        "| flagged |"
    )
    yield "| --- | --- | --- | --- | --- | --- | --- |"
    for name, path, count, step in (("standing", mast, 20, 300.0), ("driving", car, 60, 1.0)):
        for k in (0, 1, 2, 3, 4):
            runs = [
                drive(count, path=path, step_s=step, start_s=2000.0 * j, seed=1000 * seed + j, faults=k)
                for j in range(40 if path is mast else 12)
            ]
            yield f"| {name} | {k} | {_simulated_row(runs)} |"


def _simulated_row(runs: Sequence[Drive]) -> str:
    errors, single, inside, beyond, flagged = [], [], [], 0, []
    for run in runs:
        fixes = solved(run.epochs)
        error = run.error_enu_m(fixes.position_ecef_m)
        horizontal = np.hypot(error[:, 0], error[:, 1])
        errors.append(horizontal)
        alone = run.error_enu_m(solved(run.epochs, motion="independent").position_ecef_m)
        single.append(np.hypot(alone[:, 0], alone[:, 1]))
        squares = np.einsum("ki,kij,kj->k", error, np.linalg.inv(fixes.covariance_enu_m2), error)
        inside.append(squares < _INSIDE)
        beyond += int(((horizontal > fixes.hpl_m) & ~fixes.ambiguous).sum())
        flagged.append(fixes.ambiguous)
    e50, e95 = np.percentile(np.concatenate(errors), [50, 95])
    s50, s95 = np.nanpercentile(np.concatenate(single), [50, 95])
    return (
        f"{e50:.2f} / {e95:.2f} | {s50:.2f} / {s95:.2f} | {100 * np.concatenate(inside).mean():.1f} % | "
        f"{beyond} of {np.concatenate(inside).size} | {100 * np.concatenate(flagged).mean():.1f} %"
    )


def driven_epochs(data: Path) -> tuple[list[Epoch], FloatArray]:
    """Epochs of a drive through a city, and where the car was."""
    folder = data / "smartloc_potsdamer_a"
    rows: dict[float, list[list[float]]] = {}
    with gzip.open(folder / "Berlin_Potsdamer_Platz_Input.txt.gz", "rt", encoding="ascii") as lines:
        for line in lines:
            words = line.split()
            rows.setdefault(round(float(words[1]), 1), []).append([float(word) for word in words[2:11]])
    where = {}
    with gzip.open(folder / "Berlin_Potsdamer_Platz_GT.txt.gz", "rt", encoding="ascii") as lines:
        for line in lines:
            words = line.split()
            where[round(float(words[1]), 1)] = [float(word) for word in words[2:5]]
    epochs = []
    for seconds in sorted(rows):
        table = np.array(rows[seconds])
        system = ["G" if code == 1 else "R" for code in table[:, 6]]
        names = [f"{letter}{number:.0f}" for letter, number in zip(system, table[:, 5], strict=True)]
        epochs.append(Epoch(seconds, table[:, 2:5], table[:, 0], None, system, names, cn0_dbhz=table[:, 8]))
    return epochs, np.array([where[seconds] for seconds in sorted(rows)])


def city_table(data: Path) -> Iterator[str]:
    """Real urban driving: ratios to least squares weighted by signal strength, on the same epochs."""
    epochs, truth = driven_epochs(data)
    axes = enu_axes(*to_geodetic(truth[0])[:2].tolist())

    def errors(fixes: Fixes) -> FloatArray:
        local = (fixes.position_ecef_m - truth) @ axes.T
        return np.hypot(local[:, 0], local[:, 1])

    base = np.percentile(errors(solved(epochs, rotated=False, motion="independent", method="ols")), [50, 95])
    yield f"C/N0-weighted least squares: {base[0]:.1f} / {base[1]:.1f} m (50 % / 95 %)"
    yield f"over {len(epochs)} epochs.\n"
    yield "| solution | ratio 50 % | ratio 95 % | beyond HPL | ms per epoch |"
    yield "| --- | --- | --- | --- | --- |"
    for name, causal in (("centred, 20 s", False), ("causal, 40 s", True)):
        started = time.process_time()
        fixes = solved(epochs, rotated=False, causal=causal)
        spent = 1e3 * (time.process_time() - started) / len(epochs)
        error = errors(fixes)
        share = np.percentile(error, [50, 95]) / base
        beyond = int((error > fixes.hpl_m).sum())
        yield f"| {name} | {share[0]:.2f} | {share[1]:.2f} | {beyond} | {spent:.1f} |"


def stream_line(count: int) -> str:
    """Throughput and memory of a stream of two constellations at 1 Hz."""
    hour = drive(600, systems="GE", seed=5).epochs

    def epochs(wanted: int) -> Iterator[Epoch]:
        for k in range(wanted):
            yield replace(hour[k % len(hour)], time=float(k))

    started = time.process_time()
    answered = sum(1 for _ in locate_stream(epochs(count)))
    spent = time.process_time() - started
    peaks = []
    for wanted in (1000, 3000):
        tracemalloc.start()
        for _ in locate_stream(epochs(wanted)):
            pass
        peaks.append(tracemalloc.get_traced_memory()[1] / 1e6)
        tracemalloc.stop()
    return (
        f"{answered} epochs of {np.mean([len(np.asarray(e.pseudoranges_m)) for e in hour]):.0f} satellites: "
        f"{count / spent:.0f} epochs/s of processor time; Python memory at most {peaks[0]:.1f} MB over 1000 "
        f"epochs, {peaks[1]:.1f} MB over 3000."
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line: print the tables as Markdown."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.positions.series", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="seed of the faults (default 1)")
    parser.add_argument("--stream", type=int, default=5000, help="epochs of the stream (default 5000)")
    chosen = parser.parse_args(arguments)
    data = data_folder()
    if not data.is_dir():
        parser.error("the published data sets are not here; PLUMBLINE_TEST_DATA says where they are")
    # Kernels are compiled or read before anything is timed.
    solved(drive(30, systems="GE").epochs)
    for title, lines in (
        ("Standing: 20 epochs, 6 minutes apart, GPS", standing_table(data, chosen.seed)),
        ("Simulated", simulated_table(chosen.seed)),
        ("Driving in a city", city_table(data)),
        ("Stream", iter([stream_line(chosen.stream)])),
    ):
        sys.stdout.write(f"\n## {title}\n\n")
        for line in lines:
            sys.stdout.write(f"{line}\n")
            sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
