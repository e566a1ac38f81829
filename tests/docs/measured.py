"""Figures that a page of benchmarks has, for tables of other pages."""

from __future__ import annotations

from itertools import dropwhile, takewhile
from pathlib import Path


def read_measured(page: Path, heading: str) -> dict[str, dict[str, str]]:
    """Rows of the first table after a heading: by their first cell, and in a row by column.

    Raises
    ------
    ValueError
        If there is no such heading, or no table after it.
    """
    lines = page.read_text(encoding="utf-8").splitlines()
    after = lines[lines.index(heading) :]
    table = takewhile(_is_row, dropwhile(lambda line: not _is_row(line), after))
    (_, *columns), _, *rows = ([cell.strip() for cell in line.strip("|").split("|")] for line in table)
    return {name: dict(zip(columns, cells, strict=True)) for name, *cells in rows}


def _is_row(line: str) -> bool:
    return line.startswith("|")
