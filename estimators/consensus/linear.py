"""The compiled path for linear models: the loop of :mod:`.engine` over many series, without the GIL.

Series stand in one array each of values, times and columns, series k at ``offsets[k] : offsets[k + 1]``; a
fit of one is a batch of one. Policies enter as data. Every step calls the function that the readable engine's
kernels call, in the same order, so that both give the same bytes.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import BoolArray, CodeArray, FloatArray, IntArray
from estimators.consensus.linear_layout import (
    CANCELLED,
    DEGENERATE,
    DRAWN,
    EVALUATIONS,
    EXHAUSTIVE,
    FOUND,
    INLIERS,
    INVALID,
    LOSS,
    NO_MODEL,
    OPTIMIZATIONS,
    PROBABILITY,
    SCATTER,
    SCORED,
    SQUARES,
    STATUS,
    THRESHOLD,
    Room,
    Row,
    make_room,
)
from estimators.consensus.linear_model import is_finite, smallest_threshold
from estimators.consensus.optimizers.local import improve_model, polish_model
from estimators.consensus.optimizers.plan import Plan
from estimators.consensus.samplers.draws import draw_block, draws_needed_for, log_miss
from estimators.consensus.samplers.enumeration import ENUMERATION, subsets_within
from estimators.consensus.samplers.prosac import PROSAC, fill_prosac_tables, growth_length
from estimators.consensus.scan import (
    Rows,
    Value,
    best_of,
    copy_into,
    fill_residuals,
    is_better,
    mark_members,
    scan_models,
    value_of,
)
from estimators.consensus.solve import solve_exactly, solve_two
from estimators.consensus.stopping import (
    clean_probability_compiled,
    draws_needed_compiled,
    log_miss_per_draw_compiled,
)
from estimators.consensus.termination import (
    FIRST_ACCEPTABLE,
    acceptable_inliers_compiled,
    draws_between_compiled,
)
from estimators.kernels import device, kernel, ro


@device
def _needed_before(row: Row, n: int, s: int) -> int:
    """Bound the draws while no model is known; see the terminations."""
    if row.termination != FIRST_ACCEPTABLE:
        return row.maximum
    acceptable = acceptable_inliers_compiled(row.acceptable, n, s)
    log_miss_each = log_miss_per_draw_compiled(clean_probability_compiled(acceptable, n, s))
    return draws_between_compiled(
        draws_needed_compiled(log_miss_each, row.confidence), row.minimum, row.maximum
    )


@device
def _solve_block(raw: Rows, count: int, room: Room, counts: IntArray) -> None:
    """Models through the samples of a block; the usable ones are alive."""
    if raw.columns.shape[0] == 2:
        _solve_lines(raw, count, room.samples, room.thetas, room.scan.alive, counts)
        return
    for k in range(count):
        theta = room.thetas[k]
        room.scan.alive[k] = 0
        if not solve_exactly(raw, room.samples[k], room.bench.system, theta):
            counts[DEGENERATE] += 1
        elif not is_finite(theta):
            counts[INVALID] += 1
        else:
            counts[SCORED] += 1
            room.scan.alive[k] = 1


@device
def _solve_lines(
    raw: Rows, count: int, samples: IntArray, thetas: FloatArray, alive: CodeArray, counts: IntArray
) -> None:
    """Run :func:`_solve_block` for two columns; a view of a row would cost more than its line."""
    for k in range(count):
        sound, first, second = solve_two(raw, samples[k, 0], samples[k, 1])
        alive[k] = 0
        if not sound:
            counts[DEGENERATE] += 1
        elif not (math.isfinite(first) and math.isfinite(second)):
            counts[INVALID] += 1
        else:
            counts[SCORED] += 1
            alive[k] = 1
            thetas[k, 0], thetas[k, 1] = first, second


@device
def search_series(
    raw: Rows,
    white: Rows,
    t: FloatArray,
    order: IntArray,
    T: float,
    row: Row,
    plan: Plan,
    room: Room,
    cancel: CodeArray,
    theta: FloatArray,
    inlier: BoolArray,
    numbers: FloatArray,
    counts: IntArray,
) -> None:
    """Run the loop for one series; write its model, labels and record."""
    n, s = t.size, theta.size
    T = max(T, smallest_threshold(white.y))
    sampler = row.sampler
    total = subsets_within(n, s, row.budget) if row.termination != FIRST_ACCEPTABLE else 0
    tables = 0
    if total > 0:
        sampler = ENUMERATION
    elif sampler == PROSAC:
        tables = 1
    growth = np.zeros(tables * (growth_length(n, s, row.maximum) + 1), np.int64)
    minima = np.zeros(tables * (n + 1), np.int64)
    if tables:
        fill_prosac_tables(n, s, growth, minima)
    optimizes = plan.repetitions > 0 or plan.finish > 0
    limit = total if total > 0 else _needed_before(row, n, s)
    needed = limit

    best, record = Value(np.inf, 0, np.inf), Value(np.inf, 0, np.inf)
    drawn = 0
    while drawn < needed and not cancel[0]:
        count = min(row.block, limit - drawn)
        draw_block(sampler, row.seed, drawn, count, t, order, growth, room.samples)
        _solve_block(raw, count, room, counts)
        bound = record.loss if row.bails_out else np.inf
        counts[EVALUATIONS] += scan_models(white, room.thetas, count, row.score, T, bound, room.scan, cancel)
        k = best_of(room.scan, count)
        if k >= 0 and is_better(value_of(room.scan, k), record):
            record = value_of(room.scan, k)
            value = record
            copy_into(room.trial, room.thetas[k])
            if optimizes:
                value, extra = improve_model(
                    white, row.score, T, row.bails_out, plan, row.seed, drawn + k,
                    room.trial, value, room.bench, room.scan, cancel,
                )  # fmt: skip
                counts[OPTIMIZATIONS] += 1
                counts[EVALUATIONS] += extra
            if is_better(value, best):
                best = value
                copy_into(theta, room.trial)
                if total == 0:
                    found = mark_members(white, theta, T, room.scan.residual, inlier)
                    needed = min(
                        needed, _needed_after(row, sampler, t, order, growth, minima, inlier, found, s, limit)
                    )
        drawn += count

    counts[DRAWN] = drawn
    counts[EXHAUSTIVE] = 1 if total > 0 else 0
    counts[STATUS] = NO_MODEL
    if cancel[0]:
        counts[STATUS] = CANCELLED
        return
    if best.loss == np.inf:
        return
    best, extra = polish_model(white, T, theta, room.bench, room.scan, cancel)
    mark_members(white, theta, T, room.scan.residual, inlier)
    counts[EVALUATIONS] += extra
    counts[INLIERS] = best.inliers
    counts[STATUS] = CANCELLED if cancel[0] else FOUND
    spare = best.inliers - s
    numbers[LOSS] = best.loss
    numbers[SQUARES] = best.squares
    numbers[THRESHOLD] = T
    numbers[SCATTER] = T * math.sqrt(best.squares / spare) if spare > 0 else 0.0
    numbers[PROBABILITY] = -math.expm1(log_miss(sampler, t, order, growth, inlier, s, drawn))


@device
def _needed_after(
    row: Row,
    sampler: int,
    t: FloatArray,
    order: IntArray,
    growth: IntArray,
    minima: IntArray,
    inlier: BoolArray,
    found: int,
    s: int,
    limit: int,
) -> int:
    """Bound the draws now that the best model has these inliers; see the terminations."""
    if row.termination == FIRST_ACCEPTABLE:
        return 0 if found >= acceptable_inliers_compiled(row.acceptable, t.size, s) else limit
    needed = draws_needed_for(sampler, t, order, growth, minima, inlier, s, row.confidence)
    return draws_between_compiled(needed, row.minimum, row.maximum)


_INT, _REAL = types.int64, types.float64


@kernel(
    types.void(
        ro(_REAL, 2), ro(_REAL), ro(_REAL, 2), ro(_REAL), ro(_REAL), ro(_INT), ro(_INT),
        _INT, _INT, ro(_REAL),
        _INT, _INT, _INT, _INT, _INT, _INT, _INT, _INT, _INT, _REAL, _INT,
        _INT, _INT, _INT, _INT, _REAL, _INT,
        ro(types.uint8),
        types.float64[:, ::1], types.boolean[::1], types.float64[::1],
        types.float64[:, ::1], types.int64[:, ::1],
    )
)  # fmt: skip
def search_batch(
    columns: FloatArray,
    y: FloatArray,
    white_columns: FloatArray,
    white_y: FloatArray,
    t: FloatArray,
    order: IntArray,
    offsets: IntArray,
    first: int,
    last: int,
    thresholds: FloatArray,
    sampler: int,
    score: int,
    bails_out: int,
    termination: int,
    block: int,
    minimum: int,
    maximum: int,
    budget: int,
    acceptable: int,
    confidence: float,
    seed: int,
    repetitions: int,
    sample: int,
    limit: int,
    steps: int,
    multiplier: float,
    finish: int,
    cancel: CodeArray,
    theta: FloatArray,
    inlier: BoolArray,
    residual: FloatArray,
    numbers: FloatArray,
    counts: IntArray,
) -> None:
    """Search series ``first .. last - 1`` and write their models, labels, residuals and records.

    The arguments up to ``thresholds`` are the data, then come the fields of ``Row``, those of ``Plan``, the
    cancel flag, and the arrays that are written. ``order`` holds the ranks of PROSAC within each series, or
    nothing for other samplers.
    """
    p = columns.shape[0]
    row = Row(
        sampler, score, bails_out, termination, block, minimum, maximum, budget, acceptable, confidence, seed
    )
    plan = Plan(repetitions, sample, limit, steps, multiplier, finish)
    longest = 0
    for k in range(first, last):
        longest = max(longest, offsets[k + 1] - offsets[k])
    room = make_room(longest, p, block, plan)
    for k in range(first, last):
        a, b = offsets[k], offsets[k + 1]
        for j in range(counts.shape[1]):
            counts[k, j] = 0
        counts[k, STATUS] = NO_MODEL
        if b - a < p:
            continue
        raw, white = Rows(columns, a, y[a:b]), Rows(white_columns, a, white_y[a:b])
        ranks = order[a:b] if order.size > 0 else order
        search_series(
            raw, white, t[a:b], ranks, thresholds[k], row, plan, room, cancel,
            theta[k], inlier[a:b], numbers[k], counts[k],
        )  # fmt: skip
        if counts[k, STATUS] == CANCELLED:
            return
        if counts[k, STATUS] == FOUND:
            fill_residuals(raw, theta[k], 0, b - a, residual[a:b])
