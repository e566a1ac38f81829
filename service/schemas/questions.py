"""Questions about a trend on the wire: how they are asked, and how they are answered.

The answers are key for key what :mod:`estimators.trends.presentation.questions` makes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from estimators.arrays import LARGEST_VALUE
from estimators.trends.questions.crossing import MOST_VALUES

Moment = int | float | str | None

Regime = Annotated[
    Literal["all", "last"],
    Field(
        description="`all` fits the whole series; `last` its present regime, the series since it last left "
        "its line for good. Earlier regimes are then listed in `regimes`; their rows take no part in the fit."
    ),
]
ReachedValue = Annotated[float, Field(ge=-LARGEST_VALUE, le=LARGEST_VALUE, allow_inf_nan=False)]
Reach = Annotated[
    ReachedValue | Annotated[list[ReachedValue], Field(min_length=1, max_length=MOST_VALUES)],
    Field(description="One value or several: when does the trend reach them? Answered in `crossings`."),
]
Horizon = Annotated[
    int | float | str,
    Field(
        description="Time, in the form of `time` and not before its last: how likely are the values of "
        "`reach` passed by then?"
    ),
]


def read_values(texts: Sequence[str]) -> list[float | str]:
    """Read values to reach that came as text, one each or separated by commas; what is no number stays text.

    Examples
    --------
    >>> read_values(["90,95.5", "x"])
    [90.0, 95.5, 'x']
    """
    return [_number(cell) for text in texts for cell in text.split(",")]


def _number(text: str) -> float | str:
    try:
        number = float(text)
    except ValueError:
        return text
    return number if math.isfinite(number) else text


class Answer(BaseModel):
    """Base of the answers: no key is undocumented."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class QuantityAnswer(Answer):
    """A number with its uncertainty; null where the data leave no way to tell."""

    value: float
    stderr: float | None
    low: float | None
    high: float | None


class SlopeAnswer(Answer):
    """The slope in the unit of time that suits the span."""

    unit: Annotated[
        Literal["second", "minute", "hour", "day", "year"] | None,
        Field(description="Null for plain numbers; a year has 365.25 days."),
    ]
    value: float
    low: float | None
    high: float | None


class RegimeAnswer(Answer):
    """A stretch of the series and the straight line that it follows."""

    start: Annotated[Moment, Field(description="First time, in the form they came.")]
    end: Annotated[Moment, Field(description="Last time.")]
    n: Annotated[int, Field(description="Usable rows in it.")]
    inliers: int
    slope: Annotated[
        QuantityAnswer | None,
        Field(description="Per unit of time; null where the rows determine no line."),
    ]
    level: Annotated[QuantityAnswer | None, Field(description="Of the line at `end`.")]


class CrossingAnswer(Answer):
    """When the trend reaches a value, seen from the last time of the data."""

    value: float
    direction: Annotated[Literal["up", "down"], Field(description="Whether beyond it is above or below.")]
    status: Annotated[
        Literal["crosses", "never", "already", "uncertain"],
        Field(description="What can be said at the confidence `level`."),
    ]
    time: Annotated[
        Moment,
        Field(
            description="When the fitted trend gets there; in the past if it is there already, null if it "
            "does not."
        ),
    ]
    low: Annotated[
        Moment, Field(description="Earliest; the last time of the data if it may be there already.")
    ]
    high: Annotated[Moment, Field(description="Latest; null if it may never get there.")]
    level: float
    horizon: Moment
    probability: Annotated[
        float | None, Field(description="That the trend is beyond the value at the horizon.")
    ]
    reading_probability: Annotated[float | None, Field(description="That a new inlier is.")]
