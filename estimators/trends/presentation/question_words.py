"""Answers to questions in words: the regimes of a series, and when its trend reaches a value."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from estimators.trends.presentation.units import moment_text, percent, rounded, significant, slope_unit

if TYPE_CHECKING:
    from estimators.trends.questions.crossing import Crossing
    from estimators.trends.regimes.regime import Regime
    from estimators.trends.trend import Trend

_REGIMES_TOLD = 3
_AN_HOUR = np.timedelta64(1, "h")


def question_facts(trend: Trend) -> Iterable[tuple[str, str]]:
    """Yield label and sentence of every answer to a question.

    Parameters
    ----------
    trend : Trend

    Yields
    ------
    tuple of (str, str)
    """
    if trend.regimes:
        yield "Regimes", _regimes_sentence(trend)
    for crossing in trend.crossings:
        yield f"Reaches {significant(crossing.value, 6)}", crossing_sentence(crossing)


def _regimes_sentence(trend: Trend) -> str:
    *earlier, present = trend.regimes
    if not earlier:
        return "one; the series has followed one line throughout"
    text = f"{len(trend.regimes)}; the present one since {moment_text(present.start)}; before: "
    told = [_regime_text(trend, regime) for regime in reversed(earlier[-_REGIMES_TOLD:])]
    more = [f"{len(earlier) - _REGIMES_TOLD} more"] if len(earlier) > _REGIMES_TOLD else []
    return text + "; ".join([*told, *more])


def _regime_text(trend: Trend, regime: Regime) -> str:
    from_to = f"{moment_text(regime.start)} to {moment_text(regime.end)}"
    if regime.slope is None:
        return from_to
    unit = slope_unit(trend)
    slope = regime.slope.scaled(unit.seconds)
    return f"{from_to}, slope {rounded(slope.value, slope.stderr)}{unit.per}"


def _told(crossing: Crossing, moment: float | np.datetime64) -> str:
    """Time with the digits that its interval supports; points in time to the minute, or to the second."""
    low, high = crossing.low, crossing.high
    if isinstance(moment, np.datetime64):
        unit, half = "m", 30_000
        if isinstance(low, np.datetime64) and isinstance(high, np.datetime64) and high - low < _AN_HOUR:
            unit, half = "s", 500
        return moment_text((moment + np.timedelta64(half, "ms")).astype(f"datetime64[{unit}]"))
    if isinstance(low, float) and isinstance(high, float):
        return rounded(moment, 0.5 * (high - low))
    return significant(moment, 6)


def crossing_sentence(crossing: Crossing) -> str:
    """Say when a value is reached.

    Parameters
    ----------
    crossing : Crossing
    """
    if crossing.status == "already":
        text = "already beyond" if crossing.time is None else f"since {_told(crossing, crossing.time)}"
    elif crossing.status == "never":
        text = "never, as the trend goes"
    else:
        text = "perhaps never" if crossing.time is None else _told(crossing, crossing.time)
        if crossing.low is not None:
            end = "never" if crossing.high is None else _told(crossing, crossing.high)
            text += f" ({100 * crossing.level:g} %: {_told(crossing, crossing.low)} to {end})"
        if crossing.status == "uncertain":
            text += "; uncertain"
    if crossing.horizon is None or crossing.probability is None:
        return text
    return f"{text}; by {moment_text(crossing.horizon)} with probability {percent(crossing.probability)}"
