"""How often changes of regime are found, and seen where there is none: ``python -m benchmarks.regimes``.

One line under every kind of contamination of the bed must be one regime; a jump, a bend and a sawtooth must
be found, with up to 40 % of uniform outliers on top.
"""

from __future__ import annotations

import argparse
import sys
import zlib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple, TypeAlias

import numpy as np

from benchmarks.bed import ALL_KINDS, RISE, make_series
from benchmarks.kinds import BOX, SPAN, add_runs, excursion_levels, irregular_times, scattered_rows
from estimators import NoFit, fit_trend
from estimators.arrays import FloatArray

LEAST_LAST = 15
"""Readings of the last regime, at least."""
NEAR = 0.05
"""A change is placed right within this share of the readings, or 3 of them."""
SIZES = (100, 200, 500, 1000)
SHARES = (0.0, 0.2, 0.3, 0.4)
UNCHANGED = (
    "uniform",
    "shift",
    "t2",
    "line2",
    "gamma",
    "ends",
    "heteroscedastic",
    "returning",
    "ar1_0.5",
    "ar1_0.8",
)


class Cell(NamedTuple):
    """One kind of series at one size and share of outliers, and how many draws of it."""

    kind: str
    n: int
    share: float
    draws: int


class Changed(NamedTuple):
    """Times, values before outliers, and the first reading of the last regime."""

    t: FloatArray
    y: FloatArray
    last: int


@dataclass(frozen=True, slots=True)
class Outcome:
    """What was answered on the draws of a cell.

    Attributes
    ----------
    draws : int
    several : int
        Answers with more than one regime.
    placed : int
        Answers whose last regime starts where it does, as nearly as :data:`NEAR` says.
    """

    draws: int
    several: int
    placed: int


Change: TypeAlias = Callable[[int, np.random.Generator], Changed]


def _break(n: int, rng: np.random.Generator) -> int:
    """First reading after a change amid the series."""
    return int(rng.integers(max(LEAST_LAST, n // 5), n - max(LEAST_LAST, n // 7)))


def jump(n: int, rng: np.random.Generator) -> Changed:
    """Level that jumps by 5 to 15 sigma on a common slope."""
    t, at = irregular_times(n, rng), _break(n, rng)
    y = rng.uniform(-RISE, RISE) * t / SPAN + rng.normal(size=n)
    y[at:] += rng.choice([-1.0, 1.0]) * rng.uniform(5.0, 15.0)
    return Changed(t, y, at)


def bend(n: int, rng: np.random.Generator) -> Changed:
    """Slope that changes without a jump; the lines are 10 to 30 sigma apart in the end."""
    t, at = irregular_times(n, rng), _break(n, rng)
    y = rng.uniform(-RISE, RISE) * t / SPAN + rng.normal(size=n)
    since = np.maximum(t - t[at], 0.0)
    y += rng.choice([-1.0, 1.0]) * rng.uniform(10.0, 30.0) * since / since[-1]
    return Changed(t, y, at)


def sawtooth(n: int, rng: np.random.Generator) -> Changed:
    """Three to six equal fills of 20 sigma, each ended by a drop: rotated logs."""
    teeth = int(rng.integers(3, 7))
    t = irregular_times(n, rng, gap=0.0)
    edges = np.linspace(0.0, SPAN, teeth + 1)[:-1]
    tooth = np.searchsorted(edges, t, side="right") - 1
    y = 20.0 * (t - edges[tooth]) * teeth / SPAN + rng.normal(size=n)
    return Changed(t, y, int(np.searchsorted(tooth, teeth - 1)))


CHANGES: MappingProxyType[str, Change] = MappingProxyType({"jump": jump, "bend": bend, "sawtooth": sawtooth})
"""Series of more than one regime."""


def _returning(n: int, share: float, rng: np.random.Generator) -> Changed:
    """One line with up to three excursions, each followed by more readings of the line than it has itself."""
    t, offset = irregular_times(n, rng), rng.normal(size=n)
    parts = int(rng.integers(1, 4))
    length = round(share * n / parts)
    slot = n // parts
    rows = [np.arange(k * slot + (slot - length) // 2, k * slot + (slot + length) // 2) for k in range(parts)]
    made = add_runs(offset, rows, excursion_levels(parts, rng, nearest=8.0, apart=15.0), t)
    return Changed(t, rng.uniform(-RISE, RISE) * t / SPAN + made.offset, 0)


def draw(cell: Cell, seed: int, index: int) -> Changed:
    """One series of a cell: a pure function of the cell, the seed and the index."""
    kind, n, share = cell.kind, cell.n, cell.share
    rng = np.random.default_rng([seed, zlib.crc32(kind.encode()), n, round(1000 * share), index])
    if kind == "returning":
        return _returning(n, share, rng)
    if kind in ALL_KINDS:
        made = make_series(kind, n, share, rng)
        return Changed(made.t, made.y, 0)
    changed = CHANGES[kind](n, rng)
    hit = scattered_rows(n, round(share * n), rng)
    changed.y[hit] += rng.uniform(-BOX, BOX, size=hit.size)
    return changed


def measure(cell: Cell, *, seed: int) -> Outcome:
    """Ask for the present regime of every draw of a cell."""
    several = placed = 0
    for index in range(cell.draws):
        made = draw(cell, seed, index)
        trend = fit_trend(made.t, made.y, regime="last")
        if isinstance(trend, NoFit):
            continue
        several += len(trend.regimes) > 1
        start = int(np.searchsorted(made.t, trend.regimes[-1].start))
        placed += abs(start - made.last) <= max(3.0, NEAR * cell.n)
    return Outcome(cell.draws, several, placed)


def report(kinds: Sequence[str], draws: int, seed: int) -> Iterable[str]:
    """Yield one line per kind and share: per cent of several regimes and of right places by size."""
    yield f"{'kind':16} share  " + "  ".join(f"n={n:<5} several placed" for n in SIZES)
    for kind in kinds:
        for share in SHARES:
            cells = [measure(Cell(kind, n, share, draws), seed=seed) for n in SIZES]
            told = (
                f"{'':7} {100 * cell.several / draws:6.0f}% {100 * cell.placed / draws:5.0f}%"
                for cell in cells
            )
            yield f"{kind:16} {share:5.0%}  " + "  ".join(told)


def main(arguments: list[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.regimes", description=__doc__)
    parser.add_argument("--draws", type=int, default=100, help="draws per cell (default 100)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the draws (default 1)")
    parser.add_argument("--kinds", nargs="*", default=[*UNCHANGED, *CHANGES], help="kinds of series")
    chosen = parser.parse_args(arguments)
    for line in report(chosen.kinds, chosen.draws, chosen.seed):
        sys.stdout.write(line + "\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
