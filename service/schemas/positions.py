"""What a caller may ask of positions, and what is answered; answers are written by the codecs."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

import estimators
from estimators import PositionOptions
from service.schemas.answers import Answer, MethodAnswer, NoticeAnswer, WireTime
from service.schemas.fields import Theme, TimeUnit
from service.schemas.options import OPTION_PREFIX

PositionFormat = Literal["json", "csv", "geojson", "svg", "png"]
Motion = Literal["auto", "static", "moving", "independent"]
Surroundings = Literal["auto", "open", "city"]

DEFAULTS = PositionOptions()

_Probability = Annotated[float, Field(gt=0.0, lt=1.0)]
_Positive = Annotated[float, Field(gt=0.0, le=1e9)]
_Method = Annotated[
    str,
    Field(
        description="How faults are found; `/v1/position-methods` describes each. Of many epochs, any other "
        "than `auto` takes each epoch by itself.",
        json_schema_extra={"enum": list(estimators.position_methods())},
    ),
]
_Rotated = Annotated[
    bool,
    Field(
        description="Whether satellite positions are in the frame of the time of reception, turned for the "
        "Earth's rotation while the signal travelled. Never guessed: it moves the answer by tens of metres."
    ),
]
_Motion = Annotated[
    Motion,
    Field(description="With `time`: how the receiver moves. Default `auto`, told from the data."),
]
_Window = Annotated[float, Field(gt=0.0, le=1e6, description="Seconds that answer an epoch, if moving.")]
_Causal = Annotated[bool, Field(description="Whether an epoch is answered by itself and earlier ones only.")]
_Surroundings = Annotated[
    Surroundings, Field(description="If moving: whether reflections lengthen ranges. Default `auto`.")
]
_Unit = Annotated[TimeUnit, Field(description="Unit of times that are numbers since 1970.")]

Numbers = list[float | None]
Matrices = list[list[list[float | None]]]


class PositionSettings(BaseModel):
    """Settings of fault exclusion; the defaults serve every method."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    fault_prior: _Probability = DEFAULTS.fault_prior
    alert_m: _Positive = DEFAULTS.alert_m
    ambiguity: _Probability = DEFAULTS.ambiguity
    integrity_risk: _Probability = DEFAULTS.integrity_risk
    false_alarm: _Probability = DEFAULTS.false_alarm
    missed_detection: _Probability = DEFAULTS.missed_detection
    threshold_sigmas: _Positive = DEFAULTS.threshold_sigmas
    most_faults: Annotated[int, Field(ge=1, le=64)] = DEFAULTS.most_faults
    satellite_fault: _Probability = DEFAULTS.satellite_fault
    constellation_fault: _Probability = DEFAULTS.constellation_fault
    nominal_bias_m: Annotated[float, Field(ge=0.0, le=1e9)] = DEFAULTS.nominal_bias_m
    elevation_mask_deg: Annotated[float | None, Field(ge=-90.0, lt=90.0)] = DEFAULTS.elevation_mask_deg


class PositionArguments(BaseModel):
    """Keys of a JSON body beside its columns."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    rotated: _Rotated
    method: _Method = "auto"
    time_unit: _Unit | None = None
    motion: _Motion | None = None
    window_s: _Window | None = None
    causal: _Causal = False
    surroundings: _Surroundings | None = None
    options: PositionSettings = PositionSettings()


class PositionRequest(PositionArguments):
    """Pseudoranges of one epoch, or of many with `time`. One entry per satellite and epoch; null is missing.

    This class documents the body; its columns are decoded straight into arrays by the JSON codec.
    """

    x_m: Annotated[
        list[float | None],
        Field(
            description="Satellite positions when they transmitted, Earth-centred and Earth-fixed, metres."
        ),
    ]
    y_m: list[float | None]
    z_m: list[float | None]
    pseudorange_m: Annotated[
        list[float | None],
        Field(description="Corrected for satellite clock, ionosphere and troposphere, metres."),
    ]
    sigma_m: Annotated[
        list[float | None] | None,
        Field(description="Noise of each. Default: by elevation, or by `cn0_dbhz` where it is there."),
    ] = None
    cn0_dbhz: list[float | None] | None = None
    system: Annotated[
        list[str] | None,
        Field(description="Letter or name of each satellite's system; the receiver has a clock for each."),
    ] = None
    satellite: Annotated[list[str] | None, Field(description="Names; each once per epoch.")] = None
    time: Annotated[
        list[int | float | str | None] | None,
        Field(description="Rows of equal time are an epoch: seconds, epoch numbers or ISO 8601."),
    ] = None


class PositionAnswerQuery(BaseModel):
    """Query parameters that shape the answer, whatever the body's media type."""

    format: Annotated[
        PositionFormat | None, Field(description="Format of the answer; takes precedence over `Accept`.")
    ] = None
    satellites: Annotated[
        bool, Field(description="Whether a JSON answer includes the columns per satellite.")
    ] = True
    width_px: Annotated[int, Field(ge=200, le=4000, description="Width of a picture.")] = 600
    height_px: Annotated[int, Field(ge=150, le=4000, description="Height of a picture.")] = 600
    theme: Annotated[Theme, Field(description="Colours of a picture.")] = "light"
    title: Annotated[
        str | None, Field(max_length=120, pattern=r"^[^\x00-\x1f\x7f]*$", description="Title of a picture.")
    ] = None


