"""The RANSAC loop, for any model and any row of policies.

    draw a block of minimal samples -> solve -> verify and score -> is the best of the block a record?
    then optimise it locally -> ask the termination -> ... -> final fit -> label -> close the ledger

Python runs once per block, compiled code per point. The best model changes only at the ends of blocks, in the
order of the hypotheses (METHODS.md 13.7, 13.8). Linear models take :mod:`estimators.consensus.linear`
instead, the same loop in compiled code; a test proves that both give the same bytes.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.cancellation import Cancelled, cancel_flag
from estimators.consensus.evaluation import Evaluation, rank
from estimators.consensus.optimizers.readable import improve, polish
from estimators.consensus.outcome import Outcome
from estimators.consensus.protocols import Model, Policies
from estimators.consensus.samplers.draws import bind_sampler
from estimators.consensus.scan import NOTHING
from estimators.options import RobustOptions
from estimators.result import Ledger


def search(
    model: Model,
    policies: Policies,
    threshold: float,
    options: RobustOptions,
    seed: int,
    *,
    positions: FloatArray | None = None,
    quality: FloatArray | None = None,
) -> Outcome | None:
    """Find the model with the best consensus.

    Parameters
    ----------
    model : Model
    policies : Policies
    threshold : float
        Largest whitened |residual| of an inlier; raised to what the arithmetic can tell from zero.
    options : RobustOptions
    seed : int
    positions : ndarray of float64, shape (n,), optional
        Where the points lie, ascending, for far-apart sampling; default: their index.
    quality : ndarray of float64, shape (n,), optional
        Higher is better, for PROSAC.

    Returns
    -------
    Outcome or None
        None if every minimal sample was degenerate.

    Raises
    ------
    Cancelled
        If the caller's flag was set (:mod:`estimators.consensus.cancellation`).
    """
    evaluation = Evaluation(model, policies.score, policies.verifier, max(threshold, model.resolution))
    draws = bind_sampler(
        policies.sampler.code,
        np.arange(model.n, dtype=np.float64) if positions is None else positions,
        model.sample_size,
        policies.sampler.rank(quality, model.n, seed),
        seed,
        options.max_hypotheses,
        options.work_budget if policies.termination.may_enumerate else 0,
    )
    plan = policies.optimizer.plan(model.sample_size)
    optimizes = plan.repetitions > 0 or plan.finish > 0
    needed = limit = draws.total or policies.termination.before(draws, options)

    theta, best, record = np.zeros(model.p), NOTHING, NOTHING
    drawn = degenerate = invalid = scored = evaluations = optimizations = 0
    while drawn < needed:
        if cancel_flag()[0]:
            raise Cancelled
        solved = model.solve(draws.block(drawn, min(policies.block, limit - drawn)))
        values = evaluation.values(solved.theta, record.loss)
        k = values.best()
        if k >= 0 and rank(values.at(k)) < rank(record):
            record = values.at(k)
            candidate, value = solved.theta[k], record
            if optimizes:
                h = drawn + int(solved.owner[k])
                candidate, value, extra = improve(evaluation, plan, draws.seed, h, candidate, value)
                optimizations += 1
                evaluations += extra
            if rank(value) < rank(best):
                theta, best = candidate, value
                if draws.total is None:
                    inlier = policies.labeler.labels(_residuals(model, theta), evaluation.threshold)
                    needed = min(needed, policies.termination.after(draws, inlier, options))
        drawn += min(policies.block, limit - drawn)
        degenerate += solved.degenerate
        invalid += solved.invalid
        scored += solved.owner.size
        evaluations += values.evaluations

    if best == NOTHING:
        return None
    theta, best, extra = polish(evaluation, theta)
    inlier = policies.labeler.labels(_residuals(model, theta), evaluation.threshold)
    spare = best.inliers - model.p
    return Outcome(
        theta=theta,
        inlier=inlier,
        threshold=evaluation.threshold,
        scatter=evaluation.threshold * math.sqrt(best.squares / spare) if spare > 0 else 0.0,
        value=best,
        ledger=Ledger(drawn, degenerate, invalid, scored, evaluations + extra, optimizations),
        sampling_probability=-math.expm1(draws.log_miss(inlier, drawn)),
        exhaustive=draws.total is not None,
    )


def _residuals(model: Model, theta: FloatArray) -> FloatArray:
    """Residuals of one model at all points."""
    return model.residuals(theta[None, :], 0, model.n).ravel()
