"""Accuracy of Plumbline and its peers on the same draws: failures, line error, flags, interval coverage."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.bed import KINDS, true_inliers
from benchmarks.cells import Cell, Outcomes, measure_all, pool
from benchmarks.contenders import Contender
from estimators.arrays import FloatArray

DRAWS: Mapping[int, int] = {50: 60, 200: 40, 1000: 25}
"""Draws per kind and share at each size; a cell of the tables pools them."""
SHARES = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9)
NORMAL_KINDS = tuple(kind for kind in KINDS if kind != "t2")
"""Kinds with an oracle: least squares is none under Student-t2 noise, a robust line beats it."""
LEAST_INLIERS = 10
"""Cells with fewer true inliers are left out."""


@dataclass(frozen=True, slots=True)
class Accuracy:
    """What every contender reached.

    Attributes
    ----------
    contenders : tuple of Contender
    table : mapping
        ``table[kind, share]`` holds one :class:`Outcomes` per contender, all sizes pooled.
    """

    contenders: tuple[Contender, ...]
    table: Mapping[tuple[str, float], Sequence[Outcomes]]

    def by_share(
        self, index: int, measure: Callable[[Outcomes], float], kinds: Iterable[str] = tuple(KINDS)
    ) -> FloatArray:
        """Mean over kinds of a contender's figure at every share, shape (shares,); NaN where unknown."""
        chosen = tuple(kinds)
        return np.array(
            [_mean([measure(self.table[kind, share][index]) for kind in chosen]) for share in SHARES]
        )

    def mean_fail(self, index: int) -> float:
        """Mean failure in percent over kinds x shares with outliers."""
        return _mean(
            [outcomes[index].fail_percent() for (_, share), outcomes in self.table.items() if share > 0.0]
        )

    def mean_f1(self, index: int) -> float:
        """Mean flag F1 over kinds x shares with outliers, on fits that did not fail."""
        return _mean(
            [outcomes[index].mean_f1() for (_, share), outcomes in self.table.items() if share > 0.0]
        )


def measure_bed(
    contenders: Sequence[Contender],
    *,
    seed: int,
    scale: float = 1.0,
    jobs: int = 1,
    progress: Callable[[str], None] | None = None,
) -> Accuracy:
    """Measure contenders on the bed.

    Parameters
    ----------
    contenders : sequence of Contender
    seed : int
        Of the draws.
    scale : float
        Multiplies the draws per cell; 1 gives 60, 40 and 25 at N = 50, 200 and 1000.
    jobs : int
        Processes.
    progress : callable, optional
        Told after every slice of work.
    """
    cells = [
        Cell(kind, n, share, max(1, round(scale * draws)))
        for kind in KINDS
        for share in SHARES
        for n, draws in DRAWS.items()
        if true_inliers(kind, n, share) >= LEAST_INLIERS
    ]
    measured = measure_all(contenders, cells, seed=seed, jobs=jobs, progress=progress)
    table = {
        (kind, share): [
            pool([measured[cell][index] for cell in cells if (cell.kind, cell.share) == (kind, share)])
            for index in range(len(contenders))
        ]
        for kind in KINDS
        for share in SHARES
    }
    return Accuracy(tuple(contenders), table)


def _mean(values: Sequence[float]) -> float:
    known = [value for value in values if not np.isnan(value)]
    return float(np.mean(known)) if known else float("nan")
