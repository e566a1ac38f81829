"""A detector applied to an epoch: order, linearisation and where they stop to matter.

Detectors work in the linearised model. After gross faults the solution by all satellites is kilometres off,
where the ranges' curvature is no longer noise: such an epoch is linearised about the position of Huber's
weights, which one fault cannot drag so far, and judged again about the position that the first verdict leads
to. Satellites are handed over in an order of their own, by coordinates, so that sampled
methods and ties do not depend on the caller's.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.methods.huber import Huber
from estimators.gnss.methods.protocol import FaultDetector, Verdict
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.problem import Problem, problem_at, solve_problem
from estimators.gnss.table import EpochTable

_ROUNDS = 3
_FAR_M = 1000.0
"""Beyond this the curvature of the ranges, d^2 / (2 rho), passes 2 cm."""


def judge_epoch(detector: FaultDetector, problem: Problem, options: PositionOptions) -> Verdict:
    """Let a detector judge an epoch, again where its verdict leads far away.

    Parameters
    ----------
    detector : FaultDetector
    problem : Problem
        At the solution by all satellites.
    options : PositionOptions

    Returns
    -------
    Verdict
        In the order of the problem's satellites.
    """
    order = np.lexsort(problem.table.satellites_m.T).astype(np.int64)
    current = _reordered(problem, order)
    if float(np.max(np.abs(current.z * current.table.sigma_m))) > _FAR_M:
        current = _about_huber(current, options)
    verdict = detector.judge(current, options)
    for _ in range(_ROUNDS - 1):
        healthy = solve_problem(current.table, ~verdict.excluded)
        if healthy is None or float(np.linalg.norm(healthy.state[:3] - current.state[:3])) < _FAR_M:
            break
        again = _linearised(current.table, healthy.state)
        if again is None:
            break
        current = again
        verdict = detector.judge(current, options)
    back = np.argsort(order)
    inflation = None if verdict.inflation is None else verdict.inflation[back]
    return dataclasses.replace(verdict, excluded=verdict.excluded[back], inflation=inflation)


def _about_huber(problem: Problem, options: PositionOptions) -> Problem:
    table = problem.table
    inflation = Huber().judge(problem, options).inflation
    if inflation is None:
        return problem
    weighed = solve_problem(dataclasses.replace(table, sigma_m=table.sigma_m * inflation))
    return problem if weighed is None else _linearised(table, weighed.state) or problem


def _linearised(table: EpochTable, state: FloatArray) -> Problem | None:
    """Linearise at a state; residuals are those that least squares over all satellites leaves over."""
    problem = problem_at(table, state, np.ones(table.pseudoranges_m.size, dtype=np.bool_))
    return None if problem is None else dataclasses.replace(problem, z=problem.S @ problem.z)


def _reordered(problem: Problem, order: IntArray) -> Problem:
    table = problem.table
    rows = EpochTable(
        satellites_m=np.ascontiguousarray(table.satellites_m[order]),
        pseudoranges_m=table.pseudoranges_m[order],
        sigma_m=table.sigma_m[order],
        clock=table.clock[order],
        offsets=table.offsets,
        letters=table.letters,
        names=tuple(table.names[i] for i in order),
        rotated=table.rotated,
    )
    return Problem(
        table=rows,
        state=problem.state,
        A=np.ascontiguousarray(problem.A[order]),
        z=problem.z[order],
        N=problem.N,
        gain=np.ascontiguousarray(problem.gain[:, order]),
        S=np.ascontiguousarray(problem.S[np.ix_(order, order)]),
        used=problem.used[order],
    )
