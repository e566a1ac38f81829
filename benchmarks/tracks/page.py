"""From the cells to ``docs/benchmarks_tracks.md``: scores and speeds, no machine, no date."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from pathlib import Path

from benchmarks.report import table
from benchmarks.tracks.goals import goals_table, type_f1
from benchmarks.tracks.measure import Cell, pool
from benchmarks.tracks.scores import Pool

OURS = "Plumbline auto"
RAW = "raw"
SPLITS = ("tune", "held_out")
_OPENING = """# Benchmarks: tracks

Every figure on this page was measured by `python -m benchmarks.tracks`, which rewrites it: tracks with a
known truth, {types} types of them, {seeds} of each for `auto` and {other_seeds} for the other methods, drawn
anew from their seeds; and recorded drives.

Peers: {versions}.

Half of the types may be tuned on (`tune`); the other half is `held out` and differs in kind: other motions,
other families of offsets, other noise.

- **F1**, **precision**, **recall** of the flags, over the rows of all tracks of a type, then the mean over
  the types of a group; **worst** is that of the worst type. Offsets under three sigmas and natural tails
  beyond five are not counted. **false**: percent of good rows that were flagged.
- **over oracle**: geometric mean of the RMSE over that of a smoother that knows which rows lie, drops them,
  knows the noise and has the best process noise of a grid, chosen with the truth. It can be beaten: rows of
  a burst tell of velocity, and noise that lasts is not white.
- **over raw**: RMSE over that of the raw track, geometric mean; **worst**: of all tracks.
- **95 %**: percent of the 95 % regions that hold the truth.
- **distance**: median error of the distance travelled in percent, raw and cleaned.
- **kpts/s**: a thousand rows in a second of processor time, of the cleaner's own call.

