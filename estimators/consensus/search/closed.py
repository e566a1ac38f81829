"""Searches without samples: least squares, Huber, Theil-Sen and the repeated median as policies.

Each fits all points, takes the noise scale from the residuals unless it is given, and labels points by the
threshold. The ledger stays empty and there is no sampling probability.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from estimators.arrays import FloatArray, InputError
from estimators.consensus.found import Found, LinearData, Scale
from estimators.consensus.labelling.threshold import Threshold
from estimators.noise.mad import residual_scale
from estimators.options import RobustOptions
from estimators.regression.huber import HUBER, huber
from estimators.regression.least_squares import least_squares
from estimators.regression.loss import Loss, LossKind
from estimators.regression.repeated_median import (
    MAX_POINTS,
    TooManySlopesError,
    repeated_median,
    repeated_median_uncertainty,
)
from estimators.regression.theil_sen import MedianLine, theil_sen
from estimators.result import Ledger, NoFit, NoFitReason, Points, SearchKind

WEIGHTED_METHODS = ("ols", "huber", "mm")
"""Closed methods that take weights; Theil-Sen and the repeated median do not."""


@dataclass(frozen=True, slots=True)
class OrdinaryLeastSquares:
    """Least squares, for comparison: one outlier moves it as far as one likes."""

    needs_threshold: ClassVar[bool] = False

    def run(self, data: LinearData, scale: Scale, options: RobustOptions, seed: int) -> Found | NoFit:
        """Fit; sigma is sqrt(sum w r^2 / (n - p)) unless given."""
        del seed
        refused = refuse(data)
        if refused is not None:
            return refused
        theta, residual, _ = least_squares(data.columns, data.y, data.weights)
        squares = residual**2 if data.weights is None else data.weights * residual**2
        freedom = data.n - data.p
        estimated = math.sqrt(float(np.sum(squares)) / freedom) if freedom else 0.0
        return found_from_fit(data, scale, options, theta, residual, estimated, Loss(LossKind.square))


@dataclass(frozen=True, slots=True)
class HuberRegression:
    """Huber's M-estimate with constant 1.345; the scale is estimated alongside unless given."""

    needs_threshold: ClassVar[bool] = False

    def run(self, data: LinearData, scale: Scale, options: RobustOptions, seed: int) -> Found | NoFit:
        """Fit; sigma is the MAD of the residuals, corrected for few points, unless given."""
        del seed
        refused = refuse(data)
        if refused is not None:
            return refused
        fit = huber(data.columns, data.y, data.weights, sigma=scale.sigma, floor=scale.floor)
        estimated = residual_scale(fit.residual, data.p, data.weights)
        sigma, _ = _settle_sigma(scale, estimated, "residuals")
        # The estimate clips at 1.345 of the scale it was made with, whatever is reported as sigma.
        loss = Loss(LossKind.huber, HUBER.tuning * fit.sigma / sigma)
        return found_from_fit(data, scale, options, fit.theta, fit.residual, estimated, loss)


@dataclass(frozen=True, slots=True)
class TheilSen:
    """Theil-Sen line: median of the pairwise slopes, exact for any number of points."""

    needs_threshold: ClassVar[bool] = False

    def run(self, data: LinearData, scale: Scale, options: RobustOptions, seed: int) -> Found | NoFit:
        """Fit; sigma is the MAD of the residuals, corrected for few points, unless given."""
        del seed
        return _median_line(data, scale, options, theil_sen, "theil-sen", Loss(LossKind.rank))


@dataclass(frozen=True, slots=True)
class RepeatedMedian:
    """Siegel's repeated median line: the breakdown of 50 % without any tuning."""

    needs_threshold: ClassVar[bool] = False

    def run(self, data: LinearData, scale: Scale, options: RobustOptions, seed: int) -> Found | NoFit:
        """Fit; sigma is the MAD of the residuals, corrected for few points, unless given."""
        del seed
        try:
            found = _median_line(data, scale, options, repeated_median, "siegel", Loss(LossKind.sign))
        except TooManySlopesError as error:
            advice = (
                f"The repeated median would take minutes ({error}). It takes at most {MAX_POINTS} points: "
                "aggregate the series, or use theil-sen or auto."
            )
            return no_fit(NoFitReason.too_large, advice, data)
        if isinstance(found, NoFit):
            return found
        # No simple influence function: groups of points tell the variance.
        return replace(found, spread=repeated_median_uncertainty(data.columns[1], data.y))


