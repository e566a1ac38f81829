"""The answer of a trend fit: :class:`Trend` and its parts.

Frozen data with the few methods people expect on it: prediction, a summary, and the ways out
(``to_dict``, ``to_frame``, ``plot``). How the numbers come about is in :mod:`estimators.trends.fit`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from estimators.arrays import ArrayLike, FloatArray
from estimators.notices import Notice
from estimators.result import Consensus, Estimate, Points, Uncertainty
from estimators.time_axis import TimeAxis
from estimators.trends.bases.design import Season
from estimators.trends.curve import Curve
from estimators.trends.evidence import Evidence
from estimators.trends.exponential.domain import Noise
from estimators.trends.prediction import Prediction, predict
from estimators.trends.presentation import layout
from estimators.trends.presentation.dictionary import trend_to_dict
from estimators.trends.presentation.frame import trend_to_frame
from estimators.trends.presentation.report import describe
from estimators.trends.questions import comparison, crossing, slopes
from estimators.trends.questions.comparison import Difference
from estimators.trends.questions.crossing import Crossing
from estimators.trends.regimes.regime import Regime

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True)
class RunnerUp:
    """The best trend among the points that the answer calls outliers.

    Attributes
    ----------
    parameters : mapping of str to float
        Same names and units as the answer's.
    inliers : int
        Points that follow it and not the answer.
    sigma : float
        Its noise scale.
    equally_good : bool
        Whether the data hardly prefer the answer to it.
    """

    parameters: Mapping[str, float]
    inliers: int
    sigma: float
    equally_good: bool


@dataclass(frozen=True, slots=True)
class Trend:
    """A robust trend through a time series.

    Attributes
    ----------
    model : str
        Name of the shape; see :func:`estimators.models`.
    parameters : mapping of str to Estimate
        Of a line ``"slope"`` per unit of time (per second for points in time) and ``"intercept"``, the value
        at ``origin``.
    origin : float or numpy.datetime64
        Where the intercept is taken: the first time, or 0 for plain numbers.
    points : Points
        One entry per input row, in input order.
    consensus : Consensus
        What the algorithm did.
    uncertainty : Uncertainty
        How the intervals were made.
    p_value : float or None
        Of "the slope is zero", valid after selection (METHODS.md 12).
    r2, rmse : float or None
        On inliers; r2 is None where the inliers do not vary.
    runner_up : RunnerUp or None
    notices : tuple of Notice
    prediction : Prediction or None
        At the times asked for with the fit.
    geometry : Curve
        The fitted curve, at times since ``axis.origin``.
    time, values : ndarray
        The caller's series as numbers or datetime64[ns], in input order, for frames and pictures.
    noise : Noise or None
        Of an exponential: whether readings scatter by a share of the level or alike at every level.
    derived : mapping of str to Estimate, or None
        What follows from the parameters, such as a doubling time; limits at infinity are None.
    alternative : Trend or None
        Answer under the other noise, where the data prefer neither.
    seasons : tuple of Season
        Fitted together with the trend; their amplitudes and peaks are among the parameters.
    evidence : tuple of Evidence
        For each shape that ``model="auto"`` weighed, the best first.
    regimes : tuple of Regime
        With ``regime="last"``, the present one last.
    crossings : tuple of Crossing
        For the values to reach that were asked for with the fit.
    """

    model: str
    parameters: Mapping[str, Estimate]
    origin: float | np.datetime64
    points: Points
    consensus: Consensus
    uncertainty: Uncertainty
    p_value: float | None
    r2: float | None
    rmse: float | None
    runner_up: RunnerUp | None
    notices: tuple[Notice, ...]
    axis: TimeAxis
    geometry: Curve
    time: np.ndarray[Any, Any] = field(repr=False)
    values: FloatArray = field(repr=False)
    prediction: Prediction | None = None
    noise: Noise | None = None
    derived: Mapping[str, Estimate] | None = None
    alternative: Trend | None = None
    seasons: tuple[Season, ...] = ()
    evidence: tuple[Evidence, ...] = ()
    regimes: tuple[Regime, ...] = ()
    crossings: tuple[Crossing, ...] = ()

    def predict(self, times: ArrayLike, level: float | None = None, columns: Any = None) -> Prediction:
        """Trend, confidence band and prediction band at given times.

        Parameters
        ----------
        times : array_like, shape (k,), or one time
            Of the same kind as the series; points in time may be ISO 8601.
        level : float, optional
            Confidence level; default that of the fit.
        columns : mapping of str to array_like, or array_like of shape (k,) or (k, m), optional
            The columns that the trend was fitted with, at these times; default their means.

        Returns
        -------
        Prediction

        Raises
        ------
        InputError
            If the times are of another kind or too large, the level is not between 0 and 1, or the columns
            are not those of the fit.

        Examples
        --------
        >>> import numpy as np
        >>> from estimators import fit_trend
        >>> trend = fit_trend(np.arange(20.0), 3.0 + 2.0 * np.arange(20.0))
        >>> float(round(trend.predict([30.0]).value[0], 6))
        63.0
        """
        return predict(self, times, level, columns)

    def time_to(
        self,
        value: float,
        *,
        horizon: Any = None,
        direction: Literal["up", "down"] | None = None,
        level: float | None = None,
    ) -> Crossing:
        """When the trend reaches a value, and how sure that is.

        Parameters
        ----------
        value : float
        horizon : time, optional
            Of the kind of the series, not before its last time: how likely is it that the value is passed
            by then?
        direction : {"up", "down"}, optional
            Whether beyond is above or below (default: the way from the last level to the value, unless the
            trend has surely come from there).
        level : float, optional
            Confidence level; default that of the fit.

        Returns
        -------
        Crossing

        Raises
        ------
        InputError

        Examples
        --------
        >>> import numpy as np
        >>> from estimators import fit_trend
        >>> trend = fit_trend(np.arange(20.0), 3.0 + 2.0 * np.arange(20.0))
        >>> full = trend.time_to(90.0)
        >>> full.status, round(full.time, 6)
        ('crosses', 43.5)
        """
        return crossing.time_to(self, value, horizon, direction, level)

    def differs_from(self, other: Trend, level: float | None = None) -> Difference:
        """Whether the slope differs from that of another trend, of other data (Welch's test).

        Raises
        ------
        InputError
            If one of them has no slope, or their times are of different kinds.
        """
        return comparison.differs_from(self, other, level)

    def slope_per(self, unit: str | None = None) -> Estimate:
        """Slope per ``"second"``, ``"minute"``, ``"hour"``, ``"day"``, ``"week"`` or ``"year"``.

        Parameters
        ----------
        unit : str, optional
            Default: the unit that suits the span; for plain numbers the only one there is.

        Raises
        ------
        InputError
            If there is no such unit, or no slope.
        """
        return slopes.slope_per(self, unit)

    def summary(self) -> str:
        """Text for people: the trend, its uncertainty, the outliers and the warnings."""
        return layout.to_text(describe(self))

    def to_dict(self, *, points: bool = True) -> dict[str, Any]:
        """JSON-safe form, the same as the service answers.

        Parameters
        ----------
        points : bool
            Whether to include the columns per input row.
        """
        return trend_to_dict(self, points=points)

    def to_frame(self) -> pd.DataFrame:
        """One row per input row: time, value, fit, bands, inlier, probability, residual, reason.

        Raises
        ------
        ImportError
            If pandas is not installed (extra ``[pandas]``).
        """
        return trend_to_frame(self)

    def plot(self, **style: Any) -> Figure:
        """Picture of the series, the trend, its bands and the outliers (extra ``[plot]``).

        Parameters
        ----------
        **style
            ``width_px``, ``height_px``, ``theme`` (``"light"`` or ``"dark"``) and ``title``; see
            :func:`estimators.adapters.plotting.trend_figure`.

        Raises
        ------
        ImportError
            If matplotlib is not installed (extra ``[plot]``).
        """
        from estimators.adapters.plotting import trend_figure  # noqa: PLC0415

        return trend_figure(self, **style)

    def _repr_html_(self) -> str:
        return layout.to_html(describe(self))
