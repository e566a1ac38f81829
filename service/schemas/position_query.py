"""The query string of ``POST /v1/positions``: what shapes the answer, arguments of tables and files."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from service.schemas.fields import Theme
from service.schemas.options import OPTION_PREFIX
from service.schemas.positions import (
    Causal,
    HowItMoves,
    Ionosphere,
    Method,
    Positive,
    Probability,
    Raw,
    Rotated,
    Troposphere,
    Unit,
    Weights,
    WhatIsAround,
    Window,
)

PositionFormat = Literal["json", "csv", "arrow", "parquet", "geojson", "svg", "png"]
Figure = Literal["sky", "residuals", "stanford"]
Rows = Literal["satellites", "epochs"]

Latitude = Annotated[float, Field(ge=-90.0, le=90.0, allow_inf_nan=False)]
Longitude = Annotated[float, Field(ge=-180.0, le=180.0, allow_inf_nan=False)]

TRUTH = ("truth_lat_deg", "truth_lon_deg", "truth_height_m")

_LISTS_OF_NUMBERS = ("klobuchar_alpha", "klobuchar_beta")
_LISTS = (*_LISTS_OF_NUMBERS, "systems")
_MANY = "; repeat it or separate by commas."


class PositionAnswerQuery(BaseModel):
    """Query parameters that shape the answer, whatever the body's media type."""

    format: Annotated[
        PositionFormat | None, Field(description="Format of the answer; takes precedence over `Accept`.")
    ] = None
    satellites: Annotated[
        bool, Field(description="Whether a JSON answer includes the columns per satellite.")
    ] = True
    rows: Annotated[
        Rows, Field(description="CSV, Arrow, Parquet: a row per satellite and epoch, or per epoch.")
    ] = "satellites"
    figure: Annotated[
        Figure,
        Field(
            description="Which picture: where the satellites stand, their residuals (both of one epoch), or "
            "protection levels against errors, for which the truth is needed."
        ),
    ] = "sky"
    truth_lat_deg: Annotated[
        Latitude | None, Field(description="`stanford`: where a standing receiver really is.")
    ] = None
    truth_lon_deg: Longitude | None = None
    truth_height_m: Annotated[float | None, Field(ge=-1e7, le=1e7, allow_inf_nan=False)] = None
    width_px: Annotated[int, Field(ge=200, le=4000, description="Width of a picture.")] = 600
    height_px: Annotated[int, Field(ge=150, le=4000, description="Height of a picture.")] = 600
    theme: Annotated[Theme, Field(description="Colours of a picture.")] = "light"
    title: Annotated[
        str | None, Field(max_length=120, pattern=r"^[^\x00-\x1f\x7f]*$", description="Title of a picture.")
    ] = None


class PositionQuery(PositionAnswerQuery):
    """Query parameters of ``POST /v1/positions``; JSON bodies carry the arguments, others have them here."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    rotated: Rotated | None = None
    method: Method | None = None
    time_unit: Unit | None = None
    motion: HowItMoves | None = None
    window_s: Window | None = None
    causal: Causal | None = None
    surroundings: WhatIsAround | None = None
    raw: Raw | None = None
    klobuchar_alpha: Annotated[
        list[str] | None, Field(description="`raw`: four coefficients of the ionosphere" + _MANY)
    ] = None
    klobuchar_beta: Annotated[
        list[str] | None, Field(description="`raw`: four coefficients of the ionosphere" + _MANY)
    ] = None
    troposphere: Troposphere | None = None
    weights: Weights | None = None
    systems: Annotated[list[str] | None, Field(description="Files: letters or names of systems" + _MANY)] = (
        None
    )
    ionosphere: Ionosphere | None = None
    fault_prior: Annotated[Probability | None, Field(alias="options.fault_prior")] = None
    alert_m: Annotated[Positive | None, Field(alias="options.alert_m")] = None
    ambiguity: Annotated[Probability | None, Field(alias="options.ambiguity")] = None
    integrity_risk: Annotated[Probability | None, Field(alias="options.integrity_risk")] = None
    false_alarm: Annotated[Probability | None, Field(alias="options.false_alarm")] = None
    missed_detection: Annotated[Probability | None, Field(alias="options.missed_detection")] = None
    threshold_sigmas: Annotated[Positive | None, Field(alias="options.threshold_sigmas")] = None
    most_faults: Annotated[int | None, Field(alias="options.most_faults", ge=1, le=64)] = None
    satellite_fault: Annotated[Probability | None, Field(alias="options.satellite_fault")] = None
    constellation_fault: Annotated[Probability | None, Field(alias="options.constellation_fault")] = None
    nominal_bias_m: Annotated[float | None, Field(alias="options.nominal_bias_m", ge=0.0, le=1e9)] = None
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
            name.removeprefix(OPTION_PREFIX): present.pop(name)
            for name in tuple(present)
            if name.startswith(OPTION_PREFIX)
        }
        for name in _LISTS:
            if name in present:
                present[name] = [part.strip() for text in present[name] for part in text.split(",")]
        for name in _LISTS_OF_NUMBERS:
            if name in present:
                present[name] = [_number(text) for text in present[name]]
        return present | {"options": options}

    def not_json(self) -> list[str]:
        """Parameters given that a JSON body carries itself, by their names on the wire."""
        names = self.model_fields_set - set(PositionAnswerQuery.model_fields)
        return sorted(PositionQuery.model_fields[name].alias or name for name in names)


def _number(text: str) -> float | str:
    """Read a number; a text that is none stays as it is, for the check of the arguments to name."""
    try:
        return float(text)
    except ValueError:
        return text
