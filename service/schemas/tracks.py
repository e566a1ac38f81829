"""The answers about tracks as pydantic models: key for key what the library's dicts hold.

They document; answers are written by the codecs. A test validates real answers against them.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from service.schemas.answers import (
    Answer,
    DescribedAnswer,
    EstimateAnswer,
    NoFitReason,
    NoticeAnswer,
    RowReason,
    WireTime,
)

Numbers = list[float | None]
FixReason = Literal["ok", "spike", "burst", "stale", "duplicate", "out_of_order", "invalid", "gap_edge"]


class TrackNoiseAnswer(Answer):
    """What the errors and the motion of the track are made of."""

    sigma_m: Annotated[
        float, Field(description="Standard deviation, per axis, of errors independent of one another.")
    ]
    coloured_m: Annotated[float, Field(description="Of those that last for `correlation_s`.")]
    correlation_s: float
    manoeuvre: Annotated[float, Field(description="Spectral density of the acceleration, m^2/s^3.")]
    source: Literal["estimated", "given"]


class TrackDistanceAnswer(Answer):
    """How far the track goes."""

    raw_m: Annotated[float, Field(description="Along all valid fixes as they came, in order of time.")]
    cleaned_m: Annotated[EstimateAnswer, Field(description="Along the smoothed track while it moves.")]


class StretchAnswer(Answer):
    """A stretch that moves or stands."""

    kind: Literal["moving", "stopped"]
    first: Annotated[int, Field(description="Entry of `points` with which it begins.")]
    last: Annotated[int, Field(description="Entry of `points` with which it ends.")]
    duration_s: float
    distance_m: float
    speed_mps: Annotated[float, Field(description="Median.")]
    acceleration_mps2: Annotated[EstimateAnswer | None, Field(description="Robust trend of the speed.")]


class TrackPointColumns(Answer):
    """One entry per fix, in the order they came; null where there is no value."""

    time: Annotated[list[WireTime], Field(description="In the form and the zone in which each came.")]
    inlier: list[bool]
    probability: Annotated[Numbers, Field(description="That the fix tells where the track was.")]
    reason: Annotated[
        list[FixReason],
        Field(
            description="`spike`: off alone; `burst`: off together with its neighbours; `stale`: an old "
            "position repeated; `duplicate`: another row again; `out_of_order`: its clock was off; "
            "`invalid`: no time or no place on Earth; `gap_edge`: beside a gap."
        ),
    ]
    residual_m: Annotated[Numbers, Field(description="Distance of the fix from the smoothed track.")]
    lat_deg: Annotated[Numbers, Field(description="Smoothed.")]
    lon_deg: Numbers
    height_m: Numbers | None
    variance_east_m2: Annotated[Numbers, Field(description="Of the smoothed position.")]
    variance_north_m2: Numbers
    covariance_east_north_m2: Numbers
    variance_up_m2: Numbers | None
    speed_mps: Numbers
    speed_sigma_mps: Numbers
    heading_deg: Annotated[Numbers, Field(description="Clockwise from north.")]
    heading_sigma_deg: Numbers


LeftOut = Annotated[
    int | None, Field(description="Records of the file that hold no fix: NMEA with a wrong checksum.")
]


class TrackAnswer(Answer):
    """A cleaned track."""

    device: Annotated[str | None, Field(description="Where the file names it.")] = None
    method: str
    level: float
    n: Annotated[int, Field(description="Fixes.")]
    inliers: int
    noise: TrackNoiseAnswer
    distance: TrackDistanceAnswer
    stretches: Annotated[list[StretchAnswer], Field(description="In order of time.")]
    notices: list[NoticeAnswer]
    points: TrackPointColumns | None = None
    left_out: LeftOut = None


class RefusedPoints(Answer):
    """What became of every fix."""

    reason: list[RowReason]


class RefusalAnswer(Answer):
    """Why a device has no track."""

    reason: NoFitReason
    message: str
    points: RefusedPoints
    notices: list[NoticeAnswer]


class DeviceTrackAnswer(Answer):
    """A device with its track, or with the reason why it has none."""

    device: str | None
    row: Annotated[list[int] | None, Field(description="Its rows of the request, counted from 0.")] = None
    track: TrackAnswer | None
    refusal: RefusalAnswer | None


class TracksAnswer(Answer):
    """The tracks of many devices."""

    tracks: Annotated[list[DeviceTrackAnswer], Field(description="In the order in which they first appear.")]
    left_out: LeftOut = None


class TrackGeometry(Answer):
    """A line or a point of GeoJSON: longitude, latitude and, if known, height."""

    type: Literal["Point", "LineString", "MultiLineString"]
    coordinates: list[Any]


class TrackFeatureAnswer(Answer):
    """A track, or with `points=true` a fix; the geometry is null where a fix has no place."""

    type: Literal["Feature"]
    geometry: TrackGeometry | None
    properties: Annotated[
        dict[str, Any],
        Field(
            description="Of a line `device` and `coordTimes`; of a point `time`, `device`, `inlier`, "
            "`probability`, `reason`, `raw_lat`, `raw_lon` and the other columns of a table."
        ),
    ]


class TrackFeaturesAnswer(Answer):
    """Tracks as GeoJSON (RFC 7946), lines cut at longitude 180."""

    type: Literal["FeatureCollection"]
    features: list[TrackFeatureAnswer]


class TrackMethodsAnswer(Answer):
    """All methods of cleaning tracks."""

    methods: list[DescribedAnswer]
