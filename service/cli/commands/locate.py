"""``plumbline locate``: its options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from service.cli.options import TimeUnit


def locate(
    file: Annotated[
        str,
        typer.Argument(
            metavar="FILE",
            help="Table of pseudoranges (CSV, Arrow, Parquet), RINEX or GnssLogger, told by content; - for "
            "stdin.",
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
            help="Tables: whether satellite positions are turned for the Earth's rotation. Never guessed.",
        ),
    ] = None,
    raw: Annotated[
        bool, typer.Option("--raw", help="Tables: pseudoranges are as measured and corrected here.")
    ] = False,
    klobuchar_alpha: Annotated[
        str | None, typer.Option(metavar="A,A,A,A", help="--raw: coefficients of the ionosphere.")
    ] = None,
    klobuchar_beta: Annotated[
        str | None, typer.Option(metavar="B,B,B,B", help="--raw: coefficients of the ionosphere.")
    ] = None,
    no_troposphere: Annotated[
        bool, typer.Option("--no-troposphere", help="--raw: leave the troposphere as it is.")
    ] = False,
    weights: Annotated[
        Literal["elevation", "strength"] | None,
        typer.Option(help="--raw and files: noise by elevation, or by signal strength."),
    ] = None,
    systems: Annotated[
        str | None, typer.Option(metavar="LETTERS", help="Files: systems to use, such as G,E. Default: all.")
    ] = None,
    ionosphere: Annotated[
        Literal["auto", "broadcast", "dual", "none"] | None,
        typer.Option(help="Files: how its delay is removed; dual takes two codes."),
    ] = None,
    method: Annotated[str, typer.Option(help="How faults are found.")] = "auto",
    motion: Annotated[
        Literal["auto", "static", "moving", "independent"] | None,
        typer.Option(help="Of many epochs: how the receiver moves. Default: told from the data."),
    ] = None,
    window_s: Annotated[
        float | None, typer.Option("--window-s", metavar="S", help="If moving: seconds that answer an epoch.")
    ] = None,
    causal: Annotated[
        bool, typer.Option("--causal", help="Answer an epoch by itself and earlier ones only.")
    ] = False,
    surroundings: Annotated[
        Literal["auto", "open", "city"] | None,
        typer.Option(help="If moving: whether reflections lengthen ranges. Default: told from the data."),
    ] = None,
    time_unit: TimeUnit = None,
    mask: Annotated[
        float | None, typer.Option(metavar="DEG", help="Leave out satellites below this elevation.")
    ] = None,
    option: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Setting such as alert_m=50; may be repeated."),
    ] = None,
    output_format: Annotated[
        Literal["text", "json", "csv", "arrow", "parquet", "geojson", "svg", "png"],
        typer.Option("--format", help="What to write."),
    ] = "text",
    rows: Annotated[
        Literal["satellites", "epochs"],
        typer.Option(help="csv, arrow, parquet: a row per satellite and epoch, or per epoch."),
    ] = "satellites",
    figure: Annotated[
        Literal["sky", "residuals", "stanford"],
        typer.Option(help="svg, png: sky and residuals show one epoch, stanford needs --truth."),
    ] = "sky",
    truth: Annotated[
        str | None,
        typer.Option(metavar="LAT,LON,HEIGHT", help="stanford: where a standing receiver really is."),
    ] = None,
    theme: Annotated[Literal["light", "dark"], typer.Option(help="Colours of a picture.")] = "light",
    width_px: Annotated[int, typer.Option("--width-px", metavar="PX", help="Width of a picture.")] = 600,
    height_px: Annotated[int, typer.Option("--height-px", metavar="PX", help="Height of a picture.")] = 600,
    title: Annotated[str | None, typer.Option(help="Title of a picture.")] = None,
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
            arguments={
                "rotated": rotated,
                "raw": raw or None,
                "klobuchar_alpha": None if klobuchar_alpha is None else [klobuchar_alpha],
                "klobuchar_beta": None if klobuchar_beta is None else [klobuchar_beta],
                "troposphere": False if no_troposphere else None,
                "weights": weights,
                "systems": None if systems is None else [systems],
                "ionosphere": ionosphere,
                "method": method,
                "motion": motion,
                "window_s": window_s,
                "causal": causal or None,
                "surroundings": surroundings,
                "time_unit": time_unit,
                "options.elevation_mask_deg": mask,
            },
            options=tuple(option or ()),
            truth=None if truth is None else tuple(truth.split(",")),
            answer={
                "rows": rows,
                "figure": figure,
                "theme": theme,
                "width_px": width_px,
                "height_px": height_px,
                "title": title,
            },
            output_format=output_format,
            output=output,
        )
    )
