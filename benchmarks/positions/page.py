"""From the cells to ``docs/benchmarks_positions.md``: rates and times, no machine, no date."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from math import isnan
from pathlib import Path

import numpy as np

from benchmarks.positions.cells import GNSS_LIB_PY, RTKLIB, SIDEREON, Cell
from benchmarks.positions.clean import CleanCell
from benchmarks.positions.faults import SIZES
from benchmarks.report import table

_OPENING = """# Benchmarks: positions

Every figure on this page was measured by `python -m benchmarks.positions`, which rewrites it: all contenders
on the same epochs with the same faults in the same run ({versions}).

Satellites drawn at random get a bias of random sign on epochs of two stations whose position is known, and on
simulated skies at five latitudes whose true noise is a part of the stated one. `20-2000` are sizes in metres,
log-uniform; `colluding` satellites agree on a false position 100 to 1000 m away. Simulated skies have as few
as five satellites, where no method can tell who lies.

- **right**: answered, not flagged, and no faulty satellite used or less than 30 m off horizontally (of all
  epochs); **strict**: no faulty satellite used, harmless or not.
- **lies**: answered, not flagged, a faulty satellite used and more than 30 m off (of all epochs).
- **forced**: right if flags are passed over; `auto` flags, the methods beside it carry the flags of its
  posterior, and the peers refuse to answer instead.
- **healthy out**: healthy satellites excluded, of all healthy ones. **HPL**: median horizontal protection
  level in metres of the unflagged, and how many errors passed it.
- **ms**: processor time per epoch on one core: of the compiled solver for `auto` (many epochs in a call), of
  `locate` with the whole answer for the other methods, of the exclusion and solution alone for sidereon and
  gnss_lib_py, with reading the files for RTKLIB.
"""
_CLEAN = """## Without faults

Every epoch of the files of both stations by itself, from RINEX to the position, ranges of one frequency: the
horizontal, the vertical and the whole error in metres, 50 / 95 %. `ols` is plain least squares with our own
corrections. RTKLIB takes the group delay of a Galileo satellite from the first message in the file, which may
be one that has none for the signal; beside the files as they are it gets them with the other messages taken
out. An orbit or a clock that errs does so for hours, so that the 15 minutes of Kamakura are hardly more than
one draw.
"""
_PROTECTION = """## Protection levels

`auto` on {epochs} simulated epochs per row, faults of 20-2000 m.
"""
_BESIDE = """### All methods

Percent right / lies, by number of faults, pooled over the random sizes ({epochs} epochs per number and size);
colluding faults apart, pooled over their numbers.
"""


def write_page(
    cells: Sequence[Cell],
    clean: Sequence[CleanCell],
    protection: Sequence[Cell],
    versions: Sequence[str],
    folder: Path,
) -> Path:
    """Write ``benchmarks_positions.md``.

    Parameters
    ----------
    cells : sequence of Cell
        Grouped by bed.
    clean : sequence of CleanCell
    protection : sequence of Cell
    versions : sequence of str
        Of the peers that took part, or that one is absent.
    folder : pathlib.Path
    """
    parts = [_OPENING.format(versions="; ".join(versions)), _CLEAN, _clean_table(clean) + "\n"]
    for bed, group in groupby(cells, key=lambda cell: cell.bed):
        found = list(group)
        parts += [f"## {bed}\n\n`auto`, {found[0].score.epochs} epochs a row.\n", _auto_table(found) + "\n"]
        parts += [_BESIDE.format(epochs=found[0].score.epochs), _beside_table(found) + "\n"]
    parts += [_PROTECTION.format(epochs=protection[0].score.epochs), _protection_table(protection) + "\n"]
    path = folder / "benchmarks_positions.md"
    path.write_text("\n".join(parts), encoding="utf-8")
    return path


def _clean_table(cells: Sequence[CleanCell]) -> str:
    header = ("files", "epochs", "who", "horizontal", "vertical", "whole")
    rows = [
        (
            cell.station,
            str(cell.epochs),
            cell.contender,
            *(
                f"{half:.2f} / {most:.2f}"
                for half, most in (cell.horizontal_m, cell.vertical_m, cell.whole_m)
            ),
        )
        for cell in cells
    ]
    return table(header, rows)


def _auto_table(cells: Sequence[Cell]) -> str:
    header = (
        "faults", "right", "strict", "lies", "forced", "flagged", "healthy out", "HPL", "missed", "ms",
    )  # fmt: skip
    rows = []
    for cell in cells:
        if cell.contender == "auto":
            score = cell.score
            rows.append(
                (
                    "none" if cell.faults == 0 else f"{cell.faults} of {cell.size}",
                    *(f"{value:.1f}" for value in (score.right, score.strict)),
                    f"{score.lies:.2f}",
                    f"{score.forced:.1f}",
                    f"{score.flagged:.1f}",
                    f"{score.healthy_excluded:.2f}",
                    _number(score.hpl_m, 1),
                    _number(score.hpl_misses, 2),
                    f"{cell.ms:.2f}",
                )
            )
    return table(header, rows)


def _beside_table(cells: Sequence[Cell]) -> str:
    counts = sorted({cell.faults for cell in cells} - {0})
    header = ("method", "clean, healthy out", *(f"{k}" for k in counts), "colluding", "ms")
    rows = []
    for name in dict.fromkeys(cell.contender for cell in cells):
        mine = [cell for cell in cells if cell.contender == name]
        clean = next(cell for cell in mine if cell.faults == 0)
        random = [[cell for cell in mine if cell.faults == k and cell.size != SIZES[-1]] for k in counts]
        colluding = [cell for cell in mine if cell.faults > 0 and cell.size == SIZES[-1]]
        rows.append(
            (
                name,
                f"{clean.score.healthy_excluded:.2f}",
                *(_right_and_lies(group) for group in (*random, colluding)),
                f"{np.median([cell.ms for cell in mine]):.2f}",
            )
        )
    return table(header, rows)


def _protection_table(cells: Sequence[Cell]) -> str:
    header = ("epochs", "faults", "unflagged", "HPL", "missed", "lies")
    rows = [
        (
            cell.bed,
            str(cell.faults),
            f"{100.0 - cell.score.flagged - cell.score.none:.1f}",
            _number(cell.score.hpl_m, 1),
            _number(cell.score.hpl_misses, 3),
            f"{cell.score.lies:.2f}",
        )
        for cell in cells
    ]
    return table(header, rows)


def _right_and_lies(cells: Sequence[Cell]) -> str:
    right = float(np.mean([cell.score.right for cell in cells]))
    lies = float(np.mean([cell.score.lies for cell in cells]))
    return f"{right:.1f} / {lies:.2f}"


def _number(value: float, digits: int) -> str:
    return "" if isnan(value) else f"{value:.{digits}f}"


def describe_versions(rtklib: bool, sidereon: str | None, gnss_lib_py: str | None) -> list[str]:
    """Peers that took part, or that one is absent."""
    return [
        RTKLIB if rtklib else f"{RTKLIB} absent",
        f"sidereon {sidereon}" if sidereon else f"{SIDEREON} absent",
        f"gnss_lib_py {gnss_lib_py}" if gnss_lib_py else f"{GNSS_LIB_PY} absent",
    ]
