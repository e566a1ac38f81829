"""The uncertainty that was asked for, of a fitted line: by formula, or by running the whole procedure again.

``effective-n`` and ``hac`` are formulas. ``bootstrap`` and ``permutation`` fit resampled series, the choice
of the inliers included: a fixed set of inliers would reproduce the bias of having been chosen
(METHODS.md 12).
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.cancellation import Cancelled, cancel_flag
from estimators.consensus.found import Found, LineData
from estimators.inference.blocks import block_correction, block_length, drawn_blocks, shuffled_blocks
from estimators.inference.hac import long_run
from estimators.inference.resampled import permutation_p, widening
from estimators.inference.sandwich import LineUncertainty
from estimators.inference.scores import point_scores

UNCERTAINTIES: Mapping[str, str] = MappingProxyType(
    {
        "effective-n": "a formula; correlated neighbours count as fewer independent ones",
        "hac": "a formula; the correlation at all lags, in time, whatever its form",
        "bootstrap": "the whole procedure again on resampled blocks of residuals",
        "permutation": "p-value from the whole procedure on permuted values; intervals of effective-n",
    }
)
"""What ``fit_trend(uncertainty=...)`` takes, the default first, and how each is made."""

_COEFFICIENTS = 2

LEAST_REPLICATES = 50
"""Resampled series of the same structure that a quantile is taken from; the formula answers for fewer."""

LEAST_POINTS = 8
"""Fewer points than this have no resamples worth the name; the formula answers for them."""

_SAME_SIGMAS, _SAME_STDERRS = 1.0, 5.0
"""A replicate has found the same structure if it stays this near everywhere (METHODS_TRENDS: "The bed")."""


@dataclass(frozen=True, slots=True)
class Refit:
    """The procedure on a resampled series: the line in the frame, and its uncertainty by formula."""

    theta: FloatArray
    spread: LineUncertainty


@dataclass(frozen=True, slots=True)
class Inferred:
    """What was asked for.

    Attributes
    ----------
    spread : LineUncertainty or None
    p_value : float or None
        Where the method counts it; else it follows from the slope's interval.
    resamples : int or None
        Series that were fitted again.
    block : int or None
        Points per block.
    stability : float or None
        Share of resampled series in which the procedure found the same structure again.
    """

    spread: LineUncertainty | None
    p_value: float | None = None
    resamples: int | None = None
    block: int | None = None
    stability: float | None = None


@dataclass(frozen=True, slots=True)
class LineFit:
    """A fitted line and the means to fit it again.

    Attributes
    ----------
    data : LineData
    found : Found
    root : ndarray of float64, shape (n,), or None
        Square roots of the precisions.
    spread : LineUncertainty or None
        By ``effective-n``.
    independent : callable
        Makes the uncertainty for independent points.
    refit : callable
        Runs the whole procedure on other values at the same times; None where it finds no line.
    """

    data: LineData
    found: Found
    root: FloatArray | None
    spread: LineUncertainty | None
    independent: Callable[[], LineUncertainty | None]
    refit: Callable[[FloatArray], Refit | None]


def infer_line(line: LineFit, uncertainty: str, level: float, resamples: int, seed: int) -> Inferred:
    """Uncertainty of a line by the method asked for.

    Parameters
    ----------
    line : LineFit
    uncertainty : str
        One of :data:`UNCERTAINTIES`.
    level : float
        Confidence level of the answer.
    resamples, seed : int
        Of ``bootstrap`` and ``permutation``.

    Returns
    -------
    Inferred
        As by ``effective-n`` where the series is too short, or too exact, for the method.
    """
    spread = line.spread
    scatters = spread is not None and spread.slope_variance > 0.0 and spread.level_variance > 0.0
    if uncertainty == "effective-n" or not scatters or line.data.n < LEAST_POINTS or spread is None:
        return Inferred(spread)
    if uncertainty == "hac":
        return Inferred(_hac(line, spread))
    if uncertainty == "bootstrap":
        return _bootstrap(line, spread, level, resamples, seed)
    return _permutation(line, spread, resamples, seed)


def _hac(line: LineFit, spread: LineUncertainty) -> LineUncertainty:
    plain = line.independent()
    found, data = line.found, line.data
    scores = point_scores(found.residual, line.root, found.sigma, found.loss)
    longer = None if plain is None else long_run(data.t, scores, plain.center, spread.lag1)
    if plain is None or longer is None or longer.slope <= 0.0 or longer.level <= 0.0:
        return spread
    level, slope = plain.level_variance * longer.level, plain.slope_variance * longer.slope
    together = longer.correlation * math.sqrt(level * slope)
    return LineUncertainty(
        method="hac",
        center=plain.center - together / slope,
        level_variance=level - together * together / slope,
        slope_variance=slope,
        effective_n=max(plain.effective_n / longer.level, 1.0),
        lag1=spread.lag1,
        dof=min(longer.dof, spread.dof),
    )


def _bootstrap(line: LineFit, spread: LineUncertainty, level: float, resamples: int, seed: int) -> Inferred:
    """Symmetric studentised intervals from circular blocks of residuals, outliers among them."""
    data, found = line.data, line.found
    whitened = found.residual if line.root is None else found.residual * line.root
    fitted = data.y - found.residual
    block = block_length(data.n, spread.lag1)
    statistics: list[tuple[float, float]] = []
    for replicate in range(resamples):
        _stop_if_cancelled()
        noise = whitened[drawn_blocks(data.n, block, seed, replicate)]
        again = line.refit(fitted + (noise if line.root is None else noise / line.root))
        # Another structure says how stable the answer is, not how far off a right one may be.
        if again is not None and _is_same(line, spread, again.theta):
            statistics.append(_studentised(again, found.theta, spread.center))
    stability = len(statistics) / resamples
    if len(statistics) < LEAST_REPLICATES:
        return Inferred(spread, resamples=resamples, block=block, stability=stability)
    table = np.array(statistics) * block_correction(data.n, block, _COEFFICIENTS)
    levels, slopes = (widening(table[:, k], level, spread.dof) for k in (0, 1))
    widened = dataclasses.replace(
        spread,
        method="bootstrap",
        level_variance=spread.level_variance * levels * levels,
        slope_variance=spread.slope_variance * slopes * slopes,
    )
    return Inferred(widened, resamples=resamples, block=block, stability=stability)


def _permutation(line: LineFit, spread: LineUncertainty, resamples: int, seed: int) -> Inferred:
    """Rank of the studentised slope among those of the same values in another order."""
    data, found = line.data, line.found
    block = block_length(data.n, spread.lag1) if spread.lag1 > 0.0 else 1
    at_center = float(found.theta[0] + found.theta[1] * spread.center)
    whitened = data.y if line.root is None else (data.y - at_center) * line.root
    statistics: list[float] = []
    for replicate in range(resamples):
        _stop_if_cancelled()
        values = whitened[shuffled_blocks(data.n, block, seed, replicate)]
        again = line.refit(values if line.root is None else at_center + values / line.root)
        # A series without a line shows no slope.
        statistics.append(0.0 if again is None else _studentised(again, _NO_TREND, 0.0)[1])
    observed = _studentised(Refit(found.theta, spread), _NO_TREND, 0.0)[1]
    p_value = permutation_p(observed, np.array(statistics))
    return Inferred(
        dataclasses.replace(spread, method="permutation"), p_value, resamples=resamples, block=block
    )


_NO_TREND = np.zeros(2)


def _studentised(again: Refit, truth: FloatArray, center: float) -> tuple[float, float]:
    """Deviations of level at ``center`` and slope from the truth, in the replicate's own standard errors."""
    spread = again.spread
    level, slope = again.theta - truth
    away = center - spread.center
    level_stderr = math.sqrt(spread.level_variance + spread.slope_variance * away * away)
    slope_stderr = math.sqrt(spread.slope_variance)
    return _ratio(float(level + slope * center), level_stderr), _ratio(float(slope), slope_stderr)


def _ratio(deviation: float, stderr: float) -> float:
    if stderr > 0.0:
        return deviation / stderr
    return math.copysign(math.inf, deviation) if deviation else 0.0


def _is_same(line: LineFit, spread: LineUncertainty, theta: FloatArray) -> bool:
    for end in (-1.0, 1.0):
        off = theta[0] - line.found.theta[0] + end * (theta[1] - line.found.theta[1])
        stderr = math.sqrt(spread.level_variance + spread.slope_variance * (end - spread.center) ** 2)
        if abs(off) > max(_SAME_SIGMAS * line.found.sigma, _SAME_STDERRS * stderr):
            return False
    return True


def _stop_if_cancelled() -> None:
    if cancel_flag()[0]:
        raise Cancelled
