"""Exclusion of one satellite after the other, in parity space: what ``raim`` and ``greedy`` share.

Excluding satellite i turns the least-squares residuals z and S = I - A N A' into z - S_i z_i / S_ii and
S - S_i S_i' / S_ii, exactly for the linearised model (METHODS_GNSS, "Identities worth having").
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.special import chdtri

from estimators.arrays import BoolArray, FloatArray
from estimators.gnss.methods.protocol import Verdict
from estimators.gnss.snapshot.problem import Problem
from estimators.result import Ledger

UNCHECKED = 1e-9
"""Redundancy number below which the other satellites do not check one."""
LEAST_FREEDOM = 2
"""Redundant satellites below which a fault can be detected, but not told whose it is."""


@dataclass(frozen=True, slots=True)
class Standing:
    """An epoch after some exclusions.

    Attributes
    ----------
    excluded : ndarray of bool, shape (n,)
    w : ndarray, shape (n,)
        w-test statistics |z_i| / sqrt(S_ii); 0 where nothing checks a satellite.
    """

    excluded: BoolArray
    w: FloatArray


class Choice(Protocol):
    """Whom to exclude next."""

    def __call__(self, standing: Standing) -> int | None:
        """Row of the satellite; None to stop."""
        ...


def exclude_one_by_one(problem: Problem, false_alarm: float, choose: Choice) -> Verdict:
    """Exclude while the sum of squares fails its chi-square test.

    Parameters
    ----------
    problem : Problem
    false_alarm : float
        Of the chi-square test.
    choose : callable
    """
    z, S = problem.z.copy(), problem.S.copy()
    excluded = np.zeros(z.size, dtype=np.bool_)
    freedom = z.size - problem.state.size
    tests = 0
    while freedom >= LEAST_FREEDOM:
        tests += 1
        if float(z[~excluded] @ z[~excluded]) <= float(chdtri(freedom, false_alarm)):
            break
        redundancy = np.diagonal(S)
        checked = ~excluded & (redundancy > UNCHECKED)
        w = np.where(checked, np.abs(z) / np.sqrt(np.where(checked, redundancy, 1.0)), 0.0)
        row = choose(Standing(excluded, w))
        if row is None:
            break
        column = S[:, row].copy()
        z -= column * (z[row] / column[row])
        S -= np.outer(column, column) / column[row]
        excluded[row] = True
        freedom -= 1
    ledger = Ledger(scored=tests, point_evaluations=tests * z.size)
    return Verdict(excluded, "closed", ledger)
