"""The uncertainty that was asked for, of any fitted shape: by formula, or by running the procedure again.

``effective-n`` and ``hac`` are formulas. ``bootstrap`` and ``permutation`` fit resampled series, the choice
of the inliers included: a fixed set of inliers would reproduce the bias of having been chosen
(METHODS.md 12). A shape hands in :class:`Fitted`: its values, its axes and the means to fit it again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Generic, TypeVar

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.cancellation import stop_if_cancelled
from estimators.inference.blocks import block_correction, block_length, drawn_blocks, shuffled_blocks
from estimators.inference.hac import long_run
from estimators.inference.resampled import permutation_p, widening
from estimators.inference.spread import Spread
from estimators.result import Uncertainty

UNCERTAINTIES: Mapping[str, str] = MappingProxyType(
    {
        "effective-n": "a formula; correlated neighbours count as fewer independent ones",
        "hac": "a formula; the correlation at all lags, in time, whatever its form",
        "bootstrap": "the whole procedure again on resampled blocks of residuals",
        "permutation": "p-value from the whole procedure on permuted values; intervals of effective-n",
    }
)
"""What ``fit_trend(uncertainty=...)`` takes, the default first, and how each is made."""

LEAST_REPLICATES = 50
"""Resampled series of the same structure that a quantile is taken from; the formula answers for fewer."""

LEAST_POINTS = 8
"""Fewer points than this have no resamples worth the name; the formula answers for them."""

_SAME_SIGMAS, _SAME_STDERRS = 1.0, 5.0
"""A replicate has found the same structure if it stays this near everywhere (METHODS_TRENDS: "The bed")."""

_Spread = TypeVar("_Spread", bound=Spread)


@dataclass(frozen=True, slots=True)
class Scored:
    """What each point says about the coefficients.

    Attributes
    ----------
    t, scores : ndarray of float64, shape (n,)
        Time, ascending; from :func:`estimators.inference.scores.point_scores`.
    design : ndarray of float64, shape (p, n)
        The columns that the scores belong to.
    root : ndarray of float64, shape (n,), or None
        Square roots of the precisions in ``scores``.
    """

    t: FloatArray
    scores: FloatArray
    design: FloatArray
    root: FloatArray | None


@dataclass(frozen=True, slots=True)
class Refit(Generic[_Spread]):
    """The procedure on a series: coefficients, uncertainty by formula, curve at the probes, noise scale.

    The noise scale is that of a value of mean weight.
    """

    theta: FloatArray
    spread: _Spread
    curve: FloatArray
    sigma: float


@dataclass(frozen=True, slots=True)
class Fitted(Generic[_Spread]):
    """A fitted shape and the means to fit it again.

    Attributes
    ----------
    y, residual : ndarray of float64, shape (n,)
        Values; what the fit leaves of them.
    beside : ndarray of float64, shape (n,)
        What the values hold beside trend and noise, such as a season: permutation leaves it in place.
    root : ndarray of float64, shape (n,), or None
        Square roots of the precisions.
    fit : Refit
        Of the series itself, by ``effective-n``.
    axes : ndarray of float64, shape (p, p)
        Uncorrelated combinations of the coefficients, one per row, the trend that is tested first and the
        level last.
    stderr : ndarray of float64, shape (k,)
        Standard errors of the curve at the probes.
    has_trend : bool
        Whether the first axis is a trend; a level has none.
    independent : callable
        Makes the uncertainty for independent points.
    scored : callable
        Makes the scores.
    again : callable
        Runs the procedure on other values at the same times; None where it finds nothing.
    """

    y: FloatArray
    residual: FloatArray
    beside: FloatArray
    root: FloatArray | None
    fit: Refit[_Spread]
    axes: FloatArray
    stderr: FloatArray
    has_trend: bool
    independent: Callable[[], _Spread | None]
    scored: Callable[[], Scored]
    again: Callable[[FloatArray], Refit[_Spread] | None]


@dataclass(frozen=True, slots=True)
class Inferred(Generic[_Spread]):
    """What was asked for.

    Attributes
    ----------
    spread : Spread or None
    p_value : float or None
        Where the method counts it; else it follows from the interval of the trend.
    resamples : int or None
        Series that were fitted again.
    block : int or None
        Points per block.
    stability : float or None
        Share of resampled series in which the procedure found the same structure again.
    """

    spread: _Spread | None
    p_value: float | None = None
    resamples: int | None = None
    block: int | None = None
    stability: float | None = None

    def describe(self, level: float) -> Uncertainty:
        """Say in the answer's terms how sure it is at a confidence level."""
        if self.spread is None:
            return Uncertainty("none", level, None, None, None)
        return Uncertainty(
            method=self.spread.method,
            level=level,
            effective_n=self.spread.effective_n,
            lag1=self.spread.lag1,
            dof=self.spread.dof,
            resamples=self.resamples,
            block=self.block,
            stability=self.stability,
        )


