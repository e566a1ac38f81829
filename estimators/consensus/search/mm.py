"""MM-estimation as a search: minimal samples start the S-estimate, the bisquare finishes it.

No threshold and no scale are needed; half of the points may be outliers. All minimal samples are tried where
the work budget allows it, so that the answer does not depend on the seed; else 500 of them and the
least-squares fit (Yohai 1987; Salibian-Barrera & Yohai 2006; METHODS.md 9).
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from estimators.arrays import IntArray
from estimators.consensus.found import Found, LinearData, Scale
from estimators.consensus.samplers.draws import bind_sampler
from estimators.consensus.samplers.uniform import Uniform
from estimators.consensus.search.closed import found_from_fit, refuse
from estimators.options import RobustOptions
from estimators.regression.bisquare import BISQUARE
from estimators.regression.least_deviations import least_deviations
from estimators.regression.least_squares import least_squares
from estimators.regression.minimal_fits import solve_samples
from estimators.regression.mm import mm_estimate
from estimators.result import Ledger, NoFit

_NO_ORDER: IntArray = np.empty(0, dtype=np.int64)


@dataclass(frozen=True, slots=True)
class MMSearch:
    """MM-estimate, 95 % efficient at the normal law, breakdown 50 %.

    Attributes
    ----------
    starts : int
        Minimal samples drawn where they are not enumerated (default 500, as fast-S was published).
    starts_from_deviations : bool
        Whether the least absolute deviations are a start too (default False). Designs with columns that are
        zero at most points, as indicators of categories are, need it: their minimal samples are degenerate.
    """

    starts: int = 500
    starts_from_deviations: bool = False
    needs_threshold: ClassVar[bool] = False

    def run(self, data: LinearData, scale: Scale, options: RobustOptions, seed: int) -> Found | NoFit:
        """Fit; sigma is the scale of the S-estimate unless given."""
        refused = refuse(data)
        if refused is not None:
            return refused
        limit = min(self.starts, options.max_hypotheses)
        draws = bind_sampler(Uniform.code, data.t, data.p, _NO_ORDER, seed, limit, options.work_budget)
        count = limit if draws.total is None else draws.total
        models = solve_samples(data.columns, data.y, draws.block(0, count))
        others = [least_squares(data.columns, data.y, data.weights)[0]]
        if self.starts_from_deviations:
            others.append(least_deviations(data.columns, data.y, data.weights))
        fit = mm_estimate(
            data.columns,
            data.y,
            data.weights,
            starts=np.vstack([models, *others]),
            floor=scale.floor,
            sigma=scale.sigma,
        )
        ledger = Ledger(
            drawn=count,
            degenerate=count - models.shape[0],
            scored=models.shape[0],
            point_evaluations=fit.initial.evaluations,
            optimizations=models.shape[0] + len(others),
        )
        found = found_from_fit(
            data,
            scale,
            options,
            fit.theta,
            fit.residual,
            fit.initial.sigma,
            BISQUARE,
            sigma_source="s-estimate",
            ledger=ledger,
            search="sampled" if draws.total is None else "exhaustive",
        )
        success = -math.expm1(draws.log_miss(found.inlier, count))
        return dataclasses.replace(found, sampling_probability=success)
