"""Where the commands write: answers to standard output, everything else to standard error."""

from __future__ import annotations

import io
import sys
from typing import NoReturn

import typer
from rich.console import Console
from rich.text import Text

NO_TREND = 1
BAD_INPUT = 2


def answers() -> Console:
    """Console of standard output; made anew, since tests and pipes replace the stream."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        # A terminal that knows no σ or ─ shows a question mark in its place.
        sys.stdout.reconfigure(errors="replace")
    return Console(highlight=False)


def messages() -> Console:
    """Console of standard error."""
    return Console(stderr=True, highlight=False)


def remark(sentence: str) -> None:
    """Tell something in passing."""
    messages().print(Text(sentence, style="dim"), soft_wrap=True)


def fail(sentence: str, code: int = BAD_INPUT) -> NoReturn:
    """End the command with one sentence on standard error.

    Parameters
    ----------
    sentence : str
        What is wrong and how to mend it.
    code : int
        Exit code (default 2, bad input).
    """
    messages().print(Text.assemble(("plumbline: ", "bold red"), sentence), soft_wrap=True)
    raise typer.Exit(code)
