"""Everything that a caller may set, one annotated type each: what it means and what it may be.

Options of one fit, of a batch and of the query string are made of these types, so that they cannot drift
apart; the names of methods and models come from the registries.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field
from pydantic_core import PydanticCustomError

import estimators
from estimators.arrays import LARGEST_TIME, LARGEST_VALUE, SMALLEST_TIME
from estimators.trends.bases.settings import MOST_DEGREE, MOST_HARMONICS, MOST_PERIODS

METHOD_NAMES = tuple(estimators.methods())
MODEL_NAMES = tuple(estimators.models())

TimeUnit = Literal["s", "ms", "us", "ns"]
AnswerFormat = Literal["json", "csv", "svg", "png"]
Theme = Literal["light", "dark"]


def one_of(known: tuple[str, ...]) -> AfterValidator:
    """Make a validator that refuses a name that is not in a registry, and lists those that are."""

    def check(name: str) -> str:
        if name not in known:
            raise PydanticCustomError("unknown_name", "must be one of: {names}", {"names": ", ".join(known)})
        return name

    return AfterValidator(check)


Method = Annotated[
    str,
    one_of(METHOD_NAMES),
    Field(
        description="How the trend is found; `/v1/methods` describes each.",
        json_schema_extra={"enum": list(METHOD_NAMES)},
    ),
]
Model = Annotated[
    str,
    one_of(MODEL_NAMES),
    Field(
        description="Shape of the trend; `/v1/models` describes each.",
        json_schema_extra={"enum": list(MODEL_NAMES)},
    ),
]
Threshold = Annotated[
    float,
    Field(
        ge=1 / LARGEST_VALUE,
        le=LARGEST_VALUE,
        allow_inf_nan=False,
        description="Largest distance of an inlier, in units of the values. Default: estimated.",
    ),
]
Sigma = Annotated[
    float,
    Field(
        ge=1 / LARGEST_VALUE,
        le=LARGEST_VALUE,
        allow_inf_nan=False,
        description="Noise scale of an inlier, in units of the values. Default: estimated.",
    ),
]
Level = Annotated[
    float, Field(gt=0, lt=1, allow_inf_nan=False, description="Confidence level of every interval and band.")
]
Seed = Annotated[
    int, Field(ge=0, le=2**63 - 1, description="Seed of the search; the same seed gives the same bytes.")
]
Noise = Annotated[
    Literal["auto", "multiplicative", "additive"],
    Field(
        description="Noise of an exponential: `multiplicative` (a share of the level; `threshold` and "
        "`sigma` are then of ln(value)), `additive` (the same at every level), or told from the data."
    ),
]
Degree = Annotated[int, Field(ge=0, le=MOST_DEGREE, description="Degree of the polynomial of `linear`.")]
PeriodName = Literal["hour", "day", "week", "month", "year"]
Periods = Annotated[
    Literal["auto"]
    | Annotated[
        list[Annotated[float, Field(ge=SMALLEST_TIME, le=LARGEST_TIME)] | PeriodName],
        Field(min_length=1, max_length=MOST_PERIODS),
    ],
    Field(
        description="Periods of seasons that are fitted together with the trend: in the unit of time "
        "(seconds for points in time) or by name; or `auto`, which finds them."
    ),
]
Harmonics = Annotated[
    int,
    Field(
        ge=1,
        le=MOST_HARMONICS,
        description="Pairs of cosine and sine per season. Default: as the data support.",
    ),
]
UncertaintyMethod = Annotated[
    Literal["effective-n", "hac", "bootstrap", "permutation"],
    Field(
        description="How intervals and p-value are made: `effective-n` and `hac` by a formula, `bootstrap` "
        "and `permutation` by running the whole procedure again `options.resamples` times."
    ),
]
Unit = Annotated[
    TimeUnit,
    Field(
        description="Unit of epoch numbers in `time` and `predict` (since 1970-01-01T00:00:00Z). "
        "Without it numbers are plain numbers."
    ),
]
Confidence = Annotated[
    float,
    Field(
        gt=0,
        lt=1,
        allow_inf_nan=False,
        description="Wanted probability of at least one sample without outliers.",
    ),
]
MaxHypotheses = Annotated[
    int, Field(ge=1, le=10_000_000, description="Upper bound on minimal samples drawn.")
]
MinHypotheses = Annotated[
    int,
    Field(ge=1, le=10_000_000, description="Lower bound on minimal samples drawn, at most max_hypotheses."),
]
WorkBudget = Annotated[
    int,
    Field(
        ge=0,
        le=10**10,
        description="Enumerate all minimal samples when they cost at most this many residuals.",
    ),
]
ThresholdSigmas = Annotated[
    float,
    Field(
        ge=1,
        le=10,
        allow_inf_nan=False,
        description="Inlier threshold in noise scales where none is given.",
    ),
]
AcceptableInliers = Annotated[
    int, Field(ge=3, description="Consensus at which `fischler-bolles` stops. Default: half of the points.")
]
Resamples = Annotated[
    int,
    Field(ge=99, le=10_000, description="Series that `bootstrap` and `permutation` fit again."),
]
CorrectSerialCorrelation = Annotated[
    bool, Field(description="Widen intervals by the effective sample size where residuals are correlated.")
]
