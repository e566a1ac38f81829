"""How often changes of regime are found, and seen where there is none: ``python -m benchmarks.regimes``.

One line under every kind of contamination of the bed must be one regime; a jump, a bend and a sawtooth must
be found, with up to 40 % of uniform outliers on top.
"""

from __future__ import annotations

import argparse
import sys
import zlib
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
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


Table: TypeAlias = dict[Cell, Outcome]


def measure_all(kinds: Sequence[str], draws: int, *, seed: int, jobs: int) -> Table:
    """Measure every size and share of some kinds."""
    cells = [Cell(kind, n, share, draws) for kind in kinds for share in SHARES for n in SIZES]
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as workers:
        outcomes = [workers.submit(measure, cell, seed=seed) for cell in cells]
        return {cell: outcome.result() for cell, outcome in zip(cells, outcomes, strict=True)}


_OPENING = """# Benchmarks: regimes

Every figure on this page was measured by `python -m benchmarks.regimes`, which rewrites it: {draws} series
per cell, `fit_trend(t, y, regime="last")` on each.

## One line is one regime

Percent of the series in which changes were seen that are none, over the number of points and the share of
outliers. The kinds are those of the [line's bed](benchmarks.md); `returning` leaves its line and comes back.
"""
_CHANGES = """## Changes are found

A jump by 5 to 15 sigma, a bend to 10 to 30 sigma, a sawtooth of three to six fills of 20 sigma (a disk whose
logs are rotated), with uniform outliers within ±60 sigma on top. Percent of the series in which changes were
seen, and in which the present regime starts within 5 % of the points (or 3) of where it does.
"""


def to_markdown(table: Table) -> str:
    """Page of the results.

    Examples
    --------
    >>> page = to_markdown({Cell("jump", 100, 0.2, 20): Outcome(20, 19, 18)})
    >>> print(page.splitlines()[-1])
    | jump | 20 % | 95 / 90 |
    """
    draws = max(cell.draws for cell in table)
    parts = [_OPENING.format(draws=draws)]
    unchanged = {cell: outcome for cell, outcome in table.items() if cell.kind not in CHANGES}
    parts += _rows(unchanged, lambda one: f"{100 * one.several / one.draws:.0f}")
    parts += ["", _CHANGES]
    changed = {cell: outcome for cell, outcome in table.items() if cell.kind in CHANGES}
    parts += _rows(
        changed, lambda one: f"{100 * one.several / one.draws:.0f} / {100 * one.placed / one.draws:.0f}"
    )
    return "\n".join(parts) + "\n"


def _rows(table: Table, words: Callable[[Outcome], str]) -> list[str]:
    """One row per kind and share, one column per size."""
    sizes = sorted({cell.n for cell in table})
    lines = ["| kind | outliers | " + " | ".join(f"{n} points" for n in sizes) + " |"]
    lines.append("| --- | --- |" + " ---: |" * len(sizes))
    rows: dict[tuple[str, float], list[str]] = {}
    for cell, outcome in table.items():
        rows.setdefault((cell.kind, cell.share), []).append(words(outcome))
    lines += [f"| {kind} | {share:.0%} | ".replace("%", " %") + " | ".join(row) + " |"
              for (kind, share), row in rows.items()]  # fmt: skip
    return lines


def main(arguments: list[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.regimes", description=__doc__)
    docs = Path(__file__).resolve().parent.parent / "docs"
    parser.add_argument("--draws", type=int, default=100, help="draws per cell (default 100)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the draws (default 1)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (default 2)")
    parser.add_argument("--out", type=Path, default=docs, help="folder of benchmarks_regimes.md")
    parser.add_argument("--kinds", nargs="*", default=[*UNCHANGED, *CHANGES], help="kinds of series")
    chosen = parser.parse_args(arguments)
    table = measure_all(chosen.kinds, chosen.draws, seed=chosen.seed, jobs=chosen.jobs)
    (chosen.out / "benchmarks_regimes.md").write_text(to_markdown(table), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
