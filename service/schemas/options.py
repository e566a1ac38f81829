"""What a caller may ask of a fit, besides the data.

:class:`FitArguments` are the keys of a JSON body beside its columns; :class:`TrendQuery` are the query
parameters: always those that shape the answer, and for CSV bodies the fit's arguments too.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from estimators import RobustOptions
from estimators.trends.bases.settings import MOST_COLUMNS
from service.schemas.fields import (
    AcceptableInliers,
    AnswerFormat,
    Confidence,
    CorrectSerialCorrelation,
    Degree,
    Harmonics,
    Level,
    MaxHypotheses,
    Method,
    MinHypotheses,
    Model,
    Noise,
    Periods,
    Resamples,
    Seed,
    Sigma,
    Theme,
    Threshold,
    ThresholdSigmas,
    UncertaintyMethod,
    Unit,
    WorkBudget,
)
from service.schemas.questions import Horizon, Reach, Regime, read_values

DEFAULTS = RobustOptions()

#: Prefix that carries the fields of ``options`` into the query string.
OPTION_PREFIX = "options."


def read_periods(texts: Sequence[str]) -> list[float | str] | str:
    """Read periods that came as text: numbers, names, or the one word ``auto``.

    Examples
    --------
    >>> read_periods(["365.25", "week"]), read_periods(["auto"])
    ([365.25, 'week'], 'auto')
    """
    if list(texts) == ["auto"]:
        return "auto"
    periods: list[float | str] = []
    for text in texts:
        try:
            periods.append(float(text))
        except ValueError:
            periods.append(text)
    return periods


class TrendOptions(BaseModel):
    """Settings of the search; the defaults serve every method."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    confidence: Confidence = DEFAULTS.confidence
    max_hypotheses: MaxHypotheses = DEFAULTS.max_hypotheses
    min_hypotheses: MinHypotheses = DEFAULTS.min_hypotheses
    work_budget: WorkBudget = DEFAULTS.work_budget
    threshold_sigmas: ThresholdSigmas = DEFAULTS.threshold_sigmas
    acceptable_inliers: AcceptableInliers | None = DEFAULTS.acceptable_inliers
    correct_serial_correlation: CorrectSerialCorrelation = DEFAULTS.correct_serial_correlation
    resamples: Resamples = DEFAULTS.resamples


class FitArguments(BaseModel):
    """Keys of a JSON body beside its columns."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    time_unit: Unit | None = None
    model: Model = "line"
    method: Method = "auto"
    threshold: Threshold | None = None
    sigma: Sigma | None = None
    level: Level = 0.95
    seed: Seed = 0
    noise: Noise = "auto"
    uncertainty: UncertaintyMethod = "effective-n"
    degree: Degree | None = None
    seasonal: Periods | None = None
    harmonics: Harmonics | None = None
    regime: Regime = "all"
    reach: Reach | None = None
    options: TrendOptions = TrendOptions()


class TrendRequest(FitArguments):
    """A series and what to make of it. Columns have one entry per row; null is a missing value.

    This class documents the body; its columns are decoded straight into arrays by the JSON codec.
    """

    time: Annotated[
        list[int | float | str | None],
        Field(
            min_length=1,
            description="Numbers, epoch numbers (say their unit in `time_unit`; integers stay exact), or "
            "ISO 8601 with an offset or Z. ISO 8601 without an offset is taken as UTC. Any order.",
        ),
    ]
    value: Annotated[
        list[float | None], Field(min_length=1, description="One value per time; null where it is missing.")
    ]
    weight: Annotated[
        list[float] | None,
        Field(description="Precision (1/variance up to scale) per value, not negative; 0 leaves a row out."),
    ] = None
    predict: Annotated[
        list[int | float | str] | None,
        Field(description="Times at which to predict, in the form of `time`."),
    ] = None
    horizon: Horizon | None = None
    columns: Annotated[
        dict[str, list[float | None]] | None,
        Field(
            max_length=MOST_COLUMNS,
            description="Further columns of the model `linear` by name, one entry per time; null only in "
            "rows without a value. Each is a parameter of the answer; predictions are made at their means.",
        ),
    ] = None


class AnswerQuery(BaseModel):
    """Query parameters that shape the answer, whatever the body's media type."""

    format: Annotated[
        AnswerFormat | None, Field(description="Format of the answer; takes precedence over `Accept`.")
    ] = None
    points: Annotated[bool, Field(description="Whether a JSON answer includes the columns per row.")] = True
    width_px: Annotated[int, Field(ge=200, le=4000, description="Width of a picture.")] = 800
    height_px: Annotated[int, Field(ge=150, le=4000, description="Height of a picture.")] = 450
    theme: Annotated[Theme, Field(description="Colours of a picture.")] = "light"
    title: Annotated[
        str | None, Field(max_length=120, pattern=r"^[^\x00-\x1f\x7f]*$", description="Title of a picture.")
    ] = None


