"""A trend's report in a terminal: the words of :mod:`estimators.trends.presentation.report`, set by rich."""

from __future__ import annotations

from collections.abc import Iterable

from rich import box
from rich.console import Console
from rich.padding import Padding
from rich.rule import Rule
from rich.table import Table
from rich.text import Text

from estimators.trends.presentation.layout import estimate_rows, outlier_titles, prediction_titles
from estimators.trends.presentation.report import Report


def show_report(console: Console, report: Report) -> None:
    """Print a report.

    Parameters
    ----------
    console : rich.console.Console
    report : Report
    """
    console.print(Rule(Text(report.title, style="bold"), align="left", style="dim"))
    console.print(Padding(Text(report.equation, style="bold cyan"), (0, 0, 1, 2)))
    titles, *rows = estimate_rows(report)
    console.print(_table(titles, rows))
    console.print(_facts(report.facts))
    if report.outliers:
        console.print(_table(outlier_titles(report), report.outliers), "")
    if report.predictions:
        console.print(_table(prediction_titles(report), report.predictions), "")
    for message, advice in report.notices:
        console.print(Text.assemble(("! ", "bold yellow"), message, " ", (advice, "dim")))


def _table(titles: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, header_style="dim")
    for place, title in enumerate(titles):
        table.add_column(Text(title), justify="left" if place == 0 else "right", overflow="fold")
    for row in rows:
        table.add_row(*map(Text, row))
    return table


def _facts(facts: Iterable[tuple[str, str]]) -> Padding:
    grid = Table.grid(padding=(0, 2))
    grid.add_column(style="dim", no_wrap=True)
    grid.add_column(overflow="fold")
    for label, sentence in facts:
        grid.add_row(label, Text(sentence))
    return Padding(grid, (1, 0))
