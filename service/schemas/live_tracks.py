"""Live tracks on the wire: what a call may ask, and what it is answered."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from estimators.trajectories.live.stream import LAGS
from estimators.trajectories.live.token import LONGEST_TOKEN
from service.schemas.answers import Answer, WireTime
from service.schemas.tracks import FixReason, Numbers, TrackNoiseAnswer
from service.schemas.trajectories import MaxSpeed, Sigma, Unit


class LiveArguments(BaseModel):
    """Keys of the body beside its columns."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    state: Annotated[
        str | None,
        Field(
            max_length=LONGEST_TOKEN,
            description="`state` of the last answer about this receiver; without it a track begins. It is "
            "opaque, and holds the last fixes in clear.",
        ),
    ] = None
    lag: Annotated[
        int | None,
        Field(
            ge=LAGS[0],
            le=LAGS[1],
            description="Delay in fixes: a row is settled when so many later ones are known. Default: 32, or "
            "that of the state.",
        ),
    ] = None
    finish: Annotated[bool, Field(description="Whether the track ends here: all rows are settled now.")] = (
        False
    )
    sigma_m: Sigma | None = None
    max_speed_mps: MaxSpeed | None = None
    time_unit: Unit | None = None


class LiveRequest(LiveArguments):
    """Rows of one receiver since the last call. One entry per fix; null is missing.

    To finish a track without more rows, its columns may be empty or left out. This class documents the
    body; its columns are decoded straight into arrays by the JSON codec.
    """

    time: Annotated[
        list[int | float | str | None],
        Field(description="As of `/v1/trajectories`, in the same form in all calls of a track."),
    ] = []
    lat: Annotated[list[float | None], Field(description="Degrees north, WGS 84.")] = []
    lon: Annotated[list[float | None], Field(description="Degrees east, -180 to 360.")] = []
    height: Annotated[list[float | None] | None, Field(description="Metres.")] = None
    accuracy: Annotated[
        list[float | None] | None,
        Field(description="Radius about each fix that holds 68 % as the receiver reports it, metres."),
    ] = None


class LiveQuery(BaseModel):
    """Query parameters of ``POST /v1/trajectories/live``; the arguments are in the body."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Annotated[Literal["json"] | None, Field(description="Format of the answer.")] = None


class LiveRowsAnswer(Answer):
    """One entry per row; null where there is no value."""

    row: Annotated[
        list[int], Field(description="Its number in the track, from 0, in the order in which rows were sent.")
    ]
    time: Annotated[list[WireTime], Field(description="In the form and the zone in which each came.")]
    inlier: list[bool]
    probability: Annotated[Numbers, Field(description="That the fix tells where the track was.")]
    reason: Annotated[list[FixReason], Field(description="As of a track that is cleaned as a whole.")]
    lat_deg: Annotated[Numbers, Field(description="Smoothed.")]
    lon_deg: Numbers
    height_m: Numbers
    variance_east_m2: Annotated[Numbers, Field(description="Of the smoothed position.")]
    variance_north_m2: Numbers
    covariance_east_north_m2: Numbers
    variance_up_m2: Numbers
    speed_mps: Numbers
    speed_sigma_mps: Numbers
    heading_deg: Annotated[Numbers, Field(description="Clockwise from north.")]
    heading_sigma_deg: Numbers


class LiveAnswer(Answer):
    """What one call says of a live track."""

    settled: Annotated[
        LiveRowsAnswer,
        Field(description="Rows whose answer is final now. Over all calls each row is settled once."),
    ]
    provisional: Annotated[
        LiveRowsAnswer,
        Field(description="Rows that wait for later ones, in order of time, as they look now."),
    ]
    noise: Annotated[TrackNoiseAnswer, Field(description="As estimated so far.")]
    state: Annotated[str, Field(description="For the next call about this receiver.")]