class FitQuery(BaseModel):
    """Query parameters of a fit, of the same annotated types as the keys of a JSON body."""

    time_unit: Unit | None = None
    model: Model | None = None
    method: Method | None = None
    threshold: Threshold | None = None
    sigma: Sigma | None = None
    level: Level | None = None
    seed: Seed | None = None
    noise: Noise | None = None
    uncertainty: UncertaintyMethod | None = None
    degree: Degree | None = None
    seasonal: Annotated[
        list[str] | None,
        Field(description="Period of a season: a number, a name or `auto`; repeat it for further ones."),
    ] = None
    harmonics: Harmonics | None = None
    regime: Regime | None = None
    reach: Annotated[
        list[str] | None,
        Field(description="Value to reach: when does the trend get there? Repeat it or separate by commas."),
    ] = None
    horizon: Annotated[
        str | None, Field(description="Time, in the form of the time column, by which `reach` is wanted.")
    ] = None
    confidence: Annotated[Confidence | None, Field(alias="options.confidence")] = None
    max_hypotheses: Annotated[MaxHypotheses | None, Field(alias="options.max_hypotheses")] = None
    min_hypotheses: Annotated[MinHypotheses | None, Field(alias="options.min_hypotheses")] = None
    work_budget: Annotated[WorkBudget | None, Field(alias="options.work_budget")] = None
    threshold_sigmas: Annotated[ThresholdSigmas | None, Field(alias="options.threshold_sigmas")] = None
    acceptable_inliers: Annotated[AcceptableInliers | None, Field(alias="options.acceptable_inliers")] = None
    correct_serial_correlation: Annotated[
        CorrectSerialCorrelation | None, Field(alias="options.correct_serial_correlation")
    ] = None
    resamples: Annotated[Resamples | None, Field(alias="options.resamples")] = None

    def fit_arguments(self) -> dict[str, Any]:
        """Nest the fit's arguments that were given as in the JSON body of a single series."""
        given = self.model_dump(by_alias=True, include=self.model_fields_set, exclude_none=True)
        arguments = {name: value for name, value in given.items() if name in FitArguments.model_fields}
        if "seasonal" in arguments:
            arguments["seasonal"] = read_periods(arguments["seasonal"])
        if "reach" in arguments:
            arguments["reach"] = read_values(arguments["reach"])
        options = {
            name.removeprefix(OPTION_PREFIX): value
            for name, value in given.items()
            if name.startswith(OPTION_PREFIX)
        }
        return arguments | {"options": options} if options else arguments


class TrendQuery(FitQuery, AnswerQuery):
    """Query parameters of ``POST /v1/trends``; those of the fit are for CSV, JSON bodies carry them."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    time_column: Annotated[str | None, Field(description="CSV: column of the times (default `time`).")] = None
    value_column: Annotated[str | None, Field(description="CSV: column of the values (default `value`).")] = (
        None
    )
    weight_column: Annotated[
        str | None, Field(description="CSV: column of the weights (default `weight`, if there is one).")
    ] = None
    predict: Annotated[
        list[str] | None,
        Field(
            description="CSV: times at which to predict, in the form of the time column; "
            "repeat it or separate by commas."
        ),
    ] = None

    own_columns: Annotated[
        list[str] | None,
        Field(
            alias="columns",
            description="CSV: columns to fit along with the model `linear`, by name; repeat it or separate "
            "by commas.",
        ),
    ] = None

    def csv_only(self) -> list[str]:
        """Parameters given that only a CSV body allows, by their names on the wire."""
        names = self.model_fields_set - set(AnswerQuery.model_fields)
        return sorted(TrendQuery.model_fields[name].alias or name for name in names)
