"""The answer of many fits: :class:`TrendTable`, one row per series, as columns.

A column per number, so that a million series stay a dozen arrays. A single :class:`Trend` is made when it
is asked for, by fitting its series again: it equals its row to the bit, and what the columns leave out
(runner-up, ledger, geometry) need not be kept for all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from estimators.arrays import BoolArray, FloatArray, InputError, IntArray
from estimators.presentation.json_values import numbers_to_json
from estimators.result import NoFit, Points
from estimators.trends.batch.source import Source
from estimators.trends.presentation.json_values import time_to_json
from estimators.trends.questions.crossing import Crossing
from estimators.trends.regimes.regime import Regime
from estimators.trends.trend import Trend

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True, eq=False)
class Estimates:
    """One parameter of all series.

    Attributes
    ----------
    value, stderr, low, high : ndarray of float64, shape (series,)
        NaN where there is none.
    """

    value: FloatArray
    stderr: FloatArray
    low: FloatArray
    high: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class TrendTable:
    """Robust trends through many series; ``table[k]`` is the :class:`Trend` or :class:`NoFit` of series k.

    Attributes
    ----------
    model, method : str
    level : float
        Confidence level of all intervals.
    seed : int
    offsets : ndarray of int64, shape (series + 1,)
        Series k is rows ``offsets[k]:offsets[k + 1]``.
    names : tuple of str, or None
    fitted : ndarray of bool, shape (series,)
    reason, message : tuple of str
        Why there is no trend; empty where there is one.
    models : tuple of str
        Shape of each trend: with ``model="auto"`` the one chosen; empty where nothing was fitted.
    noise : tuple of str
        Of an exponential ``"multiplicative"`` or ``"additive"``; empty where there is none to tell.
    regimes, crossings : tuple of tuple
        As in :class:`Trend`, for ``regime`` and ``reach``; empty where they were not asked for.
    origin : ndarray of float64 or datetime64[ns], shape (series,)
        Where intercepts are taken; NaN or NaT where nothing was fitted.
    parameters : mapping of str to Estimates
        ``"slope"`` and ``"intercept"`` of a line, as :attr:`Trend.parameters`.
    n, inliers : ndarray of int64, shape (series,)
        0 where nothing was fitted.
    inlier_ratio, sigma, threshold, p_value, r2, rmse, effective_n, lag1, dof : ndarray of float64
        As in :class:`Trend`, shape (series,); NaN where there is none.
    notices : tuple of tuple of str
        Codes of :class:`estimators.notices.NoticeCode` per series.

    Examples
    --------
    >>> import numpy as np
    >>> from estimators import fit_trends
    >>> t = np.arange(20.0)
    >>> table = fit_trends(t, np.array([1.0 + 2.0 * t, 5.0 - t]), names=["up", "down"])
    >>> len(table), table.names, table.parameters["slope"].value.round(9)
    (2, ('up', 'down'), array([ 2., -1.]))
    >>> round(table[1].parameters["intercept"].value, 9)
    5.0
    """

    model: str
    method: str
    level: float
    seed: int
    offsets: IntArray
    names: tuple[str, ...] | None
    fitted: BoolArray
    reason: tuple[str, ...]
    message: tuple[str, ...]
    models: tuple[str, ...]
    noise: tuple[str, ...]
    regimes: tuple[tuple[Regime, ...], ...]
    crossings: tuple[tuple[Crossing, ...], ...]
    origin: np.ndarray[Any, Any]
    parameters: Mapping[str, Estimates]
    n: IntArray
    inliers: IntArray
    inlier_ratio: FloatArray
    sigma: FloatArray
    threshold: FloatArray
    p_value: FloatArray
    r2: FloatArray
    rmse: FloatArray
    effective_n: FloatArray
    lag1: FloatArray
    dof: FloatArray
    notices: tuple[tuple[str, ...], ...]
    source: Source = field(repr=False)
    labels: Points | None = field(repr=False)

    @property
    def points(self) -> Points:
        """One entry per input row of all series, in input order.

        Raises
        ------
        InputError
            If the table was made with ``points=False``.
        """
        if self.labels is None:
            raise InputError("points", "the rows were not kept; fit with points=True")
        return self.labels

    def __len__(self) -> int:
        return int(self.fitted.size)

    def __getitem__(self, k: int) -> Trend | NoFit:
        """Answer of series k, equal to that of ``fit_trend`` in every field; negative k count from the end.

        The series is fitted again: reading a column of the table is the fast way to one number of many.
        """
        size = len(self)
        if not -size <= k < size:
            raise IndexError(f"there are {size} series")
        return self.source.answer(k % size)

    def __iter__(self) -> Iterator[Trend | NoFit]:
        return (self.source.answer(k) for k in range(len(self)))

    def to_frame(self) -> pd.DataFrame:
        """One row per series.

        Returns
        -------
        pandas.DataFrame
            Indexed by name (or number), with the columns ``fitted``, ``reason``, ``message``, ``model``,
            ``origin``, of each parameter its name and ``_stderr``, ``_low``, ``_high``, and the other columns
            of the table; ``notices`` are codes separated by spaces.

        Raises
        ------
        ImportError
            If pandas is not installed (extra ``[pandas]``).
        """
        import pandas as pd  # noqa: PLC0415

        columns: dict[str, Any] = {
            "fitted": self.fitted,
            "reason": pd.Categorical(self.reason),
            "message": list(self.message),
            "model": pd.Categorical(self.models),
            "origin": self.origin,
        }
        for name, estimates in self.parameters.items():
            columns[name] = estimates.value
            columns[f"{name}_stderr"] = estimates.stderr
            columns[f"{name}_low"] = estimates.low
            columns[f"{name}_high"] = estimates.high
        columns |= self._numbers()
        columns["notices"] = [" ".join(codes) for codes in self.notices]
        index = pd.RangeIndex(len(self)) if self.names is None else pd.Index(self.names, name="series")
        return pd.DataFrame(columns, index=index)

    def to_dict(self, *, points: bool = False) -> dict[str, Any]:
        """JSON-safe columns, None where there is no number.

        Parameters
        ----------
        points : bool
            Whether to include the columns per input row.

        Raises
        ------
        InputError
            If the rows are asked for and were not kept.
        """
        answer: dict[str, Any] = {
            "model": self.model,
            "method": self.method,
            "level": self.level,
            "seed": self.seed,
            "series": None if self.names is None else list(self.names),
            "fitted": self.fitted.tolist(),
            "reason": [reason or None for reason in self.reason],
            "message": [message or None for message in self.message],
            "models": [model or None for model in self.models],
            "origin": time_to_json(self.origin),
            "parameters": {
                name: {
                    "value": numbers_to_json(estimates.value),
                    "stderr": numbers_to_json(estimates.stderr),
                    "low": numbers_to_json(estimates.low),
                    "high": numbers_to_json(estimates.high),
                }
                for name, estimates in self.parameters.items()
            },
        }
        for name, column in self._numbers().items():
            answer[name] = column.tolist() if column.dtype.kind == "i" else numbers_to_json(column)
        answer["notices"] = [list(codes) for codes in self.notices]
        if points:
            rows = self.points
            answer["points"] = {
                "offsets": self.offsets.tolist(),
                "inlier": rows.inlier.tolist(),
                "probability": numbers_to_json(rows.probability),
                "residual": numbers_to_json(rows.residual),
                "reason": rows.reason,
            }
        return answer

    def _numbers(self) -> dict[str, np.ndarray[Any, Any]]:
        return {
            "n": self.n,
            "inliers": self.inliers,
            "inlier_ratio": self.inlier_ratio,
            "sigma": self.sigma,
            "threshold": self.threshold,
            "p_value": self.p_value,
            "r2": self.r2,
            "rmse": self.rmse,
            "effective_n": self.effective_n,
            "lag1": self.lag1,
            "dof": self.dof,
        }
