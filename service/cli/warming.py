"""Compile the kernels, or load them from the cache, and show how far it has come."""

from __future__ import annotations

import time

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

import estimators  # noqa: F401  # declares every kernel
from estimators import kernels
from service.cli.streams import messages
from service.observability.logs import make_logger
from service.settings import Settings
from service.warmth import load_usual


def compile_missing(settings: Settings) -> None:
    """Compile all kernels if the usual fit finds some missing in the cache; quick and silent if it does not.

    Parameters
    ----------
    settings : Settings
        Where lines of the log are JSON, progress is told in such lines.
    """
    log = make_logger(settings)
    for_people = settings.log_format == "console"

    def tell() -> None:
        if for_people:
            messages().print("Compiling for the first time; this takes a minute or two.", soft_wrap=True)
        else:
            log.info("compiling")

    if not load_usual(tell):
        return
    if for_people:
        warm_kernels()
        return
    for done, total, name in kernels.warm():
        log.info("kernel loaded", kernel=name, done=done, total=total)


def warm_kernels() -> None:
    """Load every kernel; a bar on standard error if it is a terminal, plain lines if not."""
    console = messages()
    started = time.perf_counter()
    done = 0
    if console.is_terminal:
        columns = (TextColumn("Compiling"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
        with Progress(*columns, console=console, transient=True) as progress:
            task = progress.add_task("kernels", total=None)
            for done, total, _ in kernels.warm():
                progress.update(task, completed=done, total=total)
    else:
        for done, total, name in kernels.warm():
            console.print(f"Loaded {done} of {total}: {name}", markup=False, soft_wrap=True)
    console.print(f"{done} kernels ready in {time.perf_counter() - started:.1f} s.", markup=False)
