"""What a caller may ask of trajectories; the answers are in :mod:`service.schemas.tracks`."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

import estimators
from service.schemas.fields import Level, Theme, TimeUnit, one_of

TrackFormat = Literal["json", "geojson", "gpx", "csv", "arrow", "parquet", "svg", "png"]
Figure = Literal["map", "error"]

METHODS = tuple(estimators.track_methods())


Method = Annotated[
    str,
    one_of(METHODS),
    Field(
        description="How faulty fixes are found; `/v1/trajectory-methods` describes each.",
        json_schema_extra={"enum": list(METHODS)},
    ),
]
Sigma = Annotated[
    float,
    Field(
        ge=1e-3,
        le=1e4,
        allow_inf_nan=False,
        description="Standard deviation of a good fix, per axis, metres. Default: estimated.",
    ),
]
MaxSpeed = Annotated[
    float,
    Field(
        gt=0,
        le=1e6,
        allow_inf_nan=False,
        description="What moves faster is a fault, m/s. Default: no limit; 50 for the method `speed-gate`.",
    ),
]
Unit = Annotated[
    TimeUnit,
    Field(
        description="Unit of times that are numbers since 1970. Default: units finer than the second are "
        "told by the size of the numbers; other numbers are seconds since any zero."
    ),
]
ColumnName = Annotated[str, Field(max_length=1_000)]


class TrackArguments(BaseModel):
    """Keys of a JSON body beside its columns, and the arguments of files."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    method: Method = "auto"
    level: Level = 0.95
    sigma_m: Sigma | None = None
    max_speed_mps: MaxSpeed | None = None
    time_unit: Unit | None = None


class TrackRequest(TrackArguments):
    """Fixes of one receiver, or of many with `device`. One entry per fix, in any order; null is missing.

    This class documents the body; its columns are decoded straight into arrays by the JSON codec.
    """

    time: Annotated[
        list[int | float | str | None],
        Field(
            min_length=1,
            description="Seconds, numbers since 1970, or ISO 8601 with an offset or Z, which is kept. ISO "
            "8601 without an offset is taken as UTC.",
        ),
    ]
    lat: Annotated[list[float | None], Field(min_length=1, description="Degrees north, WGS 84.")]
    lon: Annotated[list[float | None], Field(min_length=1, description="Degrees east, -180 to 360.")]
    device: Annotated[
        list[str | int | None] | None,
        Field(description="Whose fix it is; with it the answer has a track for each device."),
    ] = None
    height: Annotated[list[float | None] | None, Field(description="Metres.")] = None
    accuracy: Annotated[
        list[float | None] | None,
        Field(description="Radius about each fix that holds 68 % as the receiver reports it, metres."),
    ] = None
    semi_major: Annotated[
        list[float | None] | None,
        Field(
            description="Instead of `accuracy`, an error ellipse: standard deviation along its longer axis, "
            "metres. It is taken as the circle of the same mean square."
        ),
    ] = None
    semi_minor: Annotated[
        list[float | None] | None, Field(description="Standard deviation along its shorter axis, metres.")
    ] = None
    orientation: Annotated[
        list[float | None] | None,
        Field(description="Of the longer axis, degrees clockwise from north. Taken, and not used."),
    ] = None
    speed: Annotated[
        list[float | None] | None, Field(description="Over ground, as the receiver measures it, m/s.")
    ] = None
    bearing: Annotated[
        list[float | None] | None,
        Field(description="Course over ground, degrees clockwise from north; counts beside `speed`."),
    ] = None


#: Parameters that name a column of a table, by what it is to the readers of files.
COLUMN_PARAMETERS = {
    "time": "time_column",
    "lat": "lat_column",
    "lon": "lon_column",
    "device": "device_column",
    "height_m": "height_column",
    "accuracy_m": "accuracy_column",
    "ellipse_major_m": "semi_major_column",
    "ellipse_minor_m": "semi_minor_column",
    "ellipse_bearing_deg": "orientation_column",
    "speed_mps": "speed_column",
    "bearing_deg": "bearing_column",
}


class TrackAnswerQuery(BaseModel):
    """Query parameters that shape the answer, whatever the body's media type."""

    format: Annotated[
        TrackFormat | None, Field(description="Format of the answer; takes precedence over `Accept`.")
    ] = None
    points: Annotated[
        bool | None,
        Field(
            description="JSON: whether the answer has the columns per fix (default true). GeoJSON: whether "
            "it has a point per fix with its label instead of lines (default false)."
        ),
    ] = None
    figure: Annotated[
        Figure,
        Field(
            description="Which picture: a map of the track, or how far each fix is off over time. Either "
            "shows one track."
        ),
    ] = "map"
    width_px: Annotated[int, Field(ge=200, le=4000, description="Width of a picture.")] = 800
    height_px: Annotated[int, Field(ge=150, le=4000, description="Height of a picture.")] = 600
    theme: Annotated[Theme, Field(description="Colours of a picture.")] = "light"
    title: Annotated[
        str | None, Field(max_length=120, pattern=r"^[^\x00-\x1f\x7f]*$", description="Title of a picture.")
    ] = None


class TrackQuery(TrackAnswerQuery):
    """Query parameters of ``POST /v1/trajectories``; JSON bodies carry the arguments themselves."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    method: Method | None = None
    level: Level | None = None
    sigma_m: Sigma | None = None
    max_speed_mps: MaxSpeed | None = None
    time_unit: Unit | None = None
    time_column: Annotated[
        ColumnName | None, Field(description="Tables: column of the times. Default: told by the usual names.")
    ] = None
    lat_column: Annotated[ColumnName | None, Field(description="Tables: column of the latitudes.")] = None
    lon_column: Annotated[ColumnName | None, Field(description="Tables: column of the longitudes.")] = None
    device_column: Annotated[ColumnName | None, Field(description="Tables: column of the devices.")] = None
    height_column: Annotated[ColumnName | None, Field(description="Tables: column of the heights.")] = None
    accuracy_column: Annotated[ColumnName | None, Field(description="Tables: column of the accuracies.")] = (
        None
    )
    semi_major_column: Annotated[
        ColumnName | None, Field(description="Tables: column of the longer axes of error ellipses.")
    ] = None
    semi_minor_column: Annotated[
        ColumnName | None, Field(description="Tables: column of the shorter axes.")
    ] = None
    orientation_column: Annotated[
        ColumnName | None, Field(description="Tables: column of the ellipses' orientations.")
    ] = None
    speed_column: Annotated[ColumnName | None, Field(description="Tables: column of the speeds, m/s.")] = None
    bearing_column: Annotated[ColumnName | None, Field(description="Tables: column of the courses.")] = None

    def arguments(self) -> dict[str, Any]:
        """Arguments that were given, as in a JSON body."""
        given = self.model_dump(include=set(TrackArguments.model_fields))
        return {name: value for name, value in given.items() if value is not None}

    def columns(self) -> dict[str, str]:
        """Columns of a table that were named, by what they are to the readers of files."""
        named = {role: getattr(self, parameter) for role, parameter in COLUMN_PARAMETERS.items()}
        return {role: name for role, name in named.items() if name is not None}

    def not_json(self) -> list[str]:
        """Parameters given that mean nothing beside a JSON body."""
        return sorted(self.model_fields_set - set(TrackAnswerQuery.model_fields))
