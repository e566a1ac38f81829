"""Answers to questions about a trend in JSON-safe form: regimes and crossings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from estimators.presentation.json_values import estimate_to_dict
from estimators.trends.presentation.json_values import time_to_json

if TYPE_CHECKING:
    from estimators.trends.questions.crossing import Crossing
    from estimators.trends.regimes.regime import Regime

MOMENTS_OF_A_CROSSING = ("time", "low", "high", "horizon")
MOMENTS_OF_A_REGIME = ("start", "end")
"""Keys under which times stand, which the service writes in the form they came."""


def crossing_to_dict(crossing: Crossing) -> dict[str, Any]:
    """JSON-safe form of a crossing."""
    return {
        "value": crossing.value,
        "direction": crossing.direction,
        "status": crossing.status,
        "time": _moment(crossing.time),
        "low": _moment(crossing.low),
        "high": _moment(crossing.high),
        "level": crossing.level,
        "horizon": _moment(crossing.horizon),
        "probability": crossing.probability,
        "reading_probability": crossing.reading_probability,
    }


def regime_to_dict(regime: Regime) -> dict[str, Any]:
    """JSON-safe form of a regime."""
    return {
        "start": _moment(regime.start),
        "end": _moment(regime.end),
        "n": regime.n,
        "inliers": regime.inliers,
        "slope": None if regime.slope is None else estimate_to_dict(regime.slope),
        "level": None if regime.level is None else estimate_to_dict(regime.level),
    }


def _moment(moment: Any) -> Any:
    """Time as a number or ISO 8601."""
    return None if moment is None else time_to_json(np.asarray([moment]))[0]
