"""What a caller may ask of positions; the answers are in :mod:`service.schemas.fixes`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

import estimators
from estimators import PositionOptions
from service.schemas.fields import TimeUnit, one_of

Motion = Literal["auto", "static", "moving", "independent"]
Surroundings = Literal["auto", "open", "city"]

DEFAULTS = PositionOptions()
METHODS = tuple(estimators.position_methods())


Probability = Annotated[float, Field(gt=0.0, lt=1.0)]
Positive = Annotated[float, Field(gt=0.0, le=1e9)]
Method = Annotated[
    str,
    one_of(METHODS),
    Field(
        description="How faults are found; `/v1/position-methods` describes each. Of many epochs, any other "
        "than `auto` takes each epoch by itself.",
        json_schema_extra={"enum": list(METHODS)},
    ),
]
Rotated = Annotated[
    bool,
    Field(
        description="Whether satellite positions are in the frame of the time of reception, turned for the "
        "Earth's rotation while the signal travelled. Never guessed: it moves the answer by tens of metres."
    ),
]
HowItMoves = Annotated[
    Motion,
    Field(description="Of many epochs: how the receiver moves. Default `auto`, told from the data."),
]
Window = Annotated[float, Field(gt=0.0, le=1e6, description="Seconds that answer an epoch, if moving.")]
Causal = Annotated[bool, Field(description="Whether an epoch is answered by itself and earlier ones only.")]
WhatIsAround = Annotated[
    Surroundings, Field(description="If moving: whether reflections lengthen ranges. Default `auto`.")
]
Unit = Annotated[TimeUnit, Field(description="Unit of times that are numbers since 1970.")]
Raw = Annotated[
    bool,
    Field(
        description="Whether pseudoranges are as measured, to be corrected here for satellite clock, group "
        "delay, ionosphere, troposphere and elevation mask."
    ),
]
Coefficients = Annotated[
    list[float],
    Field(
        min_length=4,
        max_length=4,
        description="`raw`: four coefficients of the broadcast ionosphere (Klobuchar); alpha and beta go "
        "together and need `time` in UTC. Default: the ionosphere is not corrected.",
    ),
]
Troposphere = Annotated[bool, Field(description="`raw`: whether to correct the troposphere (Saastamoinen).")]
Weights = Annotated[
    Literal["elevation", "strength"],
    Field(
        description="`raw` and files: noise by elevation or by signal strength. Default: by strength of "
        "phones and of tables that have it, otherwise by elevation."
    ),
]
Systems = Annotated[
    list[Annotated[str, Field(max_length=20)]],
    Field(min_length=1, max_length=5, description="Files: letters or names of systems. Default: all."),
]
Ionosphere = Annotated[
    Literal["auto", "broadcast", "dual", "none"],
    Field(
        description="Files: `broadcast` by the coefficients of the navigation file, `dual` by two codes; "
        "`auto` by the coefficients if there are any."
    ),
]


class PositionSettings(BaseModel):
    """Settings of fault exclusion; the defaults serve every method."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    fault_prior: Probability = DEFAULTS.fault_prior
    alert_m: Positive = DEFAULTS.alert_m
    ambiguity: Probability = DEFAULTS.ambiguity
    integrity_risk: Probability = DEFAULTS.integrity_risk
    false_alarm: Probability = DEFAULTS.false_alarm
    missed_detection: Probability = DEFAULTS.missed_detection
    threshold_sigmas: Positive = DEFAULTS.threshold_sigmas
    most_faults: Annotated[int, Field(ge=1, le=64)] = DEFAULTS.most_faults
    satellite_fault: Probability = DEFAULTS.satellite_fault
    constellation_fault: Probability = DEFAULTS.constellation_fault
    nominal_bias_m: Annotated[float, Field(ge=0.0, le=1e9)] = DEFAULTS.nominal_bias_m
    elevation_mask_deg: Annotated[
        float | None,
        Field(ge=-90.0, lt=90.0, description="Default: no mask; 10 where ranges are corrected here."),
    ] = DEFAULTS.elevation_mask_deg


class SolvingArguments(BaseModel):
    """How positions are found, whatever the ranges come from."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    method: Method = "auto"
    motion: HowItMoves | None = None
    window_s: Window | None = None
    causal: Causal = False
    surroundings: WhatIsAround | None = None
    options: PositionSettings = PositionSettings()


class PositionArguments(SolvingArguments):
    """Keys of a JSON body beside its columns, and the arguments of a table."""

    rotated: Rotated
    time_unit: Unit | None = None
    raw: Raw = False
    klobuchar_alpha: Coefficients | None = None
    klobuchar_beta: Coefficients | None = None
    troposphere: Troposphere | None = None
    weights: Weights | None = None


class RecordingArguments(SolvingArguments):
    """Arguments of files as receivers write them."""

    systems: Systems | None = None
    ionosphere: Ionosphere = "auto"
    weights: Weights | None = None


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
        Field(
            description="Metres; corrected for satellite clock, ionosphere and troposphere, or with `raw` "
            "as measured."
        ),
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
    range_rate_mps: Annotated[
        list[float | None] | None,
        Field(
            description="With `time` and satellite velocities: how fast each range grows, by Doppler; "
            "without `raw` corrected for the drift of the satellite clock."
        ),
    ] = None
    vx_mps: Annotated[
        list[float | None] | None, Field(description="Velocities of the satellites, as their positions.")
    ] = None
    vy_mps: list[float | None] | None = None
    vz_mps: list[float | None] | None = None
    satellite_clock_s: Annotated[
        list[float | None] | None,
        Field(description="`raw`: how far the satellite clock is ahead, relativity included. Default 0."),
    ] = None
    group_delay_s: Annotated[
        list[float | None] | None, Field(description="`raw`: TGD or BGD of the signal measured. Default 0.")
    ] = None
    clock_drift: Annotated[
        list[float | None] | None, Field(description="`raw`: of the satellite clocks, s/s. Default 0.")
    ] = None
    accuracy_m: Annotated[
        list[float | None] | None, Field(description="`raw`: accuracy of orbit and clock (URA). Default 2.")
    ] = None
    frequency_hz: Annotated[
        list[float | None] | None, Field(description="`raw`: carrier. Default: the first of the system.")
    ] = None
    second_m: Annotated[
        list[float | None] | None,
        Field(description="`raw`: pseudorange on another carrier; both are combined without ionosphere."),
    ] = None
    second_hz: Annotated[list[float | None] | None, Field(description="`raw`: the other carrier.")] = None
