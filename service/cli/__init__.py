"""The command ``plumbline``: fit series, locate, clean tracks, serve over HTTP, list methods and models.

The signatures are in :mod:`service.cli.commands`; each command's work is in a module of its own and is
imported when it runs, so that ``--help`` answers at once. Exit codes: 0 done, 1 the data determine no trend,
position or track, 2 bad input.
"""

from __future__ import annotations

from typing import Annotated

import typer

from service.cli.commands.catalogue import methods, models
from service.cli.commands.clean import clean
from service.cli.commands.fit import fit
from service.cli.commands.fit_many import fit_many
from service.cli.commands.locate import locate
from service.cli.commands.serve import serve, warm

__all__ = ["app"]

app = typer.Typer(
    name="plumbline",
    help="Robust trends from contaminated measurements.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version  # noqa: PLC0415

        typer.echo(f"plumbline {version('plumbline')}")
        raise typer.Exit


@app.callback()
def plumbline(
    _version: Annotated[
        bool,
        typer.Option("--version", help="Show the version and exit.", is_eager=True, callback=_print_version),
    ] = False,
) -> None:
    """Robust trends from contaminated measurements."""


app.command()(fit)
app.command(name="fit-many")(fit_many)
app.command()(locate)
app.command()(clean)
app.command()(serve)
app.command()(warm)
app.command()(methods)
app.command()(models)
