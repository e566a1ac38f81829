"""What ``auto`` is to reach, and whether it does: on types that it may be tuned on, and on the others."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import isnan, nan
from types import MappingProxyType

from benchmarks.report import table
from benchmarks.tracks.measure import Cell, pool
from benchmarks.tracks.scores import Pool

Figure = Callable[[Sequence[Cell]], float]


@dataclass(frozen=True, slots=True)
class Goal:
    """A figure and its bounds.

    Attributes
    ----------
    title : str
    least, most : float
        Infinite where there is none.
    digits : int
        Of the table.
    figure : callable
        From the cells of a split; NaN where there is nothing to measure.
    """

    title: str
    least: float
    most: float
    digits: int
    figure: Figure

    def is_met(self, value: float) -> bool:
        """Whether a figure is within the bounds."""
        return self.least <= value <= self.most

    def wanted(self) -> str:
        """Bounds as text."""
        if self.least == -_INFINITE:
            return f"at most {self.most:g}"
        return f"at least {self.least:g}" if self.most == _INFINITE else f"{self.least:g} to {self.most:g}"


_INFINITE = float("inf")


def _of(cells: Sequence[Cell], group: str) -> list[Cell]:
    return [cell for cell in cells if group in (cell.group, "all")]


def type_f1(cells: Sequence[Cell], field: str = "f1") -> list[float]:
    """F1, precision or recall of each type that has faults."""
    pools = [Pool(cell.scores) for cell in cells]
    return [getattr(one, field) for one in pools if not isnan(one.f1)]


def mean_f1(group: str) -> Figure:
    """Mean over the types of a group."""

    def figure(cells: Sequence[Cell]) -> float:
        found = type_f1(_of(cells, group))
        return sum(found) / len(found) if found else nan

    return figure


def worst_f1(group: str) -> Figure:
    """Least of the types of a group."""
    return lambda cells: min(type_f1(_of(cells, group)), default=nan)


def pooled(group: str, field: str) -> Figure:
    """Figure of all tracks of a group together."""
    return lambda cells: float(getattr(pool(_of(cells, group)), field))


def median_of(group: str, field: str, factor: float = 1.0) -> Figure:
    """Median over the tracks of a group."""
    return lambda cells: factor * pool(_of(cells, group)).median(field)


_MAIN = ("clean", "spikes", "bursts", "mixed", "hard")
GOALS = (
    *(Goal(f"F1, {group}", 0.97, _INFINITE, 3, mean_f1(group)) for group in _MAIN[1:4]),
    Goal("F1, hard", 0.8, _INFINITE, 3, mean_f1("hard")),
    Goal("F1, worst of hard", 0.7, _INFINITE, 3, worst_f1("hard")),
    Goal("F1, sparse", 0.65, _INFINITE, 3, mean_f1("sparse")),
    Goal("good rows flagged, clean, %", -_INFINITE, 0.1, 3, pooled("clean", "alarm_percent")),
    Goal("RMSE over the oracle's", -_INFINITE, 1.05, 2, pooled("all", "over_oracle")),
    Goal("the same, bursts", -_INFINITE, 0.9, 2, pooled("bursts", "over_oracle")),
    Goal("the same, hard", -_INFINITE, 1.4, 2, pooled("hard", "over_oracle")),
    Goal("RMSE over raw, worst track", -_INFINITE, 1.05, 2, pooled("all", "worst_over_raw")),
    *(Goal(f"95 % regions, {group}, %", 91.0, 98.0, 1, pooled(group, "coverage_percent")) for group in _MAIN),
    Goal("95 % regions, coloured, %", 80.0, _INFINITE, 1, pooled("coloured", "coverage_percent")),
    Goal("distance, median error, %", -_INFINITE, 1.0, 2, median_of("all", "distance_error", 100.0)),
    Goal("a clean receiver that stands, m/h", -_INFINITE, 20.0, 1, median_of("clean", "drift_m_per_h")),
    Goal("thousand rows per second", 30.0, _INFINITE, 1, lambda c: pool(c).points_per_second / 1e3),
)
"""On types of tracks; every split has to meet them for itself."""

DRIVE_GOALS: Mapping[str, Goal] = MappingProxyType(
    {
        "urbannav_tokyo_odaiba_wls_1hz": Goal(
            "RMSE, urbannav_tokyo_odaiba_wls_1hz, m", -_INFINITE, 30.0, 1, median_of("all", "rmse_m")
        )
    }
)
_NO_HARM = Goal("RMSE over raw, recorded drives, worst", -_INFINITE, 1.02, 2, pooled("all", "worst_over_raw"))
_REAL_REGIONS = Goal(
    "95 % regions, recorded drives, %", 80.0, _INFINITE, 1, pooled("all", "coverage_percent")
)


def goals_table(ours: Sequence[Cell], drives: Sequence[Cell]) -> str:
    """Tell every goal with what was measured, in bold where it is missed.

    Parameters
    ----------
    ours : sequence of Cell
        Of ``auto``, on types of tracks.
    drives : sequence of Cell
        Of ``auto``, on recorded drives.
    """
    rows = []
    for goal in GOALS:
        values = [goal.figure([c for c in ours if c.split == split]) for split in ("tune", "held_out")]
        if not all(isnan(value) for value in values):
            rows.append((goal.title, goal.wanted(), *(_told(goal, value) for value in values)))
    recorded = [(_NO_HARM, drives), (_REAL_REGIONS, drives)]
    recorded += [(goal, [c for c in drives if c.track == name]) for name, goal in DRIVE_GOALS.items()]
    for goal, cells in recorded:
        if cells:
            rows.append((goal.title, goal.wanted(), "", _told(goal, goal.figure(cells))))
    return table(("goal", "wanted", "tune", "held out"), rows)


def _told(goal: Goal, value: float) -> str:
    if isnan(value):
        return ""
    text = f"{value:.{goal.digits}f}"
    return text if goal.is_met(value) else f"**{text}**"
