"""Cells of an experiment (kind, size, share) and their measurement, the same draws for every contender.

A draw depends on its cell and its index alone, so that results do not depend on the number of processes
or on what else is measured.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from benchmarks import metrics
from benchmarks.bed import draw_rng, make_series
from benchmarks.contenders import Contender
from estimators.arrays import BoolArray, FloatArray


class Cell(NamedTuple):
    """One kind of contamination at one size and share, and how many draws of it."""

    kind: str
    n: int
    share: float
    draws: int


@dataclass(frozen=True, slots=True)
class Outcomes:
    """One contender on the draws of one or several cells; one row per draw.

    Attributes
    ----------
    errors, oracle_errors, oracle_stderr : ndarray of float64, shape (draws, 2)
        At the first and last time.
    inliers : ndarray of float64, shape (draws,)
        True inliers.
    f1 : ndarray of float64, shape (draws,)
        NaN where nothing was contaminated.
    covered : ndarray of float64, shape (draws,)
        1 or 0; NaN where no interval is given.
    p_value : ndarray of float64, shape (draws,)
    """

    errors: FloatArray
    oracle_errors: FloatArray
    oracle_stderr: FloatArray
    inliers: FloatArray
    f1: FloatArray
    covered: FloatArray
    p_value: FloatArray

    @property
    def failed(self) -> BoolArray:
        """Draws on which the line is wrong."""
        return metrics.failed(self.errors, self.oracle_stderr)

    def fail_percent(self) -> float:
        """Failures among the draws, in percent; NaN without draws."""
        return 100.0 * metrics.mean_or_nan(self.failed)

    def rms_over_oracle(self) -> float:
        """Line error over the oracle's on draws that did not fail."""
        good = ~self.failed
        return metrics.rms_over_oracle(self.errors[good], self.oracle_errors[good], self.inliers[good])

    def mean_f1(self) -> float:
        """Flag F1 on draws that did not fail."""
        return metrics.mean_or_nan(self.f1[~self.failed])

    def coverage(self) -> float:
        """Share of slope intervals that hold the truth, on draws that did not fail."""
        return metrics.mean_or_nan(self.covered[~self.failed])


def pool(parts: Sequence[Outcomes]) -> Outcomes:
    """Outcomes of several cells as one."""
    if not parts:
        return _empty()
    return Outcomes(
        *(np.concatenate([getattr(part, name) for part in parts]) for name in Outcomes.__dataclass_fields__)
    )


def measure(contenders: Sequence[Contender], cell: Cell, *, seed: int, first: int = 0) -> list[Outcomes]:
    """Draw a cell and let every contender fit it.

    Parameters
    ----------
    contenders : sequence of Contender
    cell : Cell
    seed : int
        Of the whole experiment.
    first : int
        Index of the first draw.

    Returns
    -------
    list of Outcomes
        One per contender.
    """
    tables = [_table(cell.draws) for _ in contenders]
    for row in range(cell.draws):
        rng = draw_rng(seed, cell.kind, cell.n, cell.share, first + row)
        draw = make_series(cell.kind, cell.n, cell.share, rng)
        truth = metrics.oracle(draw)
        true_ends = draw.truth_intercept + draw.truth_slope * draw.t[[0, -1]]
        for contender, table in zip(contenders, tables, strict=True):
            answer = contender.fit(draw.t, draw.y, draw.sigma)
            table.errors[row] = answer.ends - true_ends
            table.oracle_errors[row] = truth.errors
            table.oracle_stderr[row] = truth.stderr
            table.inliers[row] = truth.inliers
            table.f1[row] = metrics.flag_f1(answer.flagged, draw.inlier_mask)
            if not np.isnan(answer.low):
                table.covered[row] = metrics.covers(answer.low, answer.high, draw.truth_slope)
            table.p_value[row] = answer.p_value
    return tables


def measure_all(
    contenders: Sequence[Contender],
    cells: Sequence[Cell],
    *,
    seed: int,
    jobs: int = 1,
    progress: Callable[[str], None] | None = None,
) -> dict[Cell, list[Outcomes]]:
    """Measure cells in ``jobs`` processes; the result does not depend on their number."""
    slices = [(cell, piece) for cell in cells for piece in _slices(cell)]
    work = partial(_measure_slice, tuple(contenders), seed)
    gathered: dict[Cell, list[list[Outcomes]]] = {cell: [] for cell in cells}
    for done, ((cell, _), outcomes) in enumerate(zip(slices, _map(work, slices, jobs), strict=True), start=1):
        gathered[cell].append(outcomes)
        if progress is not None:
            progress(f"{done}/{len(slices)} {cell.kind} n={cell.n} share={cell.share:g}")
    return {
        cell: [pool([part[index] for part in parts]) for index in range(len(contenders))]
        for cell, parts in gathered.items()
    }


def _empty() -> Outcomes:
    return _table(0)


def _table(draws: int) -> Outcomes:
    pairs = [np.full((draws, 2), np.nan) for _ in range(3)]
    return Outcomes(*pairs, *(np.full(draws, np.nan) for _ in range(4)))


def _slices(cell: Cell, size: int = 250) -> Iterable[tuple[int, int]]:
    """First index and number of draws of the pieces that a cell is worked off in."""
    return [(first, min(size, cell.draws - first)) for first in range(0, cell.draws, size)]


def _measure_slice(
    contenders: tuple[Contender, ...], seed: int, piece: tuple[Cell, tuple[int, int]]
) -> list[Outcomes]:
    cell, (first, draws) = piece
    return measure(contenders, cell._replace(draws=draws), seed=seed, first=first)


def _map(
    work: Callable[[tuple[Cell, tuple[int, int]]], list[Outcomes]],
    slices: Sequence[tuple[Cell, tuple[int, int]]],
    jobs: int,
) -> Iterable[list[Outcomes]]:
    if jobs <= 1:
        yield from map(work, slices)
        return
    # Fresh processes: forking one that has started threads is not safe.
    with ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn")) as workers:
        yield from workers.map(work, slices)
