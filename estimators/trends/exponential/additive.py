"""An exponential under additive noise: found in the values' own units, inferred as the weighted line it is.

Near the fitted rate b the model is A exp(b t) (1 + d t): ``y exp(-b t)`` follows a line with precisions
``exp(2 b t)``, whose level is A and whose slope is 0 with the standard error of A b. Where too few readings
show no structure, that line is fitted in turn with its linearisation: least squares up to three readings, an
MM-estimate beyond.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.found import Found, LineData, OtherStructure, Scale
from estimators.consensus.search.closed import OrdinaryLeastSquares
from estimators.consensus.search.mm import MMSearch
from estimators.consensus.search.structure import LEAST_POINTS
from estimators.consensus.stopping import clean_probability
from estimators.consensus.structure.finish import TABLE
from estimators.options import RobustOptions
from estimators.regression.loss import Loss, LossKind
from estimators.result import Ledger, NoFit
from estimators.trends.exponential import search as slots
from estimators.trends.exponential.proposals import PROPOSED, STEEPEST
from estimators.trends.exponential.search import fit_additive

_FINEST = 1e-7
"""Least noise scale that the search tells apart, in units of the values' spread."""
_REACH = 50.0
"""Values further from the middle than this many central ranges do not set the unit of the search."""
_FAR = 2.0
"""Values are drawn in to so many units, as lines' are: a fill value of 1e36 must not drown others' squares.

No value within the spread that sets the unit reaches it."""
_TURNS = 50
_SETTLED = 1e-12


@dataclass(frozen=True, slots=True)
class AdditiveFit:
    """An exponential in the frame of time, as the weighted line about it.

    Attributes
    ----------
    data : LineData
        Time since ``anchor`` in the frame, values divided by the curve's shape, precisions; values in units
        of ``unit``.
    found : Found
        On ``data``: theta is (amplitude at the anchor, 0).
    anchor, rate : float
        In the frame.
    unit : float
        Of the values of ``data``.
    other : OtherStructure or None
        Another curve: theta is its level at frame time 0, in units of the values, and its rate in the frame.
    """

    data: LineData
    found: Found
    anchor: float
    rate: float
    unit: float
    other: OtherStructure | None = None


def find_additive(
    t: FloatArray,
    y: FloatArray,
    weights: FloatArray | None,
    scale: Scale,
    options: RobustOptions,
    seeds: FloatArray,
    largest: float,
) -> AdditiveFit | NoFit | None:
    """Search for ``y = A exp(b t)`` under additive noise.

    Parameters
    ----------
    t : ndarray of float64, shape (n,)
        Ascending, from -1 to 1.
    y : ndarray of float64, shape (n,)
        Not all 0.
    weights : ndarray of float64, shape (n,), or None
        Precisions with mean 1.
    scale : Scale
        In units of ``y``.
    options : RobustOptions
    seeds : ndarray of float64, shape (k, 2)
        Curves (level at 0, rate) to propose beside those through pairs of readings.
    largest : float
        Size of a value that is known to follow an exponential; 0 if none is.

    Returns
    -------
    AdditiveFit, NoFit or None
        None where no two readings suggest an exponential.
    """
    unit = _unit(y, largest)
    fit = _in_unit(t, y, weights, scale, options, seeds, unit)
    if isinstance(fit, AdditiveFit):
        peak = abs(float(fit.found.theta[0])) * unit
        wider = _unit(y, 2.0 * peak)
        if wider > unit:
            # The curve climbs out of what was taken for the spread of the values.
            fit = _in_unit(t, y, weights, scale, options, seeds, wider) or fit
    return fit


def _in_unit(
    t: FloatArray,
    y: FloatArray,
    weights: FloatArray | None,
    scale: Scale,
    options: RobustOptions,
    seeds: FloatArray,
    unit: float,
) -> AdditiveFit | NoFit | None:
    """Search with values, drawn in to ``_FAR``, and scales in another unit."""
    values = np.clip(y / unit, -_FAR, _FAR)
    scaled = dataclasses.replace(
        scale,
        sigma=None if scale.sigma is None else scale.sigma / unit,
        threshold=None if scale.threshold is None else scale.threshold / unit,
        floor=scale.floor / unit,
    )
    level_seeds = np.ascontiguousarray(seeds / np.array([unit, 1.0]))
    fit: AdditiveFit | NoFit | None = None
    if t.size >= LEAST_POINTS:
        fit = _by_structure(t, values, weights, scaled, options, level_seeds)
    if fit is None:
        fit = _by_turns(t, values, weights, scaled, options, level_seeds)
    return dataclasses.replace(fit, unit=unit) if isinstance(fit, AdditiveFit) else fit


