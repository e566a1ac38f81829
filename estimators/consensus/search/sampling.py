"""Search by random sampling: a row of policies as a :class:`~estimators.consensus.found.Search`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from estimators.arrays import FloatArray, InputError
from estimators.consensus import engine
from estimators.consensus.batch import search_many
from estimators.consensus.found import Found, LinearData, Scale
from estimators.consensus.labelling.scale import sigma_of_consensus
from estimators.consensus.labelling.threshold import Threshold
from estimators.consensus.linear_model import LinearModel
from estimators.consensus.optimizers.none import NoOptimization
from estimators.consensus.outcome import Outcome
from estimators.consensus.protocols import Labeler, Optimizer, Sampler, Score, Termination, Verifier
from estimators.consensus.samplers.uniform import Uniform
from estimators.consensus.scores.count import Count
from estimators.consensus.termination import Adaptive
from estimators.consensus.verifiers.full import Full
from estimators.options import RobustOptions
from estimators.regression.loss import Loss, LossKind
from estimators.result import NoFit, NoFitReason, Points


@dataclass(frozen=True, slots=True)
class SamplingSearch:
    """RANSAC and its family; the defaults are RANSAC itself.

    The final estimate is least squares on the consensus set, iterated until the set stays the same and
    accepted only while the truncated quadratic, which it minimises, does not get worse.

    Attributes
    ----------
    sampler : Sampler
    score : Score
    verifier : Verifier
    optimizer : Optimizer
    termination : Termination
    labeler : Labeler
    block : int
        Hypotheses between two looks at the best model (default 64). Local optimisation starts and draws stop
        at the ends of blocks only.
    execution : {"compiled", "readable"}
        Which of the two executions runs linear models; they give the same bytes.

    Examples
    --------
    >>> t = np.linspace(-1.0, 1.0, 50)
    >>> y = np.where(np.arange(50) % 5 == 0, 0.9, 0.25 * t)
    >>> data = LinearData(np.array([np.ones(50), t]), y, t, None)
    >>> scale = Scale(None, "residuals", 0.01, "given", 1e-12)
    >>> found = SamplingSearch().run(data, scale, RobustOptions(), seed=0)
    >>> int(found.inlier.sum()), round(float(found.theta[1]), 9), found.search
    (40, 0.25, 'exhaustive')
    """

    sampler: Sampler = field(default_factory=Uniform)
    score: Score = field(default_factory=Count)
    verifier: Verifier = field(default_factory=Full)
    optimizer: Optimizer = field(default_factory=NoOptimization)
    termination: Termination = field(default_factory=Adaptive)
    labeler: Labeler = field(default_factory=Threshold)
    block: int = 64
    execution: Literal["compiled", "readable"] = "compiled"

    @property
    def needs_threshold(self) -> bool:
        """A consensus is counted within a threshold."""
        return True

    def run(self, data: LinearData, scale: Scale, options: RobustOptions, seed: int) -> Found | NoFit:
        """Find the linear model with the best consensus.

        Parameters
        ----------
        data : LinearData
        scale : Scale
            With a threshold. Without a sigma, sigma follows from the residuals of the inliers, corrected for
            their truncation (METHODS.md 12).
        options : RobustOptions
        seed : int

        Returns
        -------
        Found or NoFit
            ``NoFit`` with fewer points than coefficients, or if every minimal sample was degenerate.

        Raises
        ------
        InputError
            Without a threshold.
        Cancelled
            If the caller's flag was set (:mod:`estimators.consensus.cancellation`).
        """
        if scale.threshold is None:
            raise InputError("threshold", "methods that count inliers need a threshold or a noise scale")
        if data.n < data.p:
            return _no_fit(
                data.n,
                NoFitReason.too_few_points,
                f"{data.n} usable points; the model needs at least {data.p}.",
            )
        outcome: Outcome | None
        if self.execution == "compiled":
            offsets = np.array([0, data.n])
            records = search_many(data, offsets, np.array([scale.threshold]), self, options, seed)
            outcome, residual = records.outcome(0), records.residual
        else:
            model = LinearModel(data)
            outcome = engine.search(
                model, self, scale.threshold, options, seed, positions=data.t, quality=data.weights
            )
            residual = model.raw_residuals(outcome.theta) if outcome else data.y
        if outcome is None:
            return _no_fit(
                data.n,
                NoFitReason.no_consensus,
                "Every minimal sample was degenerate: the points do not determine the model.",
            )
        return _found(outcome, residual, scale)


def _found(outcome: Outcome, residual: FloatArray, scale: Scale) -> Found:
    """Put the outcome of a search into the terms that all methods share."""
    if scale.sigma is None:
        sigma = max(sigma_of_consensus(outcome.scatter, outcome.threshold), scale.floor)
        sigma_source = "residuals" if sigma > scale.floor else "floor"
    else:
        sigma, sigma_source = scale.sigma, scale.sigma_source
    return Found(
        theta=outcome.theta,
        residual=residual,
        inlier=outcome.inlier,
        probability=None,
        sigma=sigma,
        sigma_source=sigma_source,
        threshold=outcome.threshold,
        threshold_source=scale.threshold_source,
        loss=Loss(LossKind.truncated, outcome.threshold / sigma),
        ledger=outcome.ledger,
        sampling_probability=outcome.sampling_probability,
        search="exhaustive" if outcome.exhaustive else "sampled",
    )


def _no_fit(n: int, reason: NoFitReason, message: str) -> NoFit:
    """No model, with an entry for each point of the search."""
    unknown = np.full(n, np.nan)
    points = Points(np.zeros(n, dtype=np.bool_), unknown, unknown.copy(), np.zeros(n, dtype=np.uint8))
    return NoFit(reason, message, points)
