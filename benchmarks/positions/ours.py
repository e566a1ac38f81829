"""Plumbline's methods on epochs: ``auto`` in one call of the compiled solver, the others one by one."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from benchmarks.positions.answers import Answer
from benchmarks.positions.faults import Faulty
from benchmarks.positions.sky import as_table
from estimators.gnss.locate import locate
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.one_epoch import SOLVED
from estimators.gnss.snapshot.solved import solve_epochs
from estimators.result import NoFit


def answer_by_auto(faulty: Sequence[Faulty]) -> tuple[list[Answer], float]:
    """Positions by the posterior over fault sets.

    Returns
    -------
    answers : list of Answer
    ms : float
        Processor time per epoch.
    """
    options = PositionOptions()
    table = as_table([given.sky for given in faulty])
    started = time.process_time()
    solved = solve_epochs(table, options)
    ms = 1e3 * (time.process_time() - started) / len(faulty)
    answers = []
    for k, given in enumerate(faulty):
        if solved.status[k] != SOLVED:
            answers.append(Answer(None, np.zeros(len(given.sky.name), dtype=np.bool_)))
            continue
        rows = slice(int(table.offsets[k]), int(table.offsets[k + 1]))
        flagged = bool(solved.far_probability[k] >= options.ambiguity)
        answers.append(Answer(solved.state[k, :3], ~solved.excluded[rows], flagged, float(solved.hpl_m[k])))
    return answers, ms


def answer_by_method(method: str, faulty: Sequence[Faulty]) -> tuple[list[Answer], float]:
    """Positions by :func:`estimators.gnss.locate.locate`; flags are those of the posterior.

    Returns
    -------
    answers : list of Answer
    ms : float
        Processor time per epoch.
    """
    answers = []
    started = time.process_time()
    for given in faulty:
        sky = given.sky
        fix = locate(
            sky.satellites_m, sky.ranges_m, sigma_m=sky.sigma_m, system=sky.system, satellite=sky.name,
            method=method,
        )  # fmt: skip
        if isinstance(fix, NoFit):
            answers.append(Answer(None, np.zeros(len(sky.name), dtype=np.bool_)))
        else:
            answers.append(Answer(fix.position_ecef_m, fix.satellites.inlier, fix.ambiguous, fix.hpl_m))
    return answers, 1e3 * (time.process_time() - started) / len(faulty)