def _unit(y: FloatArray, largest: float) -> float:
    """Spread of the values, drawn in to what a few wild ones cannot stretch, but not within the trend."""
    ordered = np.sort(y)
    n = ordered.size
    central = float(ordered[n - 1 - n // 20] - ordered[n // 20])
    spread = float(ordered[-1]) - float(ordered[0])
    if central > 0.0:
        spread = min(spread, max(2.0 * _REACH * central, 2.0 * largest))
    return max(spread, float(np.median(np.abs(y))), largest, np.finfo(np.float64).tiny)


def _by_structure(
    t: FloatArray,
    y: FloatArray,
    weights: FloatArray | None,
    scale: Scale,
    options: RobustOptions,
    seeds: FloatArray,
) -> AdditiveFit | None:
    n = t.size
    tau, z, root, weight, record = (
        *(np.empty(n) for _ in range(3)),
        np.empty(TABLE + 1),
        np.empty(slots.RECORD),
    )
    own_root = np.ones(n) if weights is None else np.sqrt(weights)
    finest = max(scale.floor, _FINEST)
    fit_additive(t, y, own_root, seeds, finest, scale.sigma or 0.0, tau, z, root, weight, record)
    if not record[slots.FOUND]:
        return None
    sigma = float(record[slots.SCALE])
    threshold = scale.threshold if scale.threshold is not None else options.threshold_sigmas * sigma
    residual = z - record[slots.LEVEL_AT_ZERO]
    inlier = np.abs(residual * root) <= threshold
    inliers = int(np.count_nonzero(inlier))
    if scale.sigma is None and sigma <= 10.0 * finest and inliers > 2:
        # The structure is as fine as could be told apart; how fine it really is, its inliers say.
        squares = (residual[inlier] * root[inlier]) ** 2
        sigma = max(scale.floor, math.sqrt(math.fsum(squares) / (inliers - 2)))
    clean = clean_probability(inliers, n, 2)
    found = Found(
        theta=np.array([record[slots.LEVEL_AT_ZERO], 0.0]),
        residual=residual,
        inlier=inlier,
        probability=None,
        sigma=sigma,
        sigma_source=scale.sigma_source if scale.sigma is not None else "mixture",
        threshold=threshold,
        threshold_source="sigma" if scale.threshold is None else scale.threshold_source,
        loss=Loss(LossKind.tabulated, table=weight),
        ledger=Ledger(
            drawn=PROPOSED,
            scored=int(record[slots.WEIGHED]),
            point_evaluations=int(record[slots.EVALUATIONS]),
            optimizations=1,
        ),
        sampling_probability=float(-np.expm1(PROPOSED * np.log1p(-min(clean, 1.0 - 1e-16)))),
        search="sampled",
    )
    other = None
    if record[slots.RIVAL]:
        other = _rival(t, y, weights, record, inlier, options)
    data = LineData(tau, z, root * root)
    return AdditiveFit(
        data, found, float(record[slots.TAU_ZERO]), float(record[slots.FITTED_RATE]), 1.0, other
    )


def _rival(
    t: FloatArray,
    y: FloatArray,
    weights: FloatArray | None,
    record: FloatArray,
    inlier: np.ndarray[tuple[int], np.dtype[np.bool_]],
    options: RobustOptions,
) -> OtherStructure:
    level, rate, sigma = (float(record[k]) for k in (slots.RIVAL_LEVEL, slots.RIVAL_RATE, slots.RIVAL_SCALE))
    off = np.abs(y - level * np.exp(np.clip(rate * t, -STEEPEST, STEEPEST)))
    if weights is not None:
        off *= np.sqrt(weights)
    followers = int(np.count_nonzero(~inlier & (off <= options.threshold_sigmas * sigma)))
    return OtherStructure(np.array([level, rate]), sigma, followers, float(record[slots.RIVAL_MARGIN]))


def _by_turns(
    t: FloatArray,
    y: FloatArray,
    weights: FloatArray | None,
    scale: Scale,
    options: RobustOptions,
    seeds: FloatArray,
) -> AdditiveFit | NoFit | None:
    """Fit the weighted line and its linearisation in turn, from every seed; the least scatter counts."""
    search = OrdinaryLeastSquares() if t.size < LEAST_POINTS else MMSearch()
    best: AdditiveFit | NoFit | None = None
    for _, start in seeds:
        fit = _turn(search, t, y, weights, scale, options, float(start))
        if isinstance(fit, AdditiveFit) and isinstance(best, AdditiveFit):
            best = fit if fit.found.sigma < best.found.sigma else best
        elif fit is not None and not isinstance(best, AdditiveFit):
            best = fit
    return best


def _turn(
    search: OrdinaryLeastSquares | MMSearch,
    t: FloatArray,
    y: FloatArray,
    weights: FloatArray | None,
    scale: Scale,
    options: RobustOptions,
    rate: float,
) -> AdditiveFit | NoFit | None:
    for _ in range(_TURNS):
        anchor = 1.0 if rate > 0.0 else -1.0
        tau = t - anchor
        factor = np.exp(rate * tau)
        precision = factor * factor if weights is None else factor * factor * weights
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            turned = y / factor
        if not np.isfinite(turned).all():
            return None
        data = LineData(tau, turned, precision)
        found = search.run(data, scale, options, 0)
        if isinstance(found, NoFit):
            return found
        level, slope = float(found.theta[0]), float(found.theta[1])
        if level == 0.0:
            return None
        turn = min(max(slope / level, -1.0), 1.0)
        if abs(turn) <= _SETTLED * max(1.0, abs(rate)):
            found = dataclasses.replace(found, theta=np.array([level, 0.0]))
            return AdditiveFit(data, found, anchor, rate, 1.0)
        rate = min(max(rate + turn, -STEEPEST), STEEPEST)
    return None
