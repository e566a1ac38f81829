"""The answers as pydantic models: key for key what ``Trend.to_dict()`` makes.

They document; answers are written by the codecs. A test validates real answers against them, so that
neither side changes alone.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from service.schemas.questions import CrossingAnswer, RegimeAnswer, SlopeAnswer

WireTime = int | float | str | None
SearchKind = Literal["sampled", "exhaustive", "certified", "closed"]
RowReason = Literal["ok", "outlier", "missing", "invalid", "duplicate", "zero_weight", "earlier_regime"]
NoFitReason = Literal["no_data", "too_few_points", "constant_time", "no_consensus", "too_large"]
NoPositionReason = Literal["too_few_satellites", "undetermined_geometry", "implausible_position"]


class Answer(BaseModel):
    """Base of all answers: no key is undocumented."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class EstimateAnswer(Answer):
    """A number with its uncertainty; null where the data leave no way to tell."""

    value: float
    stderr: float | None
    low: float | None
    high: float | None


class NoticeAnswer(Answer):
    """A typed warning."""

    code: Annotated[str, Field(description="Stable name of the warning.")]
    message: str
    detail: dict[str, Any]


class HypothesesAnswer(Answer):
    """What the search did."""

    drawn: int
    degenerate: int
    invalid: int
    scored: int
    point_evaluations: int
    optimizations: int


class ConsensusAnswer(Answer):
    """How the answer was found."""

    method: str
    n: Annotated[int, Field(description="Rows that took part.")]
    inliers: int
    inlier_ratio: float
    threshold: Annotated[float, Field(description="Largest distance of an inlier, in units of the values.")]
    threshold_source: str
    sigma: Annotated[float, Field(description="Noise scale of an inlier, in units of the values.")]
    sigma_source: str
    hypotheses: HypothesesAnswer
    sampling_probability: Annotated[
        float | None,
        Field(
            description="Probability that at least one sample without outliers was drawn; it is not the "
            "probability that the trend is right. Null for methods that draw none."
        ),
    ]
    search: SearchKind
    seed: int


class UncertaintyAnswer(Answer):
    """How the intervals were made."""

    method: str
    level: float
    effective_n: Annotated[
        float | None, Field(description="Number of independent inliers that the correlated ones are worth.")
    ]
    lag1: float | None
    dof: float | None
    resamples: Annotated[int | None, Field(description="Series that were fitted again.")] = None
    block: Annotated[int | None, Field(description="Neighbouring points that were drawn together.")] = None
    stability: Annotated[
        float | None,
        Field(description="Share of resampled series in which the same structure was found again."),
    ] = None


class RunnerUpAnswer(Answer):
    """The best trend among the rows that the answer calls outliers."""

    parameters: dict[str, float]
    inliers: int
    sigma: float
    equally_good: bool


class PredictionAnswer(Answer):
    """The trend at the times asked for."""

    time: Annotated[list[WireTime], Field(description="In the form they came.")]
    value: list[float | None]
    confidence_low: Annotated[list[float | None], Field(description="Band of the trend itself.")]
    confidence_high: list[float | None]
    prediction_low: Annotated[list[float | None], Field(description="Band of a new inlier.")]
    prediction_high: list[float | None]
    level: float
    notices: list[NoticeAnswer]


class PointsAnswer(Answer):
    """One entry per input row, in input order."""

    time: Annotated[list[WireTime], Field(description="In the form they came.")]
    fit: list[float | None]
    inlier: list[bool]
    probability: Annotated[
        list[float | None],
        Field(description="Probability that the row follows the trend; null outside of the fit."),
    ]
    residual: list[float | None]
    reason: list[RowReason]


class NoiseAnswer(Answer):
    """Noise of an exponential: in which domain readings scatter about the trend."""

    domain: Annotated[
        Literal["multiplicative", "additive"],
        Field(
            description="`multiplicative`: a share of the level; `sigma`, `threshold`, `residual` and `rmse` "
            "are then of ln(value). `additive`: the same at every level."
        ),
    ]
    selection: Annotated[
        Literal["given", "selected", "undetermined", "method"],
        Field(
            description="Asked for; told from the data; undetermined, and the other answer is in "
            "`alternative`; or the only one the method knows."
        ),
    ]
    margin: Annotated[float | None, Field(description="Log evidence for it against the other.")]


