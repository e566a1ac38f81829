"""The answers about positions as pydantic models: key for key what the library's dicts hold.

They document; answers are written by the codecs. A test validates real answers against them.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from service.schemas.answers import Answer, MethodAnswer, NoticeAnswer, SearchKind, WireTime
from service.schemas.positions import Motion

Numbers = list[float | None]
Matrices = list[list[list[float | None]]]


class LeftOutAnswer(Answer):
    """Ranges that took no part because of their corrections; one entry each."""

    row: Annotated[list[int], Field(description="Of the table, or which observation of the file; from 0.")]
    satellite: list[str]
    reason: Annotated[
        list[Literal["masked", "missing", "one_code", "unhealthy", "no_ephemeris"]],
        Field(
            description="`masked`: under the elevation mask; `one_code`: the second code is missing; "
            "`unhealthy`: so the navigation message says; `no_ephemeris`: none near enough in time."
        ),
    ]


class PlaceAnswer(Answer):
    """A place on the WGS 84 ellipsoid and in Earth-centred, Earth-fixed metres."""

    ecef_m: list[float]
    lat_deg: float
    lon_deg: float
    height_m: float


class IntegrityAnswer(Answer):
    """Protection levels and what they assume; null where nothing bounds the error."""

    hpl_m: float | None
    vpl_m: float | None
    risk: float
    fault_prior: float
    method: str


SatelliteState = Literal["used", "excluded", "untestable", "masked", "missing"]
EpochState = Literal[
    "solved", "bridged", "too_few_satellites", "undetermined_geometry", "implausible_position"
]
SourceRow = Annotated[
    list[int] | None,
    Field(
        description="Where ranges were corrected here: row of the table, or which observation of the file."
    ),
]


class SatelliteColumns(Answer):
    """The satellites of one epoch; null where a number is infinite or there is none."""

    satellite: list[str]
    system: list[str]
    status: list[SatelliteState]
    fault_probability: Numbers
    weight: Annotated[Numbers, Field(description="What the range counts, from 0 to 1, beside its sigma.")]
    residual_m: Numbers
    sigma_m: Numbers
    statistic: Numbers
    threshold: Annotated[float | None, Field(description="Limit of the statistic, all satellites together.")]
    mdb_m: Annotated[Numbers, Field(description="Minimum detectable bias; null where nothing checks it.")]
    azimuth_deg: Numbers
    elevation_deg: Numbers
    reason: list[str]
    row: SourceRow = None


class SeriesSatelliteColumns(Answer):
    """The satellites of all epochs."""

    epoch: Annotated[list[int], Field(description="Which of the epochs, counted from 0.")]
    satellite: list[str]
    system: list[str]
    status: list[SatelliteState]
    inlier: list[bool]
    fault_probability: Numbers
    weight: Numbers
    residual_m: Numbers
    sigma_m: Numbers
    reason: list[str]
    row: SourceRow = None


class RivalAnswer(Answer):
    """The likeliest position elsewhere."""

    ecef_m: list[float]
    distance_m: Annotated[float, Field(description="Horizontal, to the answer.")]
    probability: float
    excluded: Annotated[list[str], Field(description="The satellites that it calls faulty.")]


class SeriesRivalAnswer(Answer):
    """A track elsewhere, over a stretch of epochs."""

    epochs: Annotated[list[int], Field(description="First and last, both included.")]
    position_ecef_m: Annotated[list[float], Field(description="Where it is farthest from the answer.")]
    distance_m: float
    probability: float


class DilutionAnswer(Answer):
    """Dilution of precision of the satellites used."""

    gdop: float | None
    pdop: float | None
    hdop: float | None
    vdop: float | None
    tdop: float | None


class GlobalTestAnswer(Answer):
    """Chi-square test of the ranges used, at the sigmas as given."""

    statistic: float | None
    dof: int
    threshold: float | None
    p_value: float | None


class FoundAnswer(Answer):
    """How the answer was found."""

    n: Annotated[int, Field(description="Satellites that took part.")]
    inliers: int
    inlier_ratio: float
    scored: Annotated[int, Field(description="Fault sets that were weighed.")]
    search: SearchKind


class PositionAnswer(Answer):
    """The position of one epoch, and which satellites lie."""

    time: Annotated[WireTime, Field(description="Of the epoch of a file, UTC.")] = None
    method: str
    position: PlaceAnswer
    covariance_enu_m2: Annotated[list[Numbers], Field(description="East, north, up.")]
    clocks_m: Annotated[dict[str, float], Field(description="Receiver clock error per system.")]
    dop: DilutionAnswer
    integrity: IntegrityAnswer
    global_test: GlobalTestAnswer
    ambiguous: Annotated[
        bool, Field(description="Whether the truth may lie beyond the alert limit: do not use it alone.")
    ]
    far_probability: float | None
    rival: RivalAnswer | None
    sigma_scale: float | None
    consensus: FoundAnswer
    notices: list[NoticeAnswer]
    satellites: Annotated[
        SatelliteColumns | None, Field(description="One entry per row, in the order they came.")
    ] = None
    left_out: Annotated[
        LeftOutAnswer | None, Field(description="Where ranges were corrected here: those that took no part.")
    ] = None


class EpochColumns(Answer):
    """One entry per epoch; null where an epoch has no position."""

    time: list[WireTime]
    status: list[EpochState]
    position_ecef_m: list[Numbers]
    lat_deg: Numbers
    lon_deg: Numbers
    height_m: Numbers
    velocity_enu_mps: list[Numbers]
    covariance_enu_m2: Matrices
    clocks_m: dict[str, Numbers]
    hpl_m: Numbers
    vpl_m: Numbers
    far_probability: Numbers
    ambiguous: list[bool]


class PositionsAnswer(Answer):
    """The positions of many epochs."""

    motion: Motion
    motion_reason: str
    surroundings: Literal["open", "city"]
    surroundings_reason: str
    method: str
    window_s: float | None
    causal: bool
    sigma_scale: float | None
    correlation: float | None
    fixes: EpochColumns
    rivals: list[SeriesRivalAnswer]
    notices: list[NoticeAnswer]
    satellites: Annotated[
        SeriesSatelliteColumns | None, Field(description="One entry per row, in the order they came.")
    ] = None
    left_out: Annotated[
        LeftOutAnswer | None, Field(description="Where ranges were corrected here: those that took no part.")
    ] = None


class PointGeometry(Answer):
    """A point of GeoJSON: longitude, latitude, height."""

    type: Literal["Point"]
    coordinates: Annotated[list[float], Field(min_length=3, max_length=3)]


class FeatureProperties(Answer):
    """What a map shows of a position."""

    time: WireTime = None
    method: Annotated[str | None, Field(description="Of one epoch.")] = None
    status: Annotated[EpochState | None, Field(description="Of an epoch of many.")] = None
    hpl_m: float | None
    vpl_m: float | None
    ambiguous: bool
    used: Annotated[int, Field(description="Satellites.")]
    excluded: list[str]


class FeatureAnswer(Answer):
    """One epoch as GeoJSON (RFC 7946)."""

    type: Literal["Feature"]
    geometry: PointGeometry
    properties: FeatureProperties


class FeatureCollectionAnswer(Answer):
    """The epochs that have a position as GeoJSON (RFC 7946)."""

    type: Literal["FeatureCollection"]
    features: list[FeatureAnswer]


class PositionMethodsAnswer(Answer):
    """All methods of fault exclusion."""

    methods: list[MethodAnswer]
