"""Search of ``auto``: the threshold-free structure of :mod:`estimators.consensus.structure`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.found import Found, LinearData, LineData, OtherStructure, Scale
from estimators.consensus.search.basis import BasisSearch
from estimators.consensus.search.closed import OrdinaryLeastSquares, no_fit
from estimators.consensus.search.mm import MMSearch
from estimators.consensus.stopping import clean_probability
from estimators.consensus.structure import record as slots
from estimators.consensus.structure.finish import TABLE
from estimators.consensus.structure.kernel import fit_structures
from estimators.options import RobustOptions
from estimators.regression.influence import INLIERS, SUMS
from estimators.regression.loss import Loss, LossKind
from estimators.result import Ledger, NoFit, NoFitReason

LEAST_POINTS = 4
"""With fewer points no structure can be told from another (METHODS.md 13.4)."""

_NO_WEIGHTS = np.empty(0)


@dataclass(frozen=True, slots=True)
class StructureSearch:
    """Mixture with sticky labels over lines proposed by low-discrepancy pairs; no threshold, no seed."""

    @property
    def needs_threshold(self) -> bool:
        """The noise scale is part of what is found."""
        return False

    def run(self, data: LinearData, scale: Scale, options: RobustOptions, seed: int) -> Found | NoFit:
        """Find the trend of a series.

        Parameters
        ----------
        data : LinearData
            A line; other models go the way of :class:`~estimators.consensus.search.basis.BasisSearch`.
        scale : Scale
            A given sigma fixes the noise scale, a given threshold the labels.
        options : RobustOptions
        seed : int
            Without effect: the search draws no random numbers.

        Returns
        -------
        Found or NoFit
            Least squares on all points where there are fewer than four, an MM-estimate where no line stands
            out; ``NoFit`` where none does at a given sigma.
        """
        if not _is_line(data):
            return BasisSearch().run(data, scale, options, seed)
        if data.n < LEAST_POINTS:
            return OrdinaryLeastSquares().run(data, scale, options, seed)
        n = data.n
        root = _NO_WEIGHTS if data.weights is None else np.sqrt(data.weights)
        weight = np.empty((1, TABLE + 1))
        inlier = np.empty(n, dtype=np.bool_)
        probability = np.empty(n)
        residual = np.empty(n)
        sums = np.empty((1, SUMS))
        records = np.empty((1, slots.RECORD))
        fit_structures(
            np.array([0, n]), data.t, data.y, root, np.array([scale.floor]), scale.sigma or 0.0,
            scale.threshold or 0.0, options.threshold_sigmas, weight, inlier, probability, residual, sums,
            records,
        )  # fmt: skip
        record = records[0]
        if not record[slots.FOUND]:
            return _without_structure(data, scale, options)
        inliers = int(sums[0, INLIERS])
        drawn = int(record[slots.PROPOSED])
        sigma = float(record[slots.SIGMA])
        clean = clean_probability(inliers, n, data.p)
        return Found(
            theta=np.array([record[slots.LEVEL], record[slots.SLOPE]]),
            residual=residual,
            inlier=inlier,
            probability=probability,
            sigma=sigma,
            sigma_source=scale.sigma_source if scale.sigma is not None else "mixture",
            threshold=float(record[slots.THRESHOLD]),
            threshold_source="sigma" if scale.threshold is None else scale.threshold_source,
            loss=Loss(LossKind.tabulated, table=weight[0]),
            ledger=Ledger(
                drawn=drawn,
                scored=int(record[slots.WEIGHED]),
                point_evaluations=int(record[slots.EVALUATIONS]),
                optimizations=1,
            ),
            sampling_probability=float(-np.expm1(drawn * np.log1p(-min(clean, 1.0 - 1e-16)))),
            search="sampled",
            runner_up=_runner_up(record),
            sums=sums[0],
        )


def _is_line(data: LinearData) -> bool:
    """Whether the design is ``[1, t]``."""
    if isinstance(data, LineData) or data.p != 2:
        return data.p == 2
    return bool(np.all(data.columns[0] == 1.0)) and np.array_equal(data.columns[1], data.t)


def _without_structure(data: LinearData, scale: Scale, options: RobustOptions) -> Found | NoFit:
    """MM-estimate, which needs no structure that stands out: for few points, and for a very large sigma."""
    found = MMSearch().run(data, scale, options, seed=0)
    if isinstance(found, NoFit) or scale.sigma is None or 2 * np.count_nonzero(found.inlier) >= data.n:
        return found
    message = "No line stands out among the points at this noise scale; give a larger sigma, or none."
    return no_fit(NoFitReason.no_consensus, message, data)


def _runner_up(record: FloatArray) -> OtherStructure | None:
    if not record[slots.RUNNER]:
        return None
    return OtherStructure(
        theta=np.array([record[slots.RUNNER_LEVEL], record[slots.RUNNER_SLOPE]]),
        sigma=float(record[slots.RUNNER_SIGMA]),
        inliers=int(record[slots.RUNNER_INLIERS]),
        margin=float(record[slots.RUNNER_MARGIN]),
    )