def _median_line(
    data: LinearData,
    scale: Scale,
    options: RobustOptions,
    fit: Callable[[FloatArray, FloatArray], MedianLine],
    method: str,
    loss: Loss,
) -> Found | NoFit:
    if data.weights is not None:
        takers = ", ".join(WEIGHTED_METHODS)
        raise InputError("weights", f"{method} takes no weights; auto, the ransac family and {takers} do")
    if data.p != 2:
        raise InputError("method", f"{method} fits lines only; this model has {data.p} coefficients")
    refused = refuse(data)
    if refused is not None:
        return refused
    line = fit(data.columns[1], data.y)
    theta = np.array([line.intercept, line.slope])
    residual = data.y - (line.intercept + line.slope * data.columns[1])
    return found_from_fit(data, scale, options, theta, residual, residual_scale(residual, 2), loss)


def refuse(data: LinearData) -> NoFit | None:
    """Refuse data that determine no model, with the reason; None where they may."""
    if data.n == 0:
        return no_fit(NoFitReason.no_data, "There are no usable points.", data)
    if data.n < data.p:
        message = f"{data.n} usable points; the model needs at least {data.p}."
        return no_fit(NoFitReason.too_few_points, message, data)
    if data.p > 1:
        times = 1 + int(np.count_nonzero(data.t[1:] != data.t[:-1]))
        if times == 1:
            return no_fit(NoFitReason.constant_time, "All times are equal.", data)
        if times < data.p:
            message = f"Points at {times} different times; the model needs at least {data.p}."
            return no_fit(NoFitReason.too_few_points, message, data)
    return None


def no_fit(reason: NoFitReason, message: str, data: LinearData) -> NoFit:
    """Answer without a model: one row per point of ``data``, none an inlier."""
    n = data.n
    nothing = np.full(n, np.nan)
    points = Points(np.zeros(n, dtype=np.bool_), nothing, nothing.copy(), np.zeros(n, dtype=np.uint8))
    return NoFit(reason, message, points)


def found_from_fit(
    data: LinearData,
    scale: Scale,
    options: RobustOptions,
    theta: FloatArray,
    residual: FloatArray,
    estimated_sigma: float,
    loss: Loss,
    *,
    sigma_source: str = "residuals",
    ledger: Ledger | None = None,
    search: SearchKind = "closed",
) -> Found:
    """Complete a fit: settle the scale and the threshold, label the points.

    Parameters
    ----------
    data : LinearData
    scale : Scale
        What is given beforehand wins over what is estimated.
    options : RobustOptions
    theta : ndarray of float64, shape (p,)
    residual : ndarray of float64, shape (n,)
    estimated_sigma : float
        Raised to ``scale.floor`` where it is less.
    loss : Loss
    sigma_source : str
        Source named where the estimate is used.
    ledger : Ledger, optional
    search : {"closed", "sampled", "exhaustive"}

    Returns
    -------
    Found
        Without a sampling probability.
    """
    sigma, source = _settle_sigma(scale, estimated_sigma, sigma_source)
    threshold = options.threshold_sigmas * sigma if scale.threshold is None else scale.threshold
    whitened = residual if data.weights is None else residual * np.sqrt(data.weights)
    return Found(
        theta=theta,
        residual=residual,
        inlier=Threshold().labels(whitened, threshold),
        probability=None,
        sigma=sigma,
        sigma_source=source,
        threshold=threshold,
        threshold_source="sigma" if scale.threshold is None else scale.threshold_source,
        loss=loss,
        ledger=Ledger() if ledger is None else ledger,
        sampling_probability=None,
        search=search,
    )


def _settle_sigma(scale: Scale, estimated: float, source: str) -> tuple[float, str]:
    if scale.sigma is not None:
        return scale.sigma, scale.sigma_source
    if estimated <= scale.floor:
        return scale.floor, "floor"
    return estimated, source