![RMSE over the oracle's by groups](images/benchmark_tracks.svg)

![Raw, cleaned and true tracks](images/benchmark_tracks_maps.png)
"""
_GOALS = """## What is to be reached

`auto`, no setting given; what is missed is in bold.
"""
_GROUPS = """## By groups

`auto`, no setting given.
"""
_TYPES = """## By types

`auto`; **over raw** is the worst of the seeds.
"""
_STANDING = """## A receiver that stands

Metres that it is said to travel in an hour; median of the seeds.
"""
_BESIDE = """## Beside peers

The same tracks for all, {other_seeds} of each type. **clean** is percent of good rows flagged; the columns
before it are F1. What was told is in the name: a highest speed of 50 m/s, or the true standard deviation.
Smoothers that flag nothing have no F1. {unanswered}
"""
_REAL = """## Recorded drives

RMSE in metres against the truth of a reference receiver, and the coverage of `auto`.
"""


@dataclass(frozen=True, slots=True)
class Measured:
    """All there is to tell.

    Attributes
    ----------
    cells, drives : sequence of Cell
        On types of tracks, and on recorded drives.
    seeds, other_seeds : int
    versions : sequence of str
        Of the peers that took part, or that one is absent.
    """

    cells: Sequence[Cell]
    drives: Sequence[Cell]
    seeds: int
    other_seeds: int
    versions: Sequence[str]


def write_page(measured: Measured, folder: Path) -> Path:
    """Write ``benchmarks_tracks.md``.

    Parameters
    ----------
    measured : Measured
    folder : pathlib.Path
    """
    ours = [cell for cell in measured.cells if cell.contender == OURS]
    types = len({cell.track for cell in ours})
    parts = [
        _OPENING.format(
            types=types,
            seeds=measured.seeds,
            other_seeds=measured.other_seeds,
            versions="; ".join(measured.versions),
        ),
        _GOALS,
        goals_table(ours, [cell for cell in measured.drives if cell.contender == OURS]) + "\n",
        _GROUPS,
        _group_table(ours) + "\n",
        _TYPES,
        _type_table(ours) + "\n",
        _STANDING,
        _standing_table(ours) + "\n",
        _BESIDE.format(other_seeds=measured.other_seeds, unanswered=_unanswered(measured.cells)),
        _beside_table(measured) + "\n",
    ]
    if measured.drives:
        parts += [_REAL, _real_table(measured.drives) + "\n"]
    else:
        parts.append("Recorded drives: not here, left out.\n")
    path = folder / "benchmarks_tracks.md"
    path.write_text("\n".join(parts), encoding="utf-8")
    return path


def _group_table(ours: Sequence[Cell]) -> str:
    header = (
        "group", "types", "F1", "worst", "precision", "recall", "false", "over oracle", "over raw", "worst",
        "95 %", "distance, raw", "cleaned", "kpts/s",
    )  # fmt: skip
    rows = []
    for split in SPLITS:
        for group in (*dict.fromkeys(cell.group for cell in ours), "all"):
            cells = [c for c in ours if c.split == split and group in (c.group, "all")]
            if cells:
                rows.append(_group_row(f"{group}, {split}".replace("_", " "), cells))
    return table(header, rows)


def _group_row(title: str, cells: Sequence[Cell]) -> tuple[str, ...]:
    together, found = pool(cells), type_f1(cells)
    return (
        title,
        f"{len(cells)}",
        _number(_mean(found), 3),
        _number(min(found, default=float("nan")), 3),
        _number(_mean(type_f1(cells, "precision")), 3),
        _number(_mean(type_f1(cells, "recall")), 3),
        _number(together.alarm_percent, 2),
        _number(together.over_oracle, 2),
        _number(together.over_raw, 2),
        _number(together.worst_over_raw, 2),
        _number(together.coverage_percent, 1),
        _number(100.0 * together.median("raw_distance_error"), 1),
        _number(100.0 * together.median("distance_error"), 1),
        _number(together.points_per_second / 1e3, 1),
    )


def _type_table(ours: Sequence[Cell]) -> str:
    header = ("type", "split", "F1", "false", "RMSE, m", "over oracle", "over raw", "95 %", "distance")
    rows = []
    for cell in ours:
        own = Pool(cell.scores)
        rows.append(
            (
                cell.track,
                cell.split.replace("_", " "),
                _number(own.f1, 3),
                _number(own.alarm_percent, 2),
                _number(own.median("rmse_m"), 1),
                _number(own.over_oracle, 2),
                _number(own.worst_over_raw, 2),
                _number(own.coverage_percent, 1),
                _number(100.0 * own.median("distance_error"), 1),
            )
        )
    return table(header, rows)


def _standing_table(ours: Sequence[Cell]) -> str:
    pools = {cell.track: Pool(cell.scores) for cell in ours}
    rows = [
        (name, _number(drift, 1))
        for name, own in pools.items()
        if not isnan(drift := own.median("drift_m_per_h"))
    ]
    return table(("type", "m/h"), rows)


def _beside_table(measured: Measured) -> str:
    faulty = ("spikes", "bursts", "mixed", "hard", "sparse")
    header = (
        "method", *faulty, "clean", "over oracle, tune", "held out", "worst over raw", "distance", "kpts/s",
    )  # fmt: skip
    rows = []
    for name, cells in _by_contender(measured.cells).items():
        fair = [_first(cell, measured.other_seeds) for cell in cells]
        together = pool(fair)
        rows.append(
            (
                name,
                *(_number(_mean(type_f1([c for c in fair if c.group == group])), 2) for group in faulty),
                _number(pool(fair, group="clean").alarm_percent, 2),
                *(_number(pool(fair, split=split).over_oracle, 2) for split in SPLITS),
                _number(together.worst_over_raw, 2),
                _number(100.0 * together.median("distance_error"), 1),
                _number(together.points_per_second / 1e3, 1),
            )
        )
    return table(header, rows)


def _real_table(drives: Sequence[Cell]) -> str:
    names = list(_by_contender(drives))
    header = ("drive", "points", *(name for name in names), "95 %")
    rows = []
    for track in dict.fromkeys(cell.track for cell in drives):
        found = {cell.contender: cell for cell in drives if cell.track == track}
        (score,) = found[OURS].scores
        errors = (
            "none" if found[name].unanswered else f"{found[name].scores[0].rmse_m:.1f}" for name in names
        )
        rows.append((track, f"{score.points}", *errors, _number(Pool((score,)).coverage_percent, 1)))
    return table(header, rows)


def _unanswered(cells: Sequence[Cell]) -> str:
    counts = {name: sum(cell.unanswered for cell in own) for name, own in _by_contender(cells).items()}
    said = [f"{name} raised errors on {count} tracks" for name, count in counts.items() if count]
    return f"Scored as raw where there was no answer: {'; '.join(said)}." if said else "All answered."


def _by_contender(cells: Sequence[Cell]) -> Mapping[str, list[Cell]]:
    names = dict.fromkeys(cell.contender for cell in cells)
    return {name: [cell for cell in cells if cell.contender == name] for name in names}


def _first(cell: Cell, seeds: int) -> Cell:
    return Cell(cell.track, cell.group, cell.split, cell.contender, cell.scores[:seeds], cell.unanswered)


def _mean(values: Sequence[float]) -> float:
    known = [value for value in values if not isnan(value)]
    return sum(known) / len(known) if known else float("nan")


def _number(value: float, digits: int) -> str:
    return "" if isnan(value) else f"{value:.{digits}f}"
