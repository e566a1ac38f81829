"""Many series at once: ``fit_trends`` beside a loop of scikit-learn in the same run, and its memory.

``python -m benchmarks.many`` prints a table. A repetition times everybody on series of its own, one after the
other; ratios are medians over the repetitions. Memory is the peak of a fresh process beyond the one before
the fit, so that what is returned per point counts too where it is asked for.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.bed import draw_rng, make_series
from benchmarks.contenders import KNOWN_THRESHOLD
from benchmarks.peers import PEERS
from estimators import fit_trends
from estimators.arrays import FloatArray

POINTS = 200
SHARE = 0.3
SKLEARN = "scikit-learn RANSACRegressor"
_COPIES = 64
"""Different series; a batch repeats them, since drawing takes longer than fitting."""

_MEMORY = """
import json, sys, numpy as np
from estimators import fit_trends
def peak():
    # The kernel's mark of this process alone; getrusage would start from the size of our parent.
    with open("/proc/self/status") as status:
        return next(1024.0 * float(line.split()[1]) for line in status if line.startswith("VmHWM"))
settings = json.loads(sys.argv[3])
t, y = np.load(sys.argv[1]), np.load(sys.argv[2])
fit_trends(t[0], y[:64], threads=2, **settings)
before = peak()
fit_trends(t.ravel(), y.ravel(), np.arange(len(y) + 1) * y.shape[1], **settings)
print((peak() - before) / (t.nbytes + y.nbytes))
"""


@dataclass(frozen=True, slots=True)
class ManyCase:
    """One way to fit many series.

    Attributes
    ----------
    name : str
    method : str
    threshold : float or None
        In noise scales, which the series have as their unit.
    series : int
        Per repetition; scikit-learn fits a part of them.
    """

    name: str
    method: str
    threshold: float | None
    series: int

    @property
    def settings(self) -> dict[str, object]:
        """Arguments of ``fit_trends``."""
        return {"method": self.method, "threshold": self.threshold}


CASES = (
    ManyCase("ransac, threshold given", "ransac", KNOWN_THRESHOLD, 20_000),
    ManyCase("msac, threshold given", "msac", KNOWN_THRESHOLD, 20_000),
    ManyCase("auto, with intervals", "auto", None, 4_000),
)


@dataclass(frozen=True, slots=True)
class ManySpeed:
    """What was measured of a case.

    Attributes
    ----------
    case : ManyCase
    per_second : float
        Series, by the clock on the wall, median.
    cpu_us : float
        Processor time of a series, all threads together, median.
    times_sklearn : float
        How many times longer scikit-learn takes for a series by the clock on the wall, median.
    times_sklearn_cpu : float
        The same in processor time, which a busy machine distorts less; threads bring nothing here.
    """

    case: ManyCase
    per_second: float
    cpu_us: float
    times_sklearn: float
    times_sklearn_cpu: float


def draw_batch(series: int, seed: int) -> tuple[FloatArray, FloatArray]:
    """Draw times and values of shape (series, POINTS), with uniform outliers and noise of scale 1."""
    drawn = [
        make_series("uniform", POINTS, SHARE, draw_rng(seed, "uniform", POINTS, SHARE, k))
        for k in range(_COPIES)
    ]
    repeats = -(-series // _COPIES)
    t = np.tile(np.array([one.t for one in drawn]), (repeats, 1))[:series]
    y = np.tile(np.array([one.y / one.sigma for one in drawn]), (repeats, 1))[:series]
    return t, y


def measure_many(
    case: ManyCase, *, seed: int, repetitions: int, threads: int, sklearn_series: int = 48
) -> ManySpeed:
    """Time a case and the loop of scikit-learn, interleaved.

    Parameters
    ----------
    case : ManyCase
    seed : int
    repetitions : int
    threads : int
    sklearn_series : int
        Series of a repetition that scikit-learn fits.
    """
    peer = next(one for one in PEERS if one.name == SKLEARN and one.knows_threshold == bool(case.threshold))
    figures = []
    for repetition in range(repetitions):
        t, y = draw_batch(case.series, seed + repetition)
        offsets = np.arange(case.series + 1) * POINTS
        fit_trends(t[0], y[:threads], threads=threads, method=case.method, threshold=case.threshold)
        wall, cpu = time.perf_counter(), time.process_time()
        fit_trends(
            t.ravel(), y.ravel(), offsets, threads=threads, method=case.method, threshold=case.threshold
        )
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            loop, loop_cpu = time.perf_counter(), time.process_time()
            for k in range(sklearn_series):
                peer.raw(t[k], y[k], case.threshold)
            loop, loop_cpu = time.perf_counter() - loop, time.process_time() - loop_cpu
        share = case.series / sklearn_series
        figures.append(
            (case.series / wall, 1e6 * cpu / case.series, loop * share / wall, loop_cpu * share / cpu)
        )
    return ManySpeed(case, *np.median(np.array(figures), axis=0).tolist())


def measure_memory(case: ManyCase, *, points: bool, series: int = 50_000) -> float:
    """Peak memory beyond the input's, in sizes of the input (times and values); NaN where nobody can tell."""
    if not Path("/proc/self/status").exists():
        return float("nan")
    settings = json.dumps(case.settings | {"points": points})
    t, y = draw_batch(series, 0)
    with tempfile.TemporaryDirectory() as folder:
        files = [str(Path(folder, name)) for name in ("t.npy", "y.npy")]
        for file, column in zip(files, (t, y), strict=True):
            np.save(file, column)
        command = [sys.executable, "-c", _MEMORY, *files, settings]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    return float(done.stdout.splitlines()[-1])


def to_markdown(speeds: Sequence[ManySpeed], memory: Sequence[tuple[str, float]], threads: int) -> str:
    """Tables of what was measured."""
    lines = [
        f"| {threads} threads, {POINTS} points, {SHARE:.0%} outliers | series per second | CPU per series "
        "| times scikit-learn | the same in CPU time |",
        "|---|---|---|---|---|",
    ]
    for one in speeds:
        row = f"| {one.case.name} | {one.per_second:,.0f} | {one.cpu_us:.0f} µs | {one.times_sklearn:.0f} "
        row += f"| {one.times_sklearn_cpu:.0f} |"
        lines.append(row)
    lines += ["", "| memory beyond the input | in sizes of the input |", "|---|---|"]
    lines += [f"| {name} | {share:.2f} |" for name, share in memory]
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.many", description=__doc__)
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args(arguments)
    say: Callable[[str], object] = sys.stdout.write
    speeds = [
        measure_many(case, seed=chosen.seed, repetitions=chosen.repetitions, threads=chosen.threads)
        for case in CASES
    ]
    memory = [
        (
            f"{CASES[1].name}, {'labels kept' if points else 'points=False'}",
            measure_memory(CASES[1], points=points),
        )
        for points in (False, True)
    ]
    say(to_markdown(speeds, memory, chosen.threads) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
