"""How a :class:`~estimators.trends.trend.Trend` leaves Python: JSON-safe dict, data frame, text and HTML.

Dict and frame are made here; what people read is worded in :mod:`estimators.trends.report` and only
passed on. Columns are converted as whole arrays: 1e5 points take milliseconds, not seconds.
"""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from estimators.arrays import FloatArray, Reason
from estimators.result import Estimate, Uncertainty, notice_to_dict
from estimators.trends import answers, layout
from estimators.trends.bases.own import columns_at_rows, values_at_rows
from estimators.trends.report import describe
from estimators.trends.slopes import slope_per_to_dict

if TYPE_CHECKING:
    import pandas as pd

    from estimators.trends.trend import Prediction, RunnerUp, Trend


def time_to_json(times: np.ndarray[Any, Any]) -> list[Any]:
    """Numbers stay numbers (integers exactly); points in time become ISO 8601 in UTC; missing times None."""
    if times.dtype.kind == "M":
        return _iso_column(times.astype("datetime64[ns]"))
    if times.dtype.kind in "iu":
        return list(times.tolist())
    return numbers_to_json(np.asarray(times, dtype=np.float64))


def _iso_column(moments: np.ndarray[Any, np.dtype[np.datetime64]]) -> list[str | None]:
    missing = np.isnat(moments)
    whole_seconds = moments.astype("datetime64[s]")
    if np.all(missing | (whole_seconds == moments)):
        texts: list[str | None] = [f"{text}Z" for text in np.datetime_as_string(whole_seconds).tolist()]
    else:
        texts = [_with_zone(text) for text in np.datetime_as_string(moments).tolist()]
    for row in np.flatnonzero(missing).tolist():
        texts[row] = None
    return texts


def _with_zone(text: str) -> str:
    """ISO 8601 text without the zeros that end its fraction, and with ``Z``."""
    head, _, fraction = text.partition(".")
    fraction = fraction.rstrip("0")
    return f"{head}.{fraction}Z" if fraction else f"{head}Z"


def iso_utc(moment: np.datetime64) -> str:
    """ISO 8601 with ``Z``, as few decimals of a second as the moment needs."""
    return _with_zone(str(moment.astype("datetime64[ns]")))


def numbers_to_json(values: FloatArray) -> list[float | None]:
    """Floats with None for what is not finite."""
    if np.isfinite(values).all():
        return list(values.tolist())
    return [value if math.isfinite(value) else None for value in values.tolist()]


def estimate_to_dict(estimate: Estimate) -> dict[str, float | None]:
    """JSON-safe form of an estimate."""
    return {
        "value": estimate.value,
        "stderr": estimate.stderr,
        "low": estimate.low,
        "high": estimate.high,
    }


def origin_to_json(origin: float | np.datetime64) -> float | str:
    """Origin as a number or ISO 8601."""
    if isinstance(origin, np.datetime64):
        return iso_utc(origin)
    # A large integer, such as epoch nanoseconds, would lose digits as a float.
    return int(origin) if isinstance(origin, int) else float(origin)


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
        answer["regimes"] = [answers.regime_to_dict(item) for item in trend.regimes]
    if trend.crossings:
        answer["crossings"] = [answers.crossing_to_dict(item) for item in trend.crossings]
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


def summary(trend: Trend) -> str:
    """Text for people, 80 columns wide: see :mod:`estimators.trends.report`."""
    return layout.to_text(describe(trend))


def to_html(trend: Trend) -> str:
    """Notebook representation: one escaped table, no scripts."""
    return layout.to_html(describe(trend))


def trend_to_frame(trend: Trend) -> pd.DataFrame:
    """One row per input row, in input order.

    Parameters
    ----------
    trend : Trend

    Returns
    -------
    pandas.DataFrame
        With a RangeIndex and the columns ``time`` (datetime64 stays datetime64), ``value``, ``fit``,
        ``confidence_low``, ``confidence_high``, ``prediction_low``, ``prediction_high`` (at the level of
        the fit; NaN where the time is missing or the data leave no way to tell), ``inlier``,
        ``probability``, ``residual`` and ``reason`` (categorical).

    Raises
    ------
    ImportError
        If pandas is not installed (extra ``[pandas]``).
    """
    import pandas as pd  # noqa: PLC0415

    known = np.isfinite(trend.axis.to_internal(trend.time))
    bands = trend.predict(trend.time[known], columns=columns_at_rows(trend.geometry, known))

    def on_known_rows(values: FloatArray) -> FloatArray:
        column = np.full(known.size, np.nan)
        column[known] = values
        return column

    names = pd.Index([member.name for member in Reason])
    return pd.DataFrame(
        {
            "time": trend.time,
            "value": trend.values,
            "fit": on_known_rows(bands.value),
            "confidence_low": on_known_rows(bands.confidence_low),
            "confidence_high": on_known_rows(bands.confidence_high),
            "prediction_low": on_known_rows(bands.prediction_low),
            "prediction_high": on_known_rows(bands.prediction_high),
            "inlier": trend.points.inlier,
            "probability": trend.points.probability,
            "residual": trend.points.residual,
            "reason": pd.Categorical.from_codes(trend.points.reason_codes.astype(np.int8), categories=names),
        }
    )
