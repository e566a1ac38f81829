"""``plumbline fit-many``: its options."""

from __future__ import annotations

from typing import Annotated

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
