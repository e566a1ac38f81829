"""What a caller may ask of a batch, and what is answered: query parameters in, columns out.

A batch takes its columns in the body and everything else in the query, whatever the body's format. The
parameters are those of a single series, of the same annotated types.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from service.schemas.answers import Answer, NoFitReason, RowReason, WireTime
from service.schemas.options import FitQuery

BatchFormat = Literal["json", "csv", "arrow", "parquet", "ndjson", "geojson"]
ColumnName = Annotated[str, Field(max_length=1_000)]


class BatchRequest(BaseModel):
    """Many series in long form: one entry per row, rows of a series in any order and anywhere.

    This class documents the body; its columns are decoded straight into arrays by the JSON codec.
    """

    model_config = ConfigDict(extra="forbid")

    series: Annotated[
        list[str] | list[int],
        Field(min_length=1, description="Whose row it is: text or integers, without a mixture."),
    ]
    time: Annotated[
        list[int | float | str | None],
        Field(
            min_length=1,
            description="Numbers, epoch numbers (say their unit in `time_unit`; integers stay exact), or "
            "ISO 8601 with an offset or Z. ISO 8601 without an offset is taken as UTC. Any order.",
        ),
    ]
    value: Annotated[list[float | None], Field(min_length=1, description="Null where it is missing.")]
    weight: Annotated[
        list[float] | None,
        Field(description="Precision (1/variance up to scale) per value, not negative; 0 leaves a row out."),
    ] = None
    lat: Annotated[
        list[float | None] | None,
        Field(description="Degrees north. A series stands where its first row with a position does."),
    ] = None
    lon: Annotated[list[float | None] | None, Field(description="Degrees east.")] = None


class BatchQuery(FitQuery):
    """Query parameters of ``POST /v1/trends/batch``."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Annotated[
        BatchFormat | None, Field(description="Format of the answer; takes precedence over `Accept`.")
    ] = None
    points: Annotated[bool, Field(description="Whether the answer labels every row of every series.")] = False
    series_column: Annotated[
        ColumnName | None, Field(description="Tables: column of the names (default `series`).")
    ] = None
    time_column: Annotated[
        ColumnName | None, Field(description="Tables: column of the times (default `time`).")
    ] = None
    value_column: Annotated[
        ColumnName | None, Field(description="Tables: column of the values (default `value`).")
    ] = None
    weight_column: Annotated[
        ColumnName | None, Field(description="Tables: column of the weights (default `weight`, if any).")
    ] = None
    lat_column: Annotated[
        ColumnName | None, Field(description="Tables: column of the latitudes (default `lat`, if any).")
    ] = None
    lon_column: Annotated[
        ColumnName | None, Field(description="Tables: column of the longitudes (default `lon`, if any).")
    ] = None

    def columns(self) -> dict[str, str | None]:
        """Columns by role; None where the caller names none."""
        return {
            "series": self.series_column,
            "time": self.time_column,
            "value": self.value_column,
            "weight": self.weight_column,
            "lat": self.lat_column,
            "lon": self.lon_column,
        }


Numbers = list[float | None]


class BatchColumns(BaseModel):
    """One entry per series; columns of the model's parameters stand beside these.

    A parameter has four columns: ``slope``, ``slope_stderr``, ``slope_low``, ``slope_high``. Each value to
    reach has columns too: ``crossing_1_value``, ``_direction``, ``_status``, ``_time``, ``_low``, ``_high``,
    and with a horizon ``_probability`` and ``_reading_probability``. What a series does not have is null.
    """

    model_config = ConfigDict(extra="allow", strict=True, frozen=True)
    __pydantic_extra__: dict[str, Numbers | list[WireTime]]

    series: Annotated[list[str] | list[int], Field(description="In the order in which they first appear.")]
    fitted: list[bool]
    reason: Annotated[
        list[NoFitReason | Literal["invalid_input"] | None],
        Field(
            description="Why a series has no trend; `invalid_input` where it would be refused if sent alone."
        ),
    ]
    message: list[str | None]
    model: Annotated[list[str | None], Field(description="Shape of the trend; with `auto` the one chosen.")]
    noise: Annotated[
        list[Literal["multiplicative", "additive"] | None] | None,
        Field(description="Where an exponential may come: how its readings scatter."),
    ] = None
    regimes: Annotated[
        list[int] | None, Field(description="With `regime=last`: regimes found, the present one among them.")
    ] = None
    regime_start: Annotated[
        list[WireTime] | None, Field(description="With `regime=last`: first time of the present one.")
    ] = None
    origin: Annotated[list[WireTime], Field(description="Where the intercept is taken.")]
    n: Annotated[list[int], Field(description="Rows that took part.")]
    inliers: list[int]
    inlier_ratio: Numbers
    threshold: Annotated[Numbers, Field(description="Largest distance of an inlier.")]
    sigma: Annotated[Numbers, Field(description="Noise scale of an inlier.")]
    p_value: Annotated[Numbers, Field(description='Of "the slope is zero", valid after selection.')]
    r2: Numbers
    rmse: Numbers
    effective_n: Numbers
    lag1: Numbers
    dof: Numbers
    notices: Annotated[list[list[str]], Field(description="Codes of typed warnings.")]
    lat: Numbers | None = None
    lon: Numbers | None = None
    point_row: Annotated[
        list[list[int]] | None, Field(description="With `points=true`: rows of the table, counted from 0.")
    ] = None
    point_time: Annotated[list[list[WireTime]] | None, Field(description="In the form they came.")] = None
    point_inlier: list[list[bool]] | None = None
    point_probability: list[Numbers] | None = None
    point_residual: list[Numbers] | None = None
    point_reason: list[list[RowReason]] | None = None


class BatchAnswer(Answer):
    """Robust trends of many series, as columns."""

    model: str
    method: str
    level: float
    seed: int
    time_unit: Annotated[
        Literal["second"] | None, Field(description="Unit of time of the parameters; null for plain numbers.")
    ]
    columns: BatchColumns
