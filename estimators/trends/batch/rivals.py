"""Whether another line through a series is equally good: the verdict of :mod:`..runner_up`."""

from __future__ import annotations

import numpy as np

from estimators.arrays import BoolArray, FloatArray
from estimators.consensus.found import Found, LineData
from estimators.consensus.presets import PRESETS
from estimators.consensus.structure import record as slots
from estimators.regression.loss import Loss, LossKind
from estimators.result import Ledger
from estimators.trends.batch.group import Group, Known
from estimators.trends.batch.lines import Lines
from estimators.trends.batch.source import Settings
from estimators.trends.line.frame import Frame
from estimators.trends.runner_up import (
    LEAST_MARGIN,
    LEAST_SUPPORT,
    NOTABLE_SHARE,
    RIVAL_SHARE,
    find_runner_up,
)


def find_ambiguous(group: Group, lines: Lines, known: Known, settings: Settings) -> BoolArray:
    """Tell which series have an equally good second line.

    A second line that the search of ``auto`` met is judged by its record. Otherwise only the points outside
    of the consensus can hold one, and where there are too few of them nothing is searched.

    Parameters
    ----------
    group : Group
    lines : Lines
        One in every series.
    known : Known
        What the searches were told.
    settings : Settings
    """
    n = group.lengths
    own = np.add.reduceat(lines.inlier, group.offsets[:-1], dtype=np.int64)
    verdict, judged = np.zeros(n.size, dtype=np.bool_), np.zeros(n.size, dtype=np.bool_)
    if lines.records is not None:
        second = lines.records
        followers, other = second[:, slots.RUNNER_INLIERS], second[:, slots.RUNNER_SIGMA]
        judged = (second[:, slots.RUNNER] != 0.0) & (
            followers >= np.maximum(LEAST_SUPPORT, NOTABLE_SHARE * own)
        )
        same_scatter = (0.5 * lines.sigma <= other) & (other <= 2.0 * lines.sigma)
        verdict = judged & (
            (second[:, slots.RUNNER_MARGIN] < LEAST_MARGIN)
            | (same_scatter & (followers >= RIVAL_SHARE * own))
        )
    room = (n - own >= LEAST_SUPPORT) & (n - own >= RIVAL_SHARE * own)
    for k in np.flatnonzero(room & ~judged).tolist():
        verdict[k] = _is_rivalled(group, lines, k, known, settings)
    return verdict


def _is_rivalled(group: Group, lines: Lines, k: int, known: Known, settings: Settings) -> bool:
    rows = group.rows_of(k)
    weights: FloatArray | None = None if group.weights is None else group.weights[rows]
    found = Found(
        theta=lines.theta[k],
        residual=lines.residual[rows],
        inlier=lines.inlier[rows],
        probability=None,
        sigma=float(lines.sigma[k]),
        sigma_source=known.sigma_source,
        threshold=float(lines.threshold[k]),
        threshold_source=known.threshold_source,
        loss=Loss(LossKind.square),
        ledger=Ledger(),
        sampling_probability=None,
        search="sampled",
    )
    other = find_runner_up(
        LineData(group.t[rows], group.y[rows], weights),
        found,
        PRESETS[settings.method],
        known.of(k),
        settings.options,
        settings.seed,
        Frame(float(group.middle[k]), float(group.half[k])),
        0.0,
    )
    return other is not None and other.equally_good
