"""``plumbline clean``: its options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from service.cli.options import TimeUnit


def clean(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...",
            help="Tracks (GPX, KML, GeoJSON, FIT, NMEA, CSV, Parquet, Arrow), told by content; - for stdin.",
        ),
    ],
    to: Annotated[
        Literal["text", "json", "geojson", "gpx", "csv", "arrow", "parquet"] | None,
        typer.Option(help="What to write. Default: by the ending of --output, or text."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="OUT", help="Where to. Default: standard output.", dir_okay=False
        ),
    ] = None,
    method: Annotated[str, typer.Option(help="How faulty fixes are found.")] = "auto",
    level: Annotated[float, typer.Option(help="Confidence level of intervals.")] = 0.95,
    sigma_m: Annotated[
        float | None,
        typer.Option(
            "--sigma-m", metavar="M", help="Standard deviation of a good fix, per axis. Default: estimated."
        ),
    ] = None,
    max_speed_mps: Annotated[
        float | None,
        typer.Option(
            "--max-speed-mps", metavar="MPS", help="What moves faster is a fault. Default: no limit."
        ),
    ] = None,
    device: Annotated[
        str | None,
        typer.Option(metavar="COL", help="Tables: column of the devices. Default: told by the usual names."),
    ] = None,
    time: Annotated[str | None, typer.Option(metavar="COL", help="Tables: column of the times.")] = None,
    lat: Annotated[str | None, typer.Option(metavar="COL", help="Tables: column of the latitudes.")] = None,
    lon: Annotated[str | None, typer.Option(metavar="COL", help="Tables: column of the longitudes.")] = None,
    height: Annotated[str | None, typer.Option(metavar="COL", help="Tables: column of the heights.")] = None,
    accuracy: Annotated[
        str | None, typer.Option(metavar="COL", help="Tables: column of the accuracies (68 % radii).")
    ] = None,
    speed: Annotated[
        str | None, typer.Option(metavar="COL", help="Tables: column of the speeds over ground, m/s.")
    ] = None,
    bearing: Annotated[
        str | None,
        typer.Option(metavar="COL", help="Tables: column of the courses, degrees clockwise from north."),
    ] = None,
    time_unit: TimeUnit = None,
    plot: Annotated[
        Path | None,
        typer.Option(metavar="PATH", help="Write a picture of the track (.png or .svg).", dir_okay=False),
    ] = None,
    figure: Annotated[
        Literal["map", "error"],
        typer.Option(help="--plot: a map, or how far each fix is off over time."),
    ] = "map",
    theme: Annotated[Literal["light", "dark"], typer.Option(help="--plot: its colours.")] = "light",
    points: Annotated[
        bool, typer.Option("--points", help="geojson: a point per fix with its label, instead of lines.")
    ] = False,
) -> None:
    """Clean GPS tracks: a label per fix, and where they really went."""
    from service.cli.cleaning import CleanRequest, run_clean

    run_clean(
        CleanRequest(
            files=tuple(files),
            columns={
                "time": time,
                "lat": lat,
                "lon": lon,
                "device": device,
                "height_m": height,
                "accuracy_m": accuracy,
                "speed_mps": speed,
                "bearing_deg": bearing,
            },
            arguments={
                "method": method,
                "level": level,
                "sigma_m": sigma_m,
                "max_speed_mps": max_speed_mps,
                "time_unit": time_unit,
            },
            points=points,
            plot=plot,
            figure=figure,
            theme=theme,
            to=to,
            output=output,
        )
    )
