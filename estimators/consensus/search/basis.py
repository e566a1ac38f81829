"""Search of ``auto`` for models of any number of columns: :mod:`estimators.consensus.bases`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.bases.kernel import find_basis, finish_basis, mean_square_about
from estimators.consensus.bases.stretches import stretch_hypotheses
from estimators.consensus.bases.weighing import FINALISTS
from estimators.consensus.found import Found, LinearData, OtherStructure, Scale
from estimators.consensus.samplers.draws import bind_sampler
from estimators.consensus.samplers.far_apart import FarApart
from estimators.consensus.search.closed import OrdinaryLeastSquares, no_fit, refuse
from estimators.consensus.search.mm import MMSearch
from estimators.consensus.structure.finish import TABLE
from estimators.consensus.structure.mixture import INLIERS, SIGMA, SIZE
from estimators.options import RobustOptions
from estimators.regression.huber import huber
from estimators.regression.least_squares import least_squares
from estimators.regression.loss import Loss, LossKind
from estimators.regression.minimal_fits import solve_samples
from estimators.regression.quantiles import quantile_fits
from estimators.regression.s_estimator import s_estimate
from estimators.result import Ledger, NoFit, NoFitReason

WEIGH_ON = 1000
"""Points that structures are weighed on; of a longer series they are spread over the whole."""

SAMPLES, MOST_SAMPLES = 500, 4000
"""Minimal samples for the first coefficient or two; each further one takes as many again, up to a limit, as
the chance that a sample is clean falls with its size."""

_S_STARTS = 50
_S_ESTIMATE = 0  # its place among the robust fits
_GOLDEN_SECTION = 0.6180339887498949
_FINEST = 1e-7
_CENTRAL = 50.0
_NO_ORDER: IntArray = np.empty(0, dtype=np.int64)
_APART = 2.0
_SCALES = (1.0, 0.25)
"""Scales, of its own, at which a robust fit enters the comparison."""

_SHARES = np.array([0.1, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9])
"""Regression quantiles that enter it: the middle of what follows the trend where 80 % to 20 % of the points
err to one side."""


@dataclass(frozen=True, slots=True)
class BasisSearch:
    """Mixture with sticky labels over any columns; no threshold, no seed.

    Hypotheses come from minimal samples, from stretches of the series and from robust fits (least squares,
    Huber, S-estimate, regression quantiles). Those that stand out at some scale are fitted together with what
    contaminates the series, and compared by evidence.
    """

    @property
    def needs_threshold(self) -> bool:
        """The noise scale is part of what is found."""
        return False

    def run(self, data: LinearData, scale: Scale, options: RobustOptions, seed: int) -> Found | NoFit:
        """Find the model.

        Parameters
        ----------
        data : LinearData
            Independent columns of size about 1.
        scale : Scale
            A given sigma fixes the noise scale, a given threshold the labels.
        options : RobustOptions
        seed : int
            Without effect: the samples do not depend on it.

        Returns
        -------
        Found or NoFit
            Least squares where there are fewer than two points more than coefficients, an MM-estimate where
            no structure stands out; ``NoFit`` where none does at a given sigma.
        """
        del seed
        refused = refuse(data)
        if refused is not None:
            return refused
        n, p = data.n, data.p
        if n < p + 2:
            return OrdinaryLeastSquares().run(data, scale, options, 0)
        root = np.ones(n) if data.weights is None else np.sqrt(data.weights)
        rows = _spread_rows(n, WEIGH_ON)
        some = data if rows.size == n else _rows_of(data, rows)
        count = min(SAMPLES * max(p - 1, 1), MOST_SAMPLES)
        draws = bind_sampler(FarApart.code, some.t, p, _NO_ORDER, 0, count, 0)
        samples = draws.block(0, count)
        minimal = solve_samples(some.columns, some.y, samples)
        robust, robust_scale = _robust_fits(some, minimal[:_S_STARTS], scale.floor)
        stretches = stretch_hypotheses(some.columns, some.y, some.t, root[rows] ** 2)
        hypotheses = np.vstack([minimal, stretches])
        middle = robust[_S_ESTIMATE]
        off = some.y - _values(some.columns, middle)
        unit, reach = _unit_of(off, scale.floor)
        framed = np.clip(off, -reach, reach) / unit
        finest = max(scale.floor / unit, _FINEST)
        thetas = np.empty((FINALISTS, p))
        bank = np.empty((FINALISTS, SIZE))
        scores = np.empty(FINALISTS)
        counts = np.zeros(2, dtype=np.int64)
        found = find_basis(
            some.columns,
            framed,
            root[rows],
            np.ascontiguousarray((hypotheses - middle) / unit),
            np.ascontiguousarray((robust - middle) / unit),
            robust_scale / unit,
            finest,
            (scale.sigma or 0.0) / unit,
            thetas,
            bank,
            scores,
            counts,
        )
        if not found:
            return _without_structure(data, scale, options)
        best = int(counts[1])
        theta = middle + thetas[best] * unit
        weight = np.empty(TABLE + 1)
        inlier, residual = np.empty(n, np.bool_), np.empty(n)
        params = bank[best].copy()
        sigma = scale.sigma or float(params[SIGMA]) * unit

        def finish() -> float:
            return finish_basis(
                data.columns, data.y, root, params, some.n, sigma, scale.threshold or 0.0,
                options.threshold_sigmas, theta, weight, inlier, residual,
            )  # fmt: skip

        threshold = finish()
        if scale.sigma is None:
            sigma = max(
                _own_scale(data, root, theta, sigma, weight, rows, float(params[INLIERS])), scale.floor
            )
            threshold = finish()
            followers = int(np.count_nonzero(inlier))
            if params[SIGMA] <= 10.0 * finest and followers > p:
                # As fine as could be told apart; how fine it really is, the inliers say.
                squares = (residual[inlier] * root[inlier]) ** 2
                sigma = max(scale.floor, math.sqrt(float(np.sum(squares)) / (followers - p)))
        log_miss = draws.log_miss(inlier[rows], count)
        ranked = [k for k in np.argsort(-scores[:found], kind="stable").tolist() if k != best]
        others = [(middle + thetas[k] * unit, float(bank[k, SIGMA]) * unit, float(scores[k])) for k in ranked]
        return Found(
            theta=theta,
            residual=residual,
            inlier=inlier,
            probability=None,
            sigma=sigma,
            sigma_source=scale.sigma_source if scale.sigma is not None else "mixture",
            threshold=threshold,
            threshold_source="sigma" if scale.threshold is None else scale.threshold_source,
            loss=Loss(LossKind.tabulated, table=weight),
            ledger=Ledger(
                drawn=count,
                degenerate=count - minimal.shape[0],
                scored=hypotheses.shape[0],
                point_evaluations=hypotheses.shape[0] * some.n,
                optimizations=int(counts[0]),
            ),
            sampling_probability=-math.expm1(log_miss),
            search="sampled",
            runner_up=_runner_up(data, root, others, float(scores[best]), theta, sigma, inlier, options),
        )


def _spread_rows(n: int, most: int) -> IntArray:
    """At most ``most`` rows, one from each equal share, at places that no period of the data follows."""
    if n <= most:
        return np.arange(n)
    share = np.arange(most)
    within = share * _GOLDEN_SECTION % 1.0
    return np.minimum(((share + within) * (n / most)).astype(np.int64), n - 1)


def _rows_of(data: LinearData, rows: IntArray) -> LinearData:
    weights = None if data.weights is None else data.weights[rows]
    return LinearData(np.ascontiguousarray(data.columns[:, rows]), data.y[rows], data.t[rows], weights)


def _values(columns: FloatArray, theta: FloatArray) -> FloatArray:
    fitted = theta[0] * columns[0]
    for j in range(1, theta.size):
        fitted += theta[j] * columns[j]
    return np.asarray(fitted, dtype=np.float64)


def _robust_fits(data: LinearData, starts: FloatArray, floor: float) -> tuple[FloatArray, FloatArray]:
    """Least squares, Huber's, the S-estimate and quantiles, and the scales at which they are compared."""
    least, residual, _ = least_squares(data.columns, data.y, data.weights)
    spread = max(float(np.sqrt(np.mean(residual**2))), floor)
    middle = huber(data.columns, data.y, data.weights, sigma=None, floor=floor)
    first = np.vstack([starts, least, middle.theta])
    s = s_estimate(data.columns, data.y, data.weights, starts=first, floor=floor)
    quantiles, cores = quantile_fits(
        data.columns, data.y, data.weights, shares=_SHARES, start=middle.theta, floor=floor
    )
    thetas = np.vstack([s.theta, least, middle.theta])
    scales = np.outer([s.sigma, spread, middle.sigma], _SCALES)
    return (
        np.vstack([np.repeat(thetas, len(_SCALES), axis=0), quantiles]),
        np.concatenate([scales.ravel(), cores]),
    )


