"""Speed as ratios: every contender on the same series in one run, at 40 % uniform outliers.

Repetitions are interleaved (one call of everybody, then the next series), so that a machine that slows
down slows all alike; what is reported are medians of the ratios within a repetition. CPU time counts all
threads; wall time does not.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numba
import numpy as np

from benchmarks.bed import KINDS, Draw, draw_rng, make_series
from benchmarks.claims import Claim
from benchmarks.contenders import AUTO, KNOWN_THRESHOLD, MSAC, Contender
from benchmarks.footprint import Footprint
from benchmarks.peers import QUADRATIC
from estimators.arrays import FloatArray

SIZES: Mapping[int, int] = {200: 21, 10_000: 5, 1_000_000: 5}
"""Sizes and repetitions."""
SHARE = 0.4
LONGEST_QUADRATIC = 10_000
"""Peers that compare all pairs of points are not asked for more: hours, or more memory than machines have."""
COPIES = 8
"""Copies of a series that are read in turn: at a million points, more than caches hold."""
LEAST_S = 0.02
"""A timing repeats its call until this much wall time has passed."""


@dataclass(frozen=True, slots=True)
class Timing:
    """Seconds of one call."""

    cpu: float
    wall: float


@dataclass(frozen=True, slots=True)
class SpeedTable:
    """Timings at one size: ``timings[contender][repetition]``."""

    n: int
    timings: Mapping[Contender, Sequence[Timing]]

    def ratio(self, contender: Contender, to: Contender, clock: str = "cpu") -> float:
        """How many times longer a contender takes, median over the repetitions."""
        pairs = zip(self.timings[contender], self.timings[to], strict=True)
        return float(np.median([getattr(one, clock) / getattr(other, clock) for one, other in pairs]))


@dataclass(frozen=True, slots=True)
class Passes:
    """Fused reads that ``auto`` costs at ``n`` points, over all kinds of the bed at 40 % outliers."""

    n: int
    median: float
    worst: float
    worst_kind: str


@numba.njit(fastmath=True)
def fused_read(x: FloatArray, y: FloatArray) -> float:
    """Read x and y once: the sum of their products, in whatever order is fastest."""
    total = 0.0
    for index in range(x.size):
        total += x[index] * y[index]
    return total


def time_read(draw: Draw) -> float:
    """CPU time of one fused read of a series that is not in the cache: what nobody can avoid."""
    copies = [(draw.t.copy(), draw.y.copy()) for _ in range(COPIES)]

    def read_all() -> None:
        for t, y in copies:
            fused_read(t, y)

    return time_call(read_all).cpu / COPIES


def time_call(call: Callable[[], object], least_s: float = LEAST_S) -> Timing:
    """CPU and wall time of one call, the mean of as many as fill ``least_s``."""
    calls = 1
    while True:
        wall, cpu = time.perf_counter(), time.process_time()
        for _ in range(calls):
            call()
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
        if wall >= least_s:
            return Timing(cpu / calls, wall / calls)
        calls *= 2 if wall * 4 >= least_s else 1 + int(least_s / max(wall, 1e-7))


def measure_speed(
    n: int,
    *,
    contenders: Sequence[Contender],
    seed: int,
    repetitions: int,
    progress: Callable[[str], None] | None = None,
) -> SpeedTable:
    """Time contenders at one size, interleaved; those that cannot do that size are left out.

    Parameters
    ----------
    n : int
    contenders : sequence of Contender
    seed : int
        Of the series.
    repetitions : int
        Series, each timed once per contender.
    progress : callable, optional
        Told after every repetition.
    """
    able = [entry for entry in contenders if n <= LONGEST_QUADRATIC or entry.name not in QUADRATIC]
    timings: dict[Contender, list[Timing]] = {entry: [] for entry in able}
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        _warm(able, seed)
        for index in range(repetitions):
            draw = _series("uniform", n, seed, index)
            for contender in able:
                timings[contender].append(_time_fit(contender, draw))
            if progress is not None:
                progress(f"N={n} repetition {index + 1}/{repetitions}")
    return SpeedTable(n, timings)


def measure_passes(*, seed: int, n: int = 1_000_000, draws: int = 3) -> Passes:
    """Count the fused reads that ``auto`` costs, on ``draws`` series of every kind."""
    _warm([AUTO], seed)
    costs: list[tuple[float, str]] = []
    for kind in KINDS:
        for index in range(draws):
            draw = _series(kind, n, seed, index)
            read = time_read(draw)
            costs.append((_time_fit(AUTO, draw).cpu / read, kind))
    return Passes(n, float(np.median([cost for cost, _ in costs])), *max(costs))


def check_speed(
    tables: Mapping[int, SpeedTable], passes: Passes, footprints: Mapping[str, Footprint]
) -> list[Claim]:
    """Hold the claims about speed against what was measured (sizes that were not measured are left out)."""
    wanted = (
        (200, AUTO, "scikit-learn RANSACRegressor", 10.0),
        (200, MSAC, "scikit-image ransac", 5.0),
        (1_000_000, AUTO, "scikit-learn RANSACRegressor", 5.0),
        (1_000_000, AUTO, "scikit-image ransac", 30.0),
    )
    claims = []
    for n, ours, name, factor in wanted:
        if n in tables:
            rivals = [contender for contender in tables[n].timings if contender.name == name]
            reached = min(tables[n].ratio(rival, ours) for rival in rivals)
            text = f"{ours.name}, N = {n}: times faster than {name}"
            claims.append(Claim(text, reached, factor, float("inf"), 0.0))
    claims.append(
        Claim(f"fused reads of {passes.n:,} points, median over the kinds", passes.median, 0.0, 40.0, 0.0)
    )
    claims.append(Claim(f"fused reads of {passes.n:,} points, worst", passes.worst, 0.0, 80.0, 0.0))
    start = footprints[AUTO.name].start_s
    claims.append(Claim("seconds from a cold process to the first fit, kernels cached", start, 0.0, 1.0, 0.0))
    return claims


def _series(kind: str, n: int, seed: int, index: int) -> Draw:
    return make_series(kind, n, SHARE, draw_rng(seed, kind, n, SHARE, index))


def _time_fit(contender: Contender, draw: Draw) -> Timing:
    threshold = KNOWN_THRESHOLD * draw.sigma if contender.knows_threshold else None
    return time_call(partial(contender.raw, draw.t, draw.y, threshold))


def _warm(contenders: Sequence[Contender], seed: int) -> None:
    """Let everybody import and compile what it needs."""
    draw = _series("uniform", 200, seed, 0)
    fused_read(draw.t, draw.y)
    for contender in contenders:
        contender.fit(draw.t, draw.y)