def infer(
    fitted: Fitted[_Spread], uncertainty: str, level: float, resamples: int, seed: int
) -> Inferred[_Spread]:
    """Uncertainty of a shape by the method asked for.

    Parameters
    ----------
    fitted : Fitted
    uncertainty : str
        One of :data:`UNCERTAINTIES`.
    level : float
        Confidence level of the answer.
    resamples, seed : int
        Of ``bootstrap`` and ``permutation``.

    Returns
    -------
    Inferred
        As by ``effective-n`` where the series is too short, or too exact, for the method, and by
        ``permutation`` where there is no trend to test.
    """
    spread = fitted.fit.spread
    scatters = bool(np.all(spread.stderr(fitted.axes) > 0.0))
    if uncertainty == "effective-n" or not scatters or fitted.y.size < LEAST_POINTS:
        return Inferred(spread)
    if uncertainty == "hac":
        return Inferred(_hac(fitted))
    if uncertainty == "bootstrap":
        return _bootstrap(fitted, level, resamples, seed)
    return _permutation(fitted, resamples, seed) if fitted.has_trend else Inferred(spread)


def _hac(fitted: Fitted[_Spread]) -> _Spread:
    spread, plain, scored = fitted.fit.spread, fitted.independent(), fitted.scored()
    # Axes are uncorrelated by the curvature: each one's own column is the design's in their coordinates.
    inverse = np.linalg.inv(fitted.axes)
    influences = np.zeros_like(scored.design)
    for row, column in zip(inverse, scored.design, strict=True):
        influences += row[:, np.newaxis] * column
    longer = long_run(scored.t, scored.scores, influences, scored.design, spread.lag1, scored.root)
    if plain is None or longer is None or not np.all(longer.ratio > 0.0):
        return spread
    stderr = plain.stderr(fitted.axes) * np.sqrt(longer.ratio)
    return plain.along(
        fitted.axes,
        longer.correlation * np.outer(stderr, stderr),
        "hac",
        max(plain.effective_n / float(longer.ratio[-1]), 1.0),
        min(longer.dof, spread.dof),
    )


def _bootstrap(fitted: Fitted[_Spread], level: float, resamples: int, seed: int) -> Inferred[_Spread]:
    """Symmetric studentised intervals from circular blocks of residuals, outliers among them."""
    own, root, n = fitted.fit, fitted.root, fitted.y.size
    whitened = fitted.residual if root is None else fitted.residual * root
    curve = fitted.y - fitted.residual
    block = block_length(n, own.spread.lag1)
    statistics: list[FloatArray] = []
    for replicate in range(resamples):
        stop_if_cancelled()
        noise = whitened[drawn_blocks(n, block, seed, replicate)]
        again = fitted.again(curve + (noise if root is None else noise / root))
        # Another structure says how stable the answer is, not how far off a right one may be.
        if again is not None and _is_same(fitted, again):
            statistics.append(_studentised(again, own.theta, fitted.axes))
    stability = len(statistics) / resamples
    if len(statistics) < LEAST_REPLICATES:
        return Inferred(own.spread, resamples=resamples, block=block, stability=stability)
    table = np.array(statistics) * block_correction(n, block, own.theta.size)
    factors = [widening(column, level, own.spread.dof) for column in table.T]
    stderr = own.spread.stderr(fitted.axes) * np.array(factors)
    widened = own.spread.along(
        fitted.axes, np.diag(stderr * stderr), "bootstrap", own.spread.effective_n, own.spread.dof
    )
    return Inferred(widened, resamples=resamples, block=block, stability=stability)


def _permutation(fitted: Fitted[_Spread], resamples: int, seed: int) -> Inferred[_Spread]:
    """Rank of the studentised trend among those of the same values in another order."""
    own, root, n = fitted.fit, fitted.root, fitted.y.size
    block = block_length(n, own.spread.lag1) if own.spread.lag1 > 0.0 else 1
    values = fitted.y - fitted.beside
    whitened = values if root is None else values * root
    trend, nothing = fitted.axes[:1], np.zeros(own.theta.size)
    statistics: list[float] = []
    for replicate in range(resamples):
        stop_if_cancelled()
        shuffled = whitened[shuffled_blocks(n, block, seed, replicate)]
        again = fitted.again(fitted.beside + (shuffled if root is None else shuffled / root))
        # A series in which nothing is found shows no trend.
        statistics.append(0.0 if again is None else float(_studentised(again, nothing, trend)[0]))
    observed = float(_studentised(own, nothing, trend)[0])
    p_value = permutation_p(observed, np.array(statistics))
    return Inferred(own.spread.named("permutation"), p_value, resamples=resamples, block=block)


def _studentised(again: Refit[_Spread], truth: FloatArray, axes: FloatArray) -> FloatArray:
    """Deviations from the truth along axes, in the replicate's own standard errors."""
    deviations = np.sum(axes * (again.theta - truth), axis=1)
    ratios = zip(deviations.tolist(), again.spread.stderr(axes).tolist(), strict=True)
    return np.array([_ratio(deviation, stderr) for deviation, stderr in ratios])


def _ratio(deviation: float, stderr: float) -> float:
    if stderr > 0.0:
        return deviation / stderr
    return math.copysign(math.inf, deviation) if deviation else 0.0


def _is_same(fitted: Fitted[_Spread], again: Refit[_Spread]) -> bool:
    own = fitted.fit
    # Not by its scale: a fine line that chance draws now and then is a risk of the procedure itself, and
    # without those replicates intervals of clean series cover 2 to 3 % less often than they say.
    off = np.abs(again.curve - own.curve)
    return bool(np.all(off <= np.maximum(_SAME_SIGMAS * own.sigma, _SAME_STDERRS * fitted.stderr)))