def _unit_of(off: FloatArray, floor: float) -> tuple[float, float]:
    """Range of values about a robust fit, but not that of a few gross errors; and how far it reaches."""
    ordered = np.sort(np.abs(off))
    reach = float(ordered[-1])
    central = float(ordered[(9 * (ordered.size - 1)) // 10])
    if central > 0.0:
        reach = min(reach, _CENTRAL * central)
    return max(2.0 * reach, 4.0 * floor), reach


def _own_scale(
    data: LinearData,
    root: FloatArray,
    theta: FloatArray,
    sigma: float,
    weight: FloatArray,
    rows: IntArray,
    support: float,
) -> float:
    """Noise scale measured on all points, corrected for the coefficients that the fit used up."""
    if rows.size < data.n:
        some = _rows_of(data, rows)
        few = mean_square_about(some.columns, some.y, root[rows], theta, sigma, weight)
        more = mean_square_about(data.columns, data.y, root, theta, sigma, weight)
        if few > 0.0 and more > 0.0:
            sigma *= min(1.25, max(0.8, math.sqrt(more / few)))
    return sigma * math.sqrt(support / max(support - data.p, 1.0))


def _without_structure(data: LinearData, scale: Scale, options: RobustOptions) -> Found | NoFit:
    """MM-estimate, which needs no structure that stands out."""
    found = MMSearch().run(data, scale, options, seed=0)
    if isinstance(found, NoFit) or scale.sigma is None or 2 * np.count_nonzero(found.inlier) >= data.n:
        return found
    message = "No trend stands out among the points at this noise scale; give a larger sigma, or none."
    return no_fit(NoFitReason.no_consensus, message, data)


def _runner_up(
    data: LinearData,
    root: FloatArray,
    others: list[tuple[FloatArray, float, float]],
    margin_from: float,
    best: FloatArray,
    sigma: float,
    inlier: BoolArray,
    options: RobustOptions,
) -> OtherStructure | None:
    """Best finalist that is another curve than the answer's, by two scales in root mean square."""
    for theta, scale, score in others:
        away = math.sqrt(float(np.mean(_values(data.columns, theta - best) ** 2)))
        if away <= _APART * max(scale, sigma):
            continue
        off = np.abs(data.y - _values(data.columns, theta)) * root
        only = int(np.count_nonzero(~inlier & (off <= options.threshold_sigmas * scale)))
        return OtherStructure(theta, scale, only, margin_from - score)
    return None
