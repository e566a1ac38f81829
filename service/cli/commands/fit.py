"""``plumbline fit``: its options."""

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
