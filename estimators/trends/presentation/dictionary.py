"""A :class:`~estimators.trends.trend.Trend` as a JSON-safe dict, with the same keys as the wire format."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np

from estimators.arrays import FloatArray
from estimators.notices import notice_to_dict
from estimators.presentation.json_values import estimate_to_dict, numbers_to_json
from estimators.result import Uncertainty
from estimators.trends.bases.own import values_at_rows
from estimators.trends.presentation.json_values import origin_to_json, time_to_json
from estimators.trends.presentation.question_forms import crossing_to_dict, regime_to_dict
from estimators.trends.questions.slopes import slope_per_to_dict

if TYPE_CHECKING:
    from estimators.trends.prediction import Prediction
    from estimators.trends.trend import RunnerUp, Trend


def prediction_to_dict(prediction: Prediction) -> dict[str, Any]:
    """JSON-safe columns of a prediction."""
    return {
        "time": time_to_json(prediction.time),
        "value": numbers_to_json(prediction.value),
        "confidence_low": numbers_to_json(prediction.confidence_low),
        "confidence_high": numbers_to_json(prediction.confidence_high),
        "prediction_low": numbers_to_json(prediction.prediction_low),
        "prediction_high": numbers_to_json(prediction.prediction_high),
        "level": prediction.level,
        "notices": [notice_to_dict(item) for item in prediction.notices],
    }


def _runner_up_to_dict(runner_up: RunnerUp) -> dict[str, Any]:
    return {
        "parameters": dict(runner_up.parameters),
        "inliers": runner_up.inliers,
        "sigma": runner_up.sigma,
        "equally_good": runner_up.equally_good,
    }


def _resampling_to_dict(uncertainty: Uncertainty) -> dict[str, Any]:
    """Keys of methods that fit again; others have nothing to say about it."""
    if uncertainty.resamples is None:
        return {}
    return {
        "resamples": uncertainty.resamples,
        "block": uncertainty.block,
        "stability": uncertainty.stability,
    }


def trend_to_dict(trend: Trend, *, points: bool = True) -> dict[str, Any]:
    """JSON-safe form of an answer; the service's wire format has the same keys."""
    consensus = trend.consensus
    ledger = consensus.ledger
    answer: dict[str, Any] = {
        "model": trend.model,
        "method": consensus.method,
        "parameters": {name: estimate_to_dict(value) for name, value in trend.parameters.items()},
        "origin": origin_to_json(trend.origin),
        "time_unit": "second" if trend.axis.kind == "datetime" else None,
        "p_value": trend.p_value,
        "r2": trend.r2,
        "rmse": trend.rmse,
        "consensus": {
            "method": consensus.method,
            "n": consensus.n,
            "inliers": consensus.inliers,
            "inlier_ratio": consensus.inlier_ratio,
            "threshold": consensus.threshold,
            "threshold_source": consensus.threshold_source,
            "sigma": consensus.sigma,
            "sigma_source": consensus.sigma_source,
            "hypotheses": {
                "drawn": ledger.drawn,
                "degenerate": ledger.degenerate,
                "invalid": ledger.invalid,
                "scored": ledger.scored,
                "point_evaluations": ledger.point_evaluations,
                "optimizations": ledger.optimizations,
            },
            "sampling_probability": consensus.sampling_probability,
            "search": consensus.search,
            "seed": consensus.seed,
        },
        "uncertainty": {
            "method": trend.uncertainty.method,
            "level": trend.uncertainty.level,
            "effective_n": trend.uncertainty.effective_n,
            "lag1": trend.uncertainty.lag1,
            "dof": trend.uncertainty.dof,
            **_resampling_to_dict(trend.uncertainty),
        },
        "runner_up": None if trend.runner_up is None else _runner_up_to_dict(trend.runner_up),
        "prediction": None if trend.prediction is None else prediction_to_dict(trend.prediction),
        "notices": [notice_to_dict(item) for item in trend.notices],
    }
    if trend.noise is not None:
        noise = trend.noise
        answer["noise"] = {"domain": noise.domain, "selection": noise.selection, "margin": noise.margin}
    if trend.derived is not None:
        answer["derived"] = {name: estimate_to_dict(value) for name, value in trend.derived.items()}
    if trend.alternative is not None:
        answer["alternative"] = trend_to_dict(trend.alternative, points=False)
    answer["slope_per"] = slope_per_to_dict(trend)
    if trend.regimes:
        answer["regimes"] = [regime_to_dict(item) for item in trend.regimes]
    if trend.crossings:
        answer["crossings"] = [crossing_to_dict(item) for item in trend.crossings]
    if trend.seasons:
        answer["seasons"] = [dataclasses.asdict(season) for season in trend.seasons]
    if trend.evidence:
        answer["evidence"] = [dataclasses.asdict(item) for item in trend.evidence]
    if points:
        answer["points"] = {
            "time": time_to_json(trend.time),
            "fit": numbers_to_json(fitted_values(trend)),
            "inlier": trend.points.inlier.tolist(),
            "probability": numbers_to_json(trend.points.probability),
            "residual": numbers_to_json(trend.points.residual),
            "reason": trend.points.reason,
        }
    return answer


def fitted_values(trend: Trend) -> FloatArray:
    """Evaluate the trend at every input row; NaN where the time is missing or infinite."""
    internal = trend.axis.to_internal(trend.time)
    internal[~np.isfinite(internal)] = np.nan
    return values_at_rows(trend.geometry, internal)
