"""Options that several commands share, one annotated type each.

Nothing here may import more than typer: the signatures are read for every ``--help``.
"""

from __future__ import annotations

from typing import Annotated, Literal

import typer

TimeUnit = Annotated[
    Literal["s", "ms", "us", "ns"] | None, typer.Option(help="Unit of times that are numbers since 1970.")
]
Weight = Annotated[
    str | None,
    typer.Option(metavar="COL", help="Column of precisions (1/variance). Default: 'weight', if any."),
]
Model = Annotated[str, typer.Option(help="Shape of the trend; see 'plumbline models'.")]
Method = Annotated[str, typer.Option(help="How it is found; see 'plumbline methods'.")]
Threshold = Annotated[
    float | None, typer.Option(help="Largest distance of an inlier from the trend. Default: estimated.")
]
Sigma = Annotated[float | None, typer.Option(help="Noise scale of an inlier. Default: estimated.")]
Level = Annotated[float, typer.Option(help="Confidence level of intervals and bands.")]
Seed = Annotated[int, typer.Option(help="Seed of the search.")]
Uncertainty = Annotated[
    Literal["effective-n", "hac", "bootstrap", "permutation"],
    typer.Option(help="How intervals and p-value are made; bootstrap and permutation fit again."),
]
Resamples = Annotated[
    int | None, typer.Option(help="How often bootstrap and permutation fit again. Default: 400.")
]
Noise = Annotated[
    Literal["auto", "multiplicative", "additive"],
    typer.Option(help="Noise of an exponential. Default: told from the data."),
]
Degree = Annotated[int | None, typer.Option(help="Degree of the polynomial of the model linear. Default: 1.")]
Seasonal = Annotated[
    list[str] | None,
    typer.Option(
        metavar="P",
        help="Period of a season: a number in the unit of time (seconds for dates), hour, day, week, "
        "month, year, or auto; may be repeated.",
    ),
]
Harmonics = Annotated[
    int | None, typer.Option(help="Harmonics per season. Default: as many as the data support.")
]
Regime = Annotated[
    Literal["all", "last"],
    typer.Option(help="Fit the whole series, or since it last left its line for good."),
]
Reach = Annotated[
    list[float] | None, typer.Option(metavar="V", help="Value to reach: when? May be repeated.")
]
Horizon = Annotated[
    str | None, typer.Option(metavar="T", help="Time by which --reach is wanted: how likely?")
]
