"""Local optimisation and final fit as the readable engine runs them, for any model.

Step for step the procedure of :mod:`.local`, with the same random subsets.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.evaluation import Evaluation, rank
from estimators.consensus.optimizers.local import FINAL_STEPS
from estimators.consensus.optimizers.plan import Plan, shrunk_threshold, subset_counter
from estimators.consensus.randomness import stratified_subset
from estimators.consensus.scan import Value
from estimators.consensus.scores.msac import Msac


def improve(
    evaluation: Evaluation, plan: Plan, seed: int, h: int, theta: FloatArray, value: Value
) -> tuple[FloatArray, Value, int]:
    """Optimise a new best model; the result is never worse.

    Parameters
    ----------
    evaluation : Evaluation
    plan : Plan
    seed : int
    h : int
        Hypothesis that the model came from; the random subsets depend on it.
    theta : ndarray of float64, shape (p,)
    value : Value

    Returns
    -------
    theta, value, evaluations
    """
    model, T = evaluation.model, evaluation.threshold
    pool = evaluation.members(theta, T)
    evaluations = 0
    if pool.size <= model.sample_size + 1:
        return theta, value, evaluations
    if plan.repetitions:
        widest = shrunk_threshold(T, plan.multiplier, 0, plan.steps)
        wide = evaluation.members(theta, widest) if plan.limit else pool
        fitted = [
            _repeat(evaluation, plan, seed, h, theta, repetition, pool, wide)
            for repetition in range(plan.repetitions)
        ]
        candidates = np.array([candidate for candidate in fitted if candidate is not None])
        if candidates.size:
            values = evaluation.values(candidates, value.loss)
            evaluations += values.evaluations
            best = values.best()
            if best >= 0 and rank(values.at(best)) < rank(value):
                theta, value = candidates[best], values.at(best)
    if plan.finish:
        candidate = theta
        for step in range(plan.steps):
            members = evaluation.members(candidate, shrunk_threshold(T, plan.multiplier, step, plan.steps))
            better = model.fit(members, candidate) if members.size > model.sample_size else None
            if better is None:
                break
            candidate = better
        values = evaluation.values(candidate[None, :], value.loss)
        evaluations += values.evaluations
        if rank(values.at(0)) < rank(value):
            theta, value = candidate, values.at(0)
    return theta, value, evaluations


def _repeat(
    evaluation: Evaluation,
    plan: Plan,
    seed: int,
    h: int,
    theta: FloatArray,
    repetition: int,
    pool: IntArray,
    wide: IntArray,
) -> FloatArray | None:
    """Run one inner repetition: a non-minimal sample, then steps with a shrinking threshold."""
    model, T = evaluation.model, evaluation.threshold
    size = min(plan.sample, max(model.sample_size + 1, pool.size // 2))
    chosen = stratified_subset(seed, h, subset_counter(repetition, 0, plan.steps), pool.size, size)
    candidate = model.fit(pool[chosen], theta)
    if candidate is None:
        return None
    for step in range(plan.steps):
        narrow = shrunk_threshold(T, plan.multiplier, step, plan.steps)
        if plan.limit:
            counter = subset_counter(repetition, step + 1, plan.steps)
            chosen = wide[stratified_subset(seed, h, counter, wide.size, min(plan.limit, wide.size))]
            members = chosen[np.abs(model.residuals_at(candidate, chosen)) <= narrow]
        else:
            members = evaluation.members(candidate, narrow)
        better = model.fit(members, candidate) if members.size > model.sample_size else None
        if better is None:
            break
        candidate = better
    return candidate


def polish(evaluation: Evaluation, theta: FloatArray) -> tuple[FloatArray, Value, int]:
    """Fit a model to its consensus set by least squares until the set stays the same.

    Each step is accepted only if the truncated quadratic does not get worse, whatever the score of the
    search; :func:`~estimators.consensus.optimizers.local.polish_model` says why.

    Returns
    -------
    theta, value, evaluations
        The value is that of the truncated quadratic.
    """
    model = evaluation.model
    judge = dataclasses.replace(evaluation, score=Msac())
    value, evaluations = judge.value(theta)
    previous: IntArray | None = None
    for _ in range(FINAL_STEPS):
        members = evaluation.members(theta, evaluation.threshold)
        if members.size <= model.sample_size or (previous is not None and np.array_equal(members, previous)):
            break
        candidate = model.fit(members, theta)
        if candidate is None:
            break
        found, scored = judge.value(candidate)
        evaluations += scored
        if rank(value) < rank(found):
            break
        theta, value, previous = candidate, found, members
    return theta, value, evaluations
