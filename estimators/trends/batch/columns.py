"""The columns of a table while they are filled: every slice writes the rows of its own series."""

from __future__ import annotations

from typing import Any

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.result import NoFit, Points
from estimators.trends.batch.source import Source
from estimators.trends.models import MODELS
from estimators.trends.questions.crossing import Crossing
from estimators.trends.regimes.regime import Regime
from estimators.trends.table import Estimates, TrendTable
from estimators.trends.trend import Trend

NUMBERS = (
    "inlier_ratio",
    "sigma",
    "threshold",
    "p_value",
    "r2",
    "rmse",
    "effective_n",
    "lag1",
    "dof",
)
"""Columns of float64 besides the parameters."""


class Columns:
    """Empty columns of a table.

    Parameters
    ----------
    source : Source
    keep_points : bool
        Whether to hold one entry per input row.
    """

    def __init__(self, source: Source, *, keep_points: bool) -> None:
        series, total = source.series, source.values.size
        self.source = source
        self.fitted: BoolArray = np.zeros(series, dtype=np.bool_)
        dated = source.times.dtype.kind == "M"
        self.origin: np.ndarray[Any, Any] = (
            np.full(series, "NaT", dtype="datetime64[ns]") if dated else np.full(series, np.nan)
        )
        self.n: IntArray = np.zeros(series, dtype=np.int64)
        self.inliers: IntArray = np.zeros(series, dtype=np.int64)
        self.numbers: dict[str, FloatArray] = {name: np.full(series, np.nan) for name in NUMBERS}
        self.parameters: dict[str, Estimates] = {}
        for name in MODELS[source.settings.model].parameters:
            self.estimates(name)
        self.models = [source.settings.model] * series
        self.noise = [""] * series
        self.regimes: list[tuple[Regime, ...]] = [()] * series
        self.crossings: list[tuple[Crossing, ...]] = [()] * series
        self.reason = [""] * series
        self.message = [""] * series
        self.notices: list[tuple[str, ...]] = [()] * series
        self.points: Points | None = None
        if keep_points:
            self.points = Points(
                np.zeros(total, dtype=np.bool_),
                np.full(total, np.nan),
                np.full(total, np.nan),
                np.zeros(total, dtype=np.uint8),
            )

    def estimates(self, name: str) -> Estimates:
        """Columns of a parameter, made when the first series has it."""
        columns = self.parameters.get(name)
        if columns is None:
            empty = [np.full(self.fitted.size, np.nan) for _ in range(4)]
            columns = self.parameters.setdefault(name, Estimates(*empty))
        return columns

    def write(self, k: int, answer: Trend | NoFit) -> None:
        """Write the row of a series that was fitted alone."""
        self.notices[k] = tuple(item.code.value for item in answer.notices)
        self._write_points(k, answer.points)
        if isinstance(answer, NoFit):
            self.reason[k], self.message[k] = answer.reason.value, answer.message
            return
        self.fitted[k] = True
        self.models[k] = answer.model
        self.noise[k] = "" if answer.noise is None else answer.noise.domain
        self.regimes[k], self.crossings[k] = answer.regimes, answer.crossings
        self.origin[k] = answer.origin
        for name, estimate in answer.parameters.items():
            columns = self.estimates(name)
            columns.value[k] = estimate.value
            columns.stderr[k] = _number(estimate.stderr)
            columns.low[k] = _number(estimate.low)
            columns.high[k] = _number(estimate.high)
        consensus, uncertainty = answer.consensus, answer.uncertainty
        self.n[k], self.inliers[k] = consensus.n, consensus.inliers
        row = {
            "inlier_ratio": consensus.inlier_ratio,
            "sigma": consensus.sigma,
            "threshold": consensus.threshold,
            "p_value": answer.p_value,
            "r2": answer.r2,
            "rmse": answer.rmse,
            "effective_n": uncertainty.effective_n,
            "lag1": uncertainty.lag1,
            "dof": uncertainty.dof,
        }
        for name, value in row.items():
            self.numbers[name][k] = _number(value)

    def _write_points(self, k: int, points: Points) -> None:
        if self.points is None:
            return
        rows = slice(int(self.source.offsets[k]), int(self.source.offsets[k + 1]))
        self.points.inlier[rows] = points.inlier
        self.points.probability[rows] = points.probability
        self.points.residual[rows] = points.residual
        self.points.reason_codes[rows] = points.reason_codes

    def to_table(self, names: tuple[str, ...] | None) -> TrendTable:
        """Close the columns; of the parameters that a model may have, those stay that some series has."""
        asked = self.source.settings
        met = {name: one for name, one in self.parameters.items() if not np.isnan(one.value).all()}
        return TrendTable(
            model=asked.model,
            method=asked.method,
            level=asked.level,
            seed=asked.seed,
            offsets=self.source.offsets,
            names=names,
            fitted=self.fitted,
            reason=tuple(self.reason),
            message=tuple(self.message),
            models=tuple(
                model if fitted else "" for model, fitted in zip(self.models, self.fitted, strict=True)
            ),
            noise=tuple(self.noise),
            regimes=tuple(self.regimes),
            crossings=tuple(self.crossings),
            origin=self.origin,
            parameters=met or self.parameters,
            n=self.n,
            inliers=self.inliers,
            **self.numbers,
            notices=tuple(self.notices),
            source=self.source,
            labels=self.points,
        )


def _number(value: float | None) -> float:
    return np.nan if value is None else value
