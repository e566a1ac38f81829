"""The compiled local optimisation: one procedure that a :class:`Plan` turns into LO', LO-RANSAC or LO+.

Non-minimal samples are stratified along the order of the points and drawn by counters, so they depend on
nothing but the seed, the hypothesis and the step.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from estimators.arrays import CodeArray, FloatArray, IntArray
from estimators.consensus.optimizers.plan import Plan, shrunk_threshold_compiled, subset_counter_compiled
from estimators.consensus.randomness import SUBSETS, draw_stratified, random_key
from estimators.consensus.scan import (
    MSAC,
    Rows,
    Scan,
    Value,
    best_of,
    copy_into,
    is_better,
    residual_at,
    scan_models,
    select_members,
    value_of,
)
from estimators.consensus.solve import fit_members, fit_two_near
from estimators.kernels import device

FINAL_STEPS = 20
"""Most least-squares steps of the final fit; it usually settles in two to five."""


class Bench(NamedTuple):
    """Room for local optimisation.

    Attributes
    ----------
    pool, wide, members : ndarray of int64, shape (n,)
    few : ndarray of int64, shape (largest sample or limit,)
    candidates : ndarray of float64, shape (max(repetitions, 1), p)
    trial : ndarray of float64, shape (p,)
    system : ndarray of float64, shape (p, p + 1)
    """

    pool: IntArray
    wide: IntArray
    members: IntArray
    few: IntArray
    candidates: FloatArray
    trial: FloatArray
    system: FloatArray


@device
def improve_model(
    rows: Rows,
    score: int,
    T: float,
    bails_out: int,
    plan: Plan,
    seed: int,
    h: int,
    theta: FloatArray,
    value: Value,
    bench: Bench,
    scan: Scan,
    cancel: CodeArray,
) -> tuple[Value, int]:
    """Optimise ``theta`` in place; return its value, never worse than before, and the residuals scored.

    A consensus of s + 1 points or fewer is left alone: its least squares have no redundancy to use
    (METHODS.md 6.2, small-data rule).
    """
    p = theta.size
    found = select_members(rows, theta, T, scan.residual, bench.pool)
    evaluations = 0
    if found <= p + 1:
        return value, evaluations
    if plan.repetitions > 0:
        wide = 0
        if plan.limit > 0:
            widest = shrunk_threshold_compiled(T, plan.multiplier, 0, plan.steps)
            wide = select_members(rows, theta, widest, scan.residual, bench.wide)
        for repetition in range(plan.repetitions):
            candidate = bench.candidates[repetition]
            fitted = _repeat(
                rows, T, plan, seed, h, theta, repetition, found, wide, candidate, bench, scan.residual
            )
            scan.alive[repetition] = 1 if fitted else 0
        bound = value.loss if bails_out else np.inf
        evaluations += scan_models(rows, bench.candidates, plan.repetitions, score, T, bound, scan, cancel)
        best = best_of(scan, plan.repetitions)
        if best >= 0 and is_better(value_of(scan, best), value):
            value = value_of(scan, best)
            copy_into(theta, bench.candidates[best])
    if plan.finish:
        candidate = bench.candidates[0]
        copy_into(candidate, theta)
        for step in range(plan.steps):
            narrow = shrunk_threshold_compiled(T, plan.multiplier, step, plan.steps)
            count = select_members(rows, candidate, narrow, scan.residual, bench.members)
            copy_into(bench.trial, candidate)
            if count <= p or not fit_members(
                rows, bench.members, count, bench.trial, bench.system, candidate
            ):
                break
        scan.alive[0] = 1
        bound = value.loss if bails_out else np.inf
        evaluations += scan_models(rows, bench.candidates, 1, score, T, bound, scan, cancel)
        if scan.alive[0] and is_better(value_of(scan, 0), value):
            value = value_of(scan, 0)
            copy_into(theta, candidate)
    return value, evaluations


@device
def _repeat(
    rows: Rows,
    T: float,
    plan: Plan,
    seed: int,
    h: int,
    theta: FloatArray,
    repetition: int,
    found: int,
    wide: int,
    candidate: FloatArray,
    bench: Bench,
    residual: FloatArray,
) -> bool:
    """Run one inner repetition: a non-minimal sample, then steps with a shrinking threshold."""
    p = theta.size
    # Fields are taken out once: in a loop, each access would count a reference up and down.
    few, among, members, system = bench.few, bench.wide, bench.members, bench.system
    key = random_key(seed, SUBSETS, h)
    size = min(plan.sample, max(p + 1, found // 2))
    draw_stratified(key, subset_counter_compiled(repetition, 0, plan.steps), found, size, few)
    for k in range(size):
        few[k] = bench.pool[few[k]]
    if not fit_members(rows, few, size, theta, system, candidate):
        return False
    for step in range(plan.steps):
        narrow = shrunk_threshold_compiled(T, plan.multiplier, step, plan.steps)
        count = 0
        if plan.limit > 0:
            size = min(plan.limit, wide)
            counter = subset_counter_compiled(repetition, step + 1, plan.steps)
            draw_stratified(key, counter, wide, size, few)
            for k in range(size):
                few[k] = among[few[k]]
            if p == 2:
                if not fit_two_near(rows, few, size, narrow, candidate):
                    break
                continue
            for k in range(size):
                point = few[k]
                members[count] = point
                count += 1 if abs(residual_at(rows, candidate, point)) <= narrow else 0
        else:
            count = select_members(rows, candidate, narrow, residual, members)
        copy_into(bench.trial, candidate)
        if count <= p or not fit_members(rows, members, count, bench.trial, system, candidate):
            break
    return True


@device
def polish_model(
    rows: Rows, T: float, theta: FloatArray, bench: Bench, scan: Scan, cancel: CodeArray
) -> tuple[Value, int]:
    """Fit ``theta`` to its consensus set by least squares until the set stays the same.

    Each step is accepted only if the truncated quadratic, which it minimises, does not get worse. Judged by
    the number of inliers, classic RANSAC would keep the line through two points: the best of many such lines
    often holds a point or two more than the far more accurate fit.
    """
    p = theta.size
    candidate = bench.candidates[0]
    copy_into(candidate, theta)
    scan.alive[0] = 1
    evaluations = scan_models(rows, bench.candidates, 1, MSAC, T, np.inf, scan, cancel)
    value = value_of(scan, 0)
    previous = -1
    for _ in range(FINAL_STEPS):
        count = select_members(rows, theta, T, scan.residual, bench.members)
        if count <= p or (count == previous and _same(bench.members, bench.pool, count)):
            break
        if not fit_members(rows, bench.members, count, theta, bench.system, candidate):
            break
        scan.alive[0] = 1
        evaluations += scan_models(rows, bench.candidates, 1, MSAC, T, np.inf, scan, cancel)
        if is_better(value, value_of(scan, 0)):
            break
        value = value_of(scan, 0)
        copy_into(theta, candidate)
        previous = count
        for i in range(count):
            bench.pool[i] = bench.members[i]
    return value, evaluations


@device
def _same(a: IntArray, b: IntArray, count: int) -> bool:
    i = 0
    while i < count and a[i] == b[i]:
        i += 1
    return i == count