class PositionQuery(PositionAnswerQuery):
    """Query parameters of ``POST /v1/positions``; the arguments are for CSV, JSON bodies carry them."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    rotated: _Rotated | None = None
    method: _Method | None = None
    time_unit: _Unit | None = None
    motion: _Motion | None = None
    window_s: _Window | None = None
    causal: _Causal | None = None
    surroundings: _Surroundings | None = None
    fault_prior: Annotated[_Probability | None, Field(alias="options.fault_prior")] = None
    alert_m: Annotated[_Positive | None, Field(alias="options.alert_m")] = None
    ambiguity: Annotated[_Probability | None, Field(alias="options.ambiguity")] = None
    integrity_risk: Annotated[_Probability | None, Field(alias="options.integrity_risk")] = None
    false_alarm: Annotated[_Probability | None, Field(alias="options.false_alarm")] = None
    elevation_mask_deg: Annotated[
        float | None, Field(alias="options.elevation_mask_deg", ge=-90.0, lt=90.0)
    ] = None

    def arguments(self) -> dict[str, Any]:
        """Nest the arguments that were given as in a JSON body."""
        given = self.model_dump(
            by_alias=True, include=self.model_fields_set - set(PositionAnswerQuery.model_fields)
        )
        present = {name: value for name, value in given.items() if value is not None}
        options = {
            name.removeprefix(OPTION_PREFIX): value
            for name, value in present.items()
            if name.startswith(OPTION_PREFIX)
        }
        plain = {name: value for name, value in present.items() if not name.startswith(OPTION_PREFIX)}
        return plain | {"options": options}

    def csv_only(self) -> list[str]:
        """Parameters given that only a CSV body allows, by their names on the wire."""
        names = self.model_fields_set - set(PositionAnswerQuery.model_fields)
        return sorted(PositionQuery.model_fields[name].alias or name for name in names)


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


class PositionAnswer(Answer):
    """The position of one epoch, and which satellites lie."""

    method: str
    position: PlaceAnswer
    covariance_enu_m2: Annotated[list[Numbers], Field(description="East, north, up.")]
    clocks_m: Annotated[dict[str, float], Field(description="Receiver clock error per system.")]
    dop: dict[str, float | None]
    integrity: IntegrityAnswer
    global_test: dict[str, float | None]
    ambiguous: Annotated[
        bool, Field(description="Whether the truth may lie beyond the alert limit: do not use it alone.")
    ]
    far_probability: float | None
    rival: Annotated[dict[str, Any] | None, Field(description="The likeliest position elsewhere.")]
    sigma_scale: float | None
    consensus: dict[str, Any]
    notices: list[NoticeAnswer]
    satellites: Annotated[
        dict[str, Any] | None, Field(description="Columns, one entry per row, in the order they came.")
    ] = None


class EpochColumns(Answer):
    """One entry per epoch; null where an epoch has no position."""

    time: list[WireTime]
    status: list[str]
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
    rivals: list[dict[str, Any]]
    notices: list[NoticeAnswer]
    satellites: Annotated[
        dict[str, Any] | None, Field(description="Columns, one entry per row, in the order they came.")
    ] = None


class PositionMethodsAnswer(Answer):
    """All methods of fault exclusion."""

    methods: list[MethodAnswer]
