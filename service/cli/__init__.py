"""The command ``plumbline``: fit a file or many series, locate, serve over HTTP, list methods and models.

Only the signatures are here; each command's work is in a module of its own and is imported when it runs,
so that ``--help`` answers at once. Exit codes: 0 done, 1 the data determine no trend, 2 bad input.
"""

# The imports inside of the commands are the point of this module.
# ruff: noqa: PLC0415

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from service.cli.options import (
    Degree,
    Harmonics,
    Horizon,
    Level,
    Method,
    Model,
    Noise,
    Reach,
    Regime,
    Resamples,
    Seasonal,
    Seed,
    Sigma,
    Threshold,
    TimeUnit,
    Uncertainty,
    Weight,
)

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
        from importlib.metadata import version

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


@app.command()
def fit(
    file: Annotated[
        str, typer.Argument(metavar="FILE", help="Table of times and values; - for standard input.")
    ],
    time: Annotated[
        str | None,
        typer.Option(metavar="COL", help="Column of times, by name or position. Default: guessed."),
    ] = None,
    value: Annotated[
        str | None,
        typer.Option(metavar="COL", help="Column of values, by name or position. Default: guessed."),
    ] = None,
    weight: Weight = None,
    column: Annotated[
        list[str] | None,
        typer.Option(
            metavar="COL", help="Column to fit along with the model linear, by name or position; repeat it."
        ),
    ] = None,
    delimiter: Annotated[
        str | None,
        typer.Option(metavar="CHAR", help="What separates cells, or the word tab. Default: found out."),
    ] = None,
    time_unit: TimeUnit = None,
    since: Annotated[str | None, typer.Option(metavar="T", help="Leave out rows before this time.")] = None,
    until: Annotated[str | None, typer.Option(metavar="T", help="Leave out rows after this time.")] = None,
    model: Model = "line",
    method: Method = "auto",
    threshold: Threshold = None,
    sigma: Sigma = None,
    level: Level = 0.95,
    seed: Seed = 0,
    uncertainty: Uncertainty = "effective-n",
    resamples: Resamples = None,
    noise: Noise = "auto",
    degree: Degree = None,
    seasonal: Seasonal = None,
    harmonics: Harmonics = None,
    regime: Regime = "all",
    reach: Reach = None,
    horizon: Horizon = None,
    predict: Annotated[
        list[str] | None, typer.Option(metavar="T", help="Time at which to predict; may be repeated.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="PATH", help="Write a picture (.png or .svg).", dir_okay=False)
    ] = None,
    theme: Annotated[Literal["light", "dark"], typer.Option(help="Colours of the picture.")] = "light",
    json: Annotated[
        bool, typer.Option("--json", help="Print the answer as JSON, as the service sends it.")
    ] = False,
    csv: Annotated[bool, typer.Option("--csv", help="Print one CSV row per input row.")] = False,
) -> None:
    """Fit a trend to a table (CSV and its relatives) and say how sure it is."""
    from service.cli.fitting import FitRequest, run_fit

    run_fit(
        FitRequest(
            file=file,
            time=time,
            value=value,
            weight=weight,
            column=tuple(column or ()),
            delimiter=delimiter,
            time_unit=time_unit,
            since=since,
            until=until,
            model=model,
            method=method,
            threshold=threshold,
            sigma=sigma,
            level=level,
            seed=seed,
            noise=noise,
            uncertainty=uncertainty,
            resamples=resamples,
            degree=degree,
            seasonal=tuple(seasonal or ()),
            harmonics=harmonics,
            regime=regime,
            reach=tuple(reach or ()),
            horizon=horizon,
            predict=tuple(predict or ()),
            plot=plot,
            theme=theme,
            output="json" if json else "csv" if csv else "text",
        ),
        one_format=not (json and csv),
    )


@app.command(name="fit-many")
def fit_many(
    file: Annotated[
        str,
        typer.Argument(
            metavar="IN", help="Long table: CSV, Parquet, Arrow or JSON, told by its content; - for stdin."
        ),
    ],
    output: Annotated[
        str,
        typer.Option(
            "--output",
            "-o",
            metavar="OUT",
            help="Where to: .csv, .parquet, .arrow, .arrows, .json, .ndjson, .geojson; - for CSV to stdout.",
        ),
    ],
    by: Annotated[str, typer.Option(metavar="COL", help="Column that says whose row it is.")],
    time: Annotated[str | None, typer.Option(metavar="COL", help="Column of times. Default: 'time'.")] = None,
    value: Annotated[
        str | None, typer.Option(metavar="COL", help="Column of values. Default: 'value'.")
    ] = None,
    weight: Weight = None,
    lat: Annotated[
        str | None, typer.Option(metavar="COL", help="Column of latitudes. Default: 'lat', if any.")
    ] = None,
    lon: Annotated[
        str | None, typer.Option(metavar="COL", help="Column of longitudes. Default: 'lon', if any.")
    ] = None,
    delimiter: Annotated[
        str | None,
        typer.Option(metavar="CHAR", help="CSV: what separates cells, or the word tab. Default: found out."),
    ] = None,
    time_unit: TimeUnit = None,
    model: Model = "line",
    method: Method = "auto",
    threshold: Threshold = None,
    sigma: Sigma = None,
    level: Level = 0.95,
    seed: Seed = 0,
    uncertainty: Uncertainty = "effective-n",
    resamples: Resamples = None,
    noise: Noise = "auto",
    degree: Degree = None,
    seasonal: Seasonal = None,
    harmonics: Harmonics = None,
    regime: Regime = "all",
    reach: Reach = None,
    horizon: Horizon = None,
    points: Annotated[bool, typer.Option("--points", help="Label every row of every series.")] = False,
) -> None:
    """Fit a trend to every series of a long table and write a row for each."""
    from service.cli.fitting_many import FitManyRequest, run_fit_many

    run_fit_many(
        FitManyRequest(
            file=file,
            output=output,
            by=by,
            time=time,
            value=value,
            weight=weight,
            lat=lat,
            lon=lon,
            delimiter=delimiter,
            time_unit=time_unit,
            model=model,
            method=method,
            threshold=threshold,
            sigma=sigma,
            level=level,
            seed=seed,
            noise=noise,
            uncertainty=uncertainty,
            resamples=resamples,
            degree=degree,
            seasonal=tuple(seasonal or ()),
            harmonics=harmonics,
            regime=regime,
            reach=tuple(reach or ()),
            horizon=horizon,
            points=points,
        )
    )


@app.command()
def locate(
    file: Annotated[
        str,
        typer.Argument(
            metavar="FILE", help="CSV of pseudoranges, RINEX or GnssLogger, told by content; - for stdin."
        ),
    ],
    nav: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="RINEX navigation file, for RINEX and logs; may be repeated."),
    ] = None,
    rotated: Annotated[
        bool | None,
        typer.Option(
            "--rotated/--not-rotated",
            help="CSV: whether satellite positions are turned for the Earth's rotation. Never guessed.",
        ),
    ] = None,
    method: Annotated[str, typer.Option(help="How faults are found.")] = "auto",
    motion: Annotated[
        Literal["auto", "static", "moving", "independent"] | None,
        typer.Option(help="Of many epochs: how the receiver moves. Default: told from the data."),
    ] = None,
    time_unit: TimeUnit = None,
    mask: Annotated[
        float | None, typer.Option(metavar="DEG", help="Leave out satellites below this elevation.")
    ] = None,
    output_format: Annotated[
        Literal["text", "json", "csv", "geojson", "svg", "png"],
        typer.Option("--format", help="What to write; svg and png show the sky of one epoch."),
    ] = "text",
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="OUT", help="Where to. Default: standard output.", dir_okay=False
        ),
    ] = None,
) -> None:
    """Find positions from pseudoranges, and the satellites that lie."""
    from service.cli.locating import LocateRequest, run_locate

    run_locate(
        LocateRequest(
            file=file,
            nav=tuple(nav or ()),
            rotated=rotated,
            method=method,
            motion=motion,
            time_unit=time_unit,
            mask=mask,
            output_format=output_format,
            output=output,
        )
    )


@app.command()
def serve(
    host: Annotated[
        str | None, typer.Option(help="Address to listen on. Default: PLUMBLINE_HOST, else 127.0.0.1.")
    ] = None,
    port: Annotated[
        int | None, typer.Option(min=0, max=65535, help="Port. Default: PLUMBLINE_PORT, else 8000.")
    ] = None,
) -> None:
    """Serve fits over HTTP; settings come from PLUMBLINE_* variables."""
    import gc

    # What is imported stays: looking for garbage in it meanwhile takes a fifth of the start.
    gc.disable()
    try:
        from service.cli.postponing import postpone_imports

        postpone_imports()
        from service.cli.serving import run_server

        run_server(host, port)
    finally:
        gc.enable()


@app.command()
def warm() -> None:
    """Compile the kernels now, so that no first request waits for them."""
    from service.cli.warming import warm_kernels

    warm_kernels()


@app.command()
def methods() -> None:
    """List the methods and when to use each."""
    from service.cli.catalogue import show_methods

    show_methods()


@app.command()
def models() -> None:
    """List the shapes of trends."""
    from service.cli.catalogue import show_models

    show_models()
