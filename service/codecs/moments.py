"""Times within the answers to questions, in the form they came."""

from __future__ import annotations

from typing import Any

import numpy as np

from estimators import Trend
from estimators.trends.presentation.question_forms import MOMENTS_OF_A_CROSSING, MOMENTS_OF_A_REGIME
from service.codecs.columns import TimeForm


def write_moments(answer: dict[str, Any], trend: Trend, form: TimeForm) -> None:
    """Write the times of regimes and crossings as epoch numbers.

    Parameters
    ----------
    answer : dict
        ``trend.to_dict()``; its lists are changed.
    trend : Trend
        Of points in time.
    form : TimeForm
        Of kind ``epoch``.
    """
    for told, regime in zip(answer.get("regimes", ()), trend.regimes, strict=True):
        told |= {name: _epoch(getattr(regime, name), form) for name in MOMENTS_OF_A_REGIME}
    for told, crossing in zip(answer.get("crossings", ()), trend.crossings, strict=True):
        told |= {name: _epoch(getattr(crossing, name), form) for name in MOMENTS_OF_A_CROSSING}


def _epoch(moment: np.datetime64 | None, form: TimeForm) -> Any:
    return None if moment is None else form.render(np.array([moment], dtype="datetime64[ns]"))[0]
