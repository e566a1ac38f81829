"""``python -m benchmarks.many``: many series at once beside a loop of scikit-learn, and memory.

A repetition times everybody on series of its own, one after the other; figures are medians over the
repetitions. Seconds are told by the clock on the wall and in processor time: of a machine that others use
too, the second says more. Memory is the peak of a fresh process beyond the one before the fit, so that what
is returned per point counts where it is asked for.
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
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import sklearn

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

_OPENING = """# Benchmarks: many series

Every figure on this page was measured by `python -m benchmarks.many`, which rewrites it: `fit_trends` with
{threads} threads, and a Python loop over scikit-learn's RANSACRegressor ({sklearn}, numpy {numpy}) on the
same series in the same run; medians of interleaved repetitions. Series have {points} irregular points,
{share:.0f} % of them uniform outliers as on the [bed of lines](benchmarks.md). The loop is told the threshold
where `fit_trends` is, else it uses its default. It gives no interval; `fit_trends` always does."""
_MEMORY_PROSE = """CPU time counts all threads together, so that its ratio is what is gained without
any. On a machine that is busy otherwise, series per second fall; CPU time changes far less.

## Memory

Peak beyond the input and what was there before, in sizes of the input (times and values). Without labels
(`points=False`) a table has some 25 numbers per series; labels, probabilities, residuals and reasons are 18
bytes per point, which are 1.1 sizes of the input."""

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
    ManyCase("`ransac`, threshold given", "ransac", KNOWN_THRESHOLD, 20_000),
    ManyCase("`msac`, threshold given", "msac", KNOWN_THRESHOLD, 20_000),
    ManyCase("`auto`, nothing given", "auto", None, 4_000),
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
        How many times longer the loop of scikit-learn takes for a series by the clock on the wall, median.
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
    """Page of what was measured; sizes that nobody could tell are dashes."""
    opening = _OPENING.format(
        points=POINTS, share=100.0 * SHARE, threads=threads, sklearn=sklearn.__version__, numpy=np.__version__
    )
    lines = [
        *opening.splitlines(),
        "",
        "| method | series per second | CPU time per series | times as fast as the loop | in CPU time |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    for one in speeds:
        row = f"| {one.case.name} | {one.per_second:,.0f} | {one.cpu_us:.0f} µs | {one.times_sklearn:.0f} "
        row += f"| {one.times_sklearn_cpu:.0f} |"
        lines.append(row)
    lines += ["", *_MEMORY_PROSE.splitlines(), "", "| fit | sizes of the input |", "| --- | ---: |"]
    for name, sizes in memory:
        lines.append(f"| {name} | {'-' if np.isnan(sizes) else f'{sizes:.2f}'} |")
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.many", description=__doc__)
    docs = Path(__file__).resolve().parent.parent / "docs"
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1, help="seed of the draws (default 1)")
    parser.add_argument("--out", type=Path, default=docs, help="folder of benchmarks_many.md")
    chosen = parser.parse_args(arguments)
    speeds = [
        measure_many(case, seed=chosen.seed, repetitions=chosen.repetitions, threads=chosen.threads)
        for case in CASES
    ]
    memory = [
        (f"{case.name}, {'labels kept' if points else 'no labels'}", measure_memory(case, points=points))
        for case in (CASES[1], CASES[2])
        for points in (False, True)
    ]
    page = to_markdown(speeds, memory, chosen.threads)
    (chosen.out / "benchmarks_many.md").write_text(page, encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