class SeasonAnswer(Answer):
    """A periodic part of the trend; `season_1_amplitude` and `season_1_peak` are parameters of the first."""

    period: Annotated[float, Field(description="In the unit of time: seconds for points in time.")]
    harmonics: Annotated[int, Field(description="Pairs of cosine and sine.")]
    chosen: Annotated[bool, Field(description="Whether the period was found in the data, and not given.")]


class EvidenceAnswer(Answer):
    """A shape of trend that was weighed."""

    model: str
    degree: Annotated[int | None, Field(description="Of a polynomial.")]
    coefficients: int
    log_evidence: float
    margin: Annotated[float, Field(description="By how much it falls short of the best shape.")]
    sigma: float
    inliers: int
    chosen: bool


class TrendAnswer(Answer):
    """A robust trend through a series."""

    model: str
    method: str
    parameters: Annotated[
        dict[str, EstimateAnswer],
        Field(
            description="Of a line `slope` per unit of time (per second for points in time) and `intercept` "
            "at `origin`; `/v1/models` names those of other shapes."
        ),
    ]
    origin: Annotated[
        int | float | str,
        Field(description="Where the intercept is taken: the first time, 0 for plain numbers."),
    ]
    time_unit: Annotated[
        Literal["second"] | None, Field(description="Unit of time of the parameters; null for plain numbers.")
    ]
    p_value: Annotated[float | None, Field(description='Of "the slope is zero", valid after selection.')]
    r2: float | None
    rmse: float | None
    consensus: ConsensusAnswer
    uncertainty: UncertaintyAnswer
    runner_up: RunnerUpAnswer | None
    prediction: PredictionAnswer | None
    notices: list[NoticeAnswer]
    points: Annotated[PointsAnswer | None, Field(description="Left out with `points=false`.")] = None
    noise: Annotated[NoiseAnswer | None, Field(description="Of an exponential.")] = None
    derived: Annotated[
        dict[str, EstimateAnswer] | None,
        Field(
            description="Of an exponential: growth in per cent, `doubling_time` or `halving_time` in the "
            "unit of time (a limit at infinity is null), and `mean_factor`: the mean over the median."
        ),
    ] = None
    alternative: Annotated[
        TrendAnswer | None,
        Field(description="Answer under the other noise, where the data prefer neither; without `points`."),
    ] = None
    slope_per: Annotated[
        SlopeAnswer | None, Field(description="The slope in the unit that suits the span; null without one.")
    ]
    regimes: Annotated[
        list[RegimeAnswer] | None, Field(description="With `regime` `last`; the present one is the last.")
    ] = None
    crossings: Annotated[
        list[CrossingAnswer] | None, Field(description="For each value of `reach`, in their order.")
    ] = None
    seasons: Annotated[
        list[SeasonAnswer] | None, Field(description="Seasons fitted with the trend, if there are any.")
    ] = None
    evidence: Annotated[
        list[EvidenceAnswer] | None,
        Field(description="For each shape that the model `auto` weighed, the best first."),
    ] = None


class DescribedAnswer(Answer):
    """What people choose a method by."""

    name: str
    title: str
    summary: str
    when_to_use: str
    source: Annotated[str, Field(description="Where the method comes from.")]


class MethodAnswer(DescribedAnswer):
    """A named method."""

    robust: bool


class MethodsAnswer(Answer):
    """All methods."""

    methods: list[MethodAnswer]


class ModelAnswer(Answer):
    """A shape of trend."""

    name: str
    title: str
    equation: str
    parameters: list[str]
    summary: str


class ModelsAnswer(Answer):
    """All models."""

    models: list[ModelAnswer]


class HealthAnswer(Answer):
    """The process answers."""

    status: Literal["ok"]


class ReadyAnswer(Answer):
    """The service takes work."""

    status: Literal["ready"]
    kernels: Annotated[int, Field(description="Compiled entry points.")]
    loaded: Annotated[
        int, Field(description="Those loaded so far; the others are in the cache and loaded behind.")
    ]
