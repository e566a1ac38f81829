"""The best trend among the points that do not follow the answer."""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np
from scipy.special import betainc

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.found import Found, LineData, OtherStructure, Scale
from estimators.consensus.optimizers.none import NoOptimization
from estimators.consensus.presets import PRESETS, Preset
from estimators.consensus.search.sampling import SamplingSearch
from estimators.consensus.search.structure import StructureSearch
from estimators.consensus.termination import Adaptive
from estimators.options import RobustOptions
from estimators.result import NoFit
from estimators.trends.line.frame import Frame
from estimators.trends.trend import RunnerUp

LEAST_MARGIN = 3.0
"""Log evidence under which two structures are called equally good (20 to 1)."""

LEAST_SUPPORT = 5
"""Points that follow a runner-up; fewer can lie on a line by chance (METHODS.md 2.1: 0.5^5 = 3 %)."""

RIVAL_SHARE = 0.8
"""Support, as a share of the answer's, from which a rival of the same scatter is called equally good."""

NOTABLE_SHARE = 0.25
"""Support, as a share of the answer's, under which a structure is no competitor."""

_LOOKED_AT = 2000  # points: enough to see a rival that a tenth of them follow


@functools.cache
def _rival_search(search: SamplingSearch) -> SamplingSearch:
    """Make a search with the same policies but no optimisation: a rival is to be noticed, not polished."""
    return dataclasses.replace(search, optimizer=NoOptimization(), termination=Adaptive())


@functools.cache
def _brief(options: RobustOptions) -> RobustOptions:
    """Few draws: 128 miss a rival that holds a fifth of the outliers once in 200 times."""
    return dataclasses.replace(options, max_hypotheses=128, min_hypotheses=32, work_budget=0)


def find_runner_up(
    data: LineData,
    found: Found,
    preset: Preset,
    scale: Scale,
    options: RobustOptions,
    seed: int,
    frame: Frame,
    intercept_at: float,
) -> RunnerUp | None:
    """Competing structure, where there is one with enough points of its own.

    A search that weighs structures may report its own second; otherwise the points outside of the
    consensus are searched. Closed estimates know no other structure.
    """
    other = found.runner_up
    own = int(np.count_nonzero(found.inlier))
    least = max(LEAST_SUPPORT, NOTABLE_SHARE * own)
    if other is None or other.inliers < least:
        other = _among_outliers(data, found, preset, scale, options, seed, least)
    if other is None:
        return None
    same_scatter = 0.5 * found.sigma <= other.sigma <= 2.0 * found.sigma
    slope = float(other.theta[1]) / frame.half
    at = (intercept_at - frame.middle) / frame.half
    return RunnerUp(
        parameters={"slope": slope, "intercept": float(other.theta[0] + other.theta[1] * at)},
        inliers=other.inliers,
        sigma=other.sigma,
        equally_good=other.margin < LEAST_MARGIN or (same_scatter and other.inliers >= RIVAL_SHARE * own),
    )


def _among_outliers(
    data: LineData,
    found: Found,
    preset: Preset,
    scale: Scale,
    options: RobustOptions,
    seed: int,
    least: float,
) -> OtherStructure | None:
    """Line with the most points among those outside of the consensus, if chance cannot explain it."""
    search = preset.search
    if isinstance(search, StructureSearch):
        search, seed = PRESETS["msac"].search, 0
        scale = dataclasses.replace(scale, threshold=found.threshold)
    if not isinstance(search, SamplingSearch):
        return None
    rows = np.arange(0, data.n, max(1, data.n // _LOOKED_AT))
    rest = rows[~found.inlier[rows]]
    if rest.size < LEAST_SUPPORT or data.t[rest[0]] == data.t[rest[-1]]:
        return None
    again = _rival_search(search).run(_rows_of(data, rest), scale, _brief(options), seed)
    if isinstance(again, NoFit):
        return None
    support = int(np.count_nonzero(again.inlier))
    if support < LEAST_SUPPORT or not _beyond_chance(support, again.threshold, found.residual[rest]):
        return None
    if rest.size < rows.size or rows.size < data.n:
        support = _followers(data, np.flatnonzero(~found.inlier), again)
    return OtherStructure(again.theta, again.sigma, support, math.inf) if support >= least else None


def _rows_of(data: LineData, rows: IntArray) -> LineData:
    weights: FloatArray | None = None if data.weights is None else data.weights[rows]
    return LineData(data.t[rows], data.y[rows], weights)


def _followers(data: LineData, rows: IntArray, line: Found) -> int:
    rest = _rows_of(data, rows)
    off = np.abs(rest.y - line.theta[0] - line.theta[1] * rest.t)
    if rest.weights is not None:
        off *= np.sqrt(rest.weights)
    return int(np.count_nonzero(off <= line.threshold))


def _beyond_chance(support: int, threshold: float, residual: FloatArray) -> bool:
    """Whether scattered points would hardly give any of their pairs so many followers (METHODS.md 3.5).

    Expected number of such lines: pairs times the binomial tail of a band of the threshold. The range of
    the residuals is extended from their central nine tenths, so that a gross error does not dilute it.
    """
    m = residual.size
    ordered = np.sort(residual)
    middle = float(ordered[(19 * m) // 20] - ordered[m // 20])
    band = min(1.0, 2.0 * threshold * 0.9 / middle) if middle > 0.0 else 1.0
    others = support - 2
    return 0.5 * m * (m - 1) * float(betainc(others, m - 2 - others + 1, band)) < 1.0
