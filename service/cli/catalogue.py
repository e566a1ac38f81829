"""``plumbline methods`` and ``plumbline models``: the registries as tables."""

from __future__ import annotations

from rich import box
from rich.table import Table
from rich.text import Text

import estimators
from service.cli.streams import answers


def show_methods() -> None:
    """Print every method with what it does and when to use it."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 1, 0), show_header=False)
    table.add_column(style="bold cyan", no_wrap=True)
    table.add_column()
    for row in estimators.methods().values():
        text = Text.assemble((row.title, "bold"), "\n", row.summary, "\n", ("When: ", "dim"), row.when_to_use)
        if not row.robust:
            text.append("\nNot robust: outliers can move it.", style="yellow")
        text.append(f"\nSource: {row.source}", style="dim")
        table.add_row(Text(row.name), text)
    answers().print(table)


def show_models() -> None:
    """Print every model with its equation and parameters."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, header_style="dim")
    table.add_column("model", style="bold cyan", no_wrap=True)
    table.add_column("equation", no_wrap=True)
    table.add_column("parameters")
    table.add_column("what it is", ratio=1)
    for row in estimators.models().values():
        what = Text.assemble((row.title, "bold"), "\n", row.summary)
        table.add_row(Text(row.name), Text(row.equation), Text(", ".join(row.parameters)), what)
    answers().print(table)
